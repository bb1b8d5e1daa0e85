"""Who finds the condition numbers, and at what price: the verb `bench study condition-table` writes
results/CONDITION.md.

The estimators spectra (2 in records) and lanczos (4) estimate the same matrices: those of every diagnosed
iteration of the demo's sweeps, run once with each estimator, and those of results/matrices. A run goes
through the same states whatever is estimated, so that its samples pair up one by one.
"""

import datetime
import json
import tempfile
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.input_file import below
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.template import filled
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.program.start import finished, settings_words

SWEEPS = ("demo_strip", "demo_pinned", "demo_article", "demo_drape")
TIERS = (2, 4)
DIAGNOSED = {
    "/passes/time": False,
    "/passes/audit": False,
    "/passes/diagnose": True,
    "/diagnose/pcg": False,
}


@dataclass
class Pair:
    """One matrix and scaling: its sample by Spectra and that by our Lanczos."""

    where: str
    spectra: dict
    lanczos: dict


def run(words: list[str]) -> None:
    finished(*words, what=f"{' '.join(words)}: ")


def samples(folder: Path) -> dict[tuple, dict]:
    """The samples of all traces under a folder, by case, step, iteration, matrix, stage and scaling."""
    found = {}
    for trace in below(folder, "trace.jsonl"):
        case = (
            trace.parent.name.rpartition("-")[0] or trace.parent.name
        )  # LABEL-ID, and the id knows the estimator
        for line in input_file.read_text(trace).splitlines():
            row = json.loads(line)
            for one in row.get("cond", []):
                found[(case, row["step"], row["iteration"], one["matrix"], one["stage"], one["scaling"])] = (
                    one
                )
    return found


def pair_up(name: str, by_tier: dict[int, dict[tuple, dict]]) -> list[Pair]:
    first, second = (by_tier[tier] for tier in TIERS)
    if first.keys() != second.keys() or not first:
        raise UserError(
            f"{name}: {len(first)} estimates by spectra, {len(second)} by lanczos, not of the same matrices"
        )
    return [Pair(name, first[key], second[key]) for key in sorted(first, key=str)]


def _labelled(spec: dict) -> list[dict]:
    return [axis for axis in spec["axes"] if any("label" in case for case in axis.get("cases", []))]


def _keep(spec: dict, cases: list[str]) -> None:
    """Leaves the cases with these labels on every labelled axis. Raises UserError where an axis has none of
    them.
    """
    for axis in _labelled(spec):
        kept = [case for case in axis["cases"] if case["label"] in cases]
        if not kept:
            raise UserError(
                f"configs/sweeps/{spec['name']}.json: no case {' or '.join(map(repr, cases))}; it has"
                f" {', '.join(case['label'] for case in axis['cases'])}"
            )
        axis["cases"] = kept


def _sweep(name: str) -> dict:
    return read_object(ROOT / f"configs/sweeps/{name}.json")


def check_labels(sweeps: list[str], cases: list[str]) -> None:
    """Raises UserError for a label that no sweep has: a misspelt one would be left out in silence."""
    labels = {case["label"] for name in sweeps for axis in _labelled(_sweep(name)) for case in axis["cases"]}
    if unknown := [label for label in cases if label not in labels]:
        raise UserError(
            f"--cases {unknown[0]}: none of {', '.join(sweeps)} has it; they have {', '.join(sorted(labels))}"
        )


def of_sweep(name: str, cases: list[str], work: Path) -> list[Pair]:
    spec = _sweep(name)
    spec["base"] = str((ROOT / "configs/sweeps" / spec["base"]).resolve())
    if cases:
        _keep(spec, cases)
    file = work / f"{name}.json"
    file.write_text(json.dumps(spec))
    by_tier = {}
    for tier in TIERS:
        out = work / f"{name}_{tier}"
        settings = settings_words({"/diagnose/tier": tier, **DIAGNOSED})
        run(["sweep", str(file), "--out", str(out), "--progress", "none", *settings])
        by_tier[tier] = samples(out)
    return pair_up(name, by_tier)


def of_corpus(work: Path) -> list[Pair]:
    out = work / "replay.json"
    run(["matrix", *map(str, sorted((ROOT / "results/matrices").glob("*.mtx"))), "--json", str(out)])
    by_tier: dict[int, dict[tuple, dict]] = {tier: {} for tier in TIERS}
    for one in read_object(out)["matrices"]:
        for estimate in one["estimates"]:
            if estimate["tier"] in TIERS:
                by_tier[estimate["tier"]][(one["file"], estimate["scaling"])] = estimate
    return pair_up("corpus", by_tier)


def difference(pair: Pair) -> float | None:
    """Of cond, relative; None where one of the two does not know it, or only a bound."""
    if pair.spectra["status"] != "ok" or pair.lanczos["status"] != "ok":
        return None
    return abs(pair.spectra["cond"] / pair.lanczos["cond"] - 1)


def row(name: str, pairs: list[Pair]) -> list[str]:
    def spread(side: str, field: str) -> str:
        values = [getattr(pair, side)[field] for pair in pairs]
        return f"{sum(values) / len(values):.1f} / {max(values)}"

    def seconds(side: str) -> str:
        return f"{1e3 * sum(getattr(pair, side)['time_s'] for pair in pairs) / len(pairs):.2f}"

    known = [d for d in map(difference, pairs) if d is not None]
    other = sum(pair.spectra["status"] != pair.lanczos["status"] for pair in pairs)
    with_factor = [pair for pair in pairs if pair.spectra["method"].startswith("spectra")]
    took_over = sum(" by lanczos" in pair.spectra["method"] for pair in with_factor)
    shifted = sum(" shifted to" in pair.spectra["method"] for pair in with_factor)
    both = sum(pair.spectra["proof"] == "both" for pair in pairs)
    return [
        name,
        str(len(pairs)),
        str(len(with_factor)),
        str(took_over),
        str(shifted),
        str(both),
        spread("spectra", "solves"),
        spread("lanczos", "solves"),
        spread("spectra", "products"),
        spread("lanczos", "products"),
        seconds("spectra"),
        seconds("lanczos"),
        f"{max(known):.1e}" if known else "-",
        str(other),
    ]


COLUMNS = [
    "matrices",
    "estimates",
    "by Spectra",
    "an end by Lanczos",
    "an end shifted to",
    "both ends proven",
    *("solves: Spectra", "Lanczos", "products: Spectra", "Lanczos", "ms: Spectra", "Lanczos"),
    "largest difference of cond",
    "other status",
]
PAGE = ROOT / "configs" / "matrices" / "condition.md"  # template of results/CONDITION.md


def page(groups: dict[str, list[Pair]], note: str) -> str:
    every = [pair for pairs in groups.values() for pair in pairs]
    rows = [row(name, pairs) for name, pairs in [*groups.items(), ("all", every)]]
    about = {"date": datetime.date.today(), "processor": processor(), "note": note}
    return filled(PAGE, {**about, "table": "\n".join(table_lines(COLUMNS, rows))})


def processor() -> str:
    for line in input_file.read_text(Path("/proc/cpuinfo")).splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return "unknown processor"


@reported("study condition-table")
def main(words: list[str]) -> int:
    parser = parser_of("study condition-table", __doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "results/CONDITION.md")
    parser.add_argument(
        "--sweeps", nargs="*", default=list(SWEEPS), help="of configs/sweeps; none: the corpus alone"
    )
    parser.add_argument("--cases", nargs="*", default=[], help="labels of their formulations (default: all)")
    arguments = parser.parse_args(words)
    check_labels(arguments.sweeps, arguments.cases)
    with tempfile.TemporaryDirectory() as folder:
        groups = {name: of_sweep(name, arguments.cases, Path(folder)) for name in arguments.sweeps}
        groups["corpus"] = of_corpus(Path(folder))
    of_cases = f" for the cases {', '.join(arguments.cases)}" if arguments.cases else ""
    write_whole(arguments.out, page(groups, of_cases))
    print(arguments.out)
    return 0

"""A condition number taken apart: the verb `bench study causes`.

Of the diagnosed Newton iteration with the largest condition number (or the one that is named): every stage
and scaling side by side, what contact, strain limit and scaling make of it, and where the eigenvectors of
both ends live: on which term, element, body and vertices.
"""

import json
import math
import subprocess
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, passed_on, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import read_record, read_trace
from barrierbench_analysis.io.text_table import aligned
from barrierbench_analysis.program.arguments import parser_of, plugin_argument, set_argument
from barrierbench_analysis.program.start import started

from .numbers import significant
from .records import LARGEST_COND

STAGES = ["full", "without_contact", "without_contact_and_limit"]
SCALINGS = ["none", "jacobi", "block_jacobi"]
OPTIONS = [
    "/passes/diagnose=true",
    "/passes/time=false",
    "/diagnose/ends=true",
    f"/diagnose/stages={json.dumps(STAGES)}",
    f"/diagnose/scalings={json.dumps(SCALINGS)}",
]
WITHOUT = {
    "contact": ("full", "without_contact"),
    "strain limit": ("without_contact", "without_contact_and_limit"),
}


def diagnosed(folder: Path) -> tuple[dict, list[dict]]:
    """The record in a folder, and the lines of its trace that have condition numbers. Raises UserError,
    RecordError.
    """
    record = read_record(folder / "run.json")
    rows = read_trace(record, folder)
    if not rows:
        raise UserError(
            f"{folder / 'trace.jsonl'}: not there; allowed: a run with the pass diagnose, e.g. ./bench study"
            " causes CONFIG.json"
        )
    return record, [row for row in rows if row["cond"]]


def clamped(row: dict) -> dict[tuple[str, str], dict]:
    """(stage, scaling) -> sample of the clamped matrix."""
    return {(c["stage"], c["scaling"]): c for c in row["cond"] if c["matrix"] == "clamped"}


def cond_of(sample: dict) -> float:
    """LARGEST_COND where there is none: singular or not positive definite."""
    return LARGEST_COND if sample["cond"] is None else sample["cond"]


def pick(rows: list[dict], scaling: str, at: tuple[int, int] | None) -> dict:
    """The iteration `at` (step, iteration), or the one with the largest condition number of the full matrix
    under `scaling`.
    """
    known = [row for row in rows if ("full", scaling) in clamped(row)]
    if at is not None:
        known = [row for row in known if (row["step"], row["iteration"]) == at]
    if not known:
        what = f"step {at[0]}, iteration {at[1]}" if at else "any iteration"
        raise UserError(
            f"no condition number of the full matrix, scaling {scaling}, at {what}; allowed: a run with --set"
            " /passes/diagnose=true"
        )
    return max(known, key=lambda row: cond_of(clamped(row)["full", scaling]))


def ratios(samples: dict[tuple[str, str], dict]) -> list[tuple[str, float]]:
    """By what a cause multiplies the condition number: contact and limit (a stage over the next, unscaled),
    scaling (over unscaled).
    """
    found = []
    for cause, (with_it, without) in WITHOUT.items():
        for scaling in SCALINGS:
            if (with_it, scaling) in samples and (without, scaling) in samples:
                found.append(
                    (
                        f"{cause}, scaling {scaling}",
                        cond_of(samples[with_it, scaling]) / cond_of(samples[without, scaling]),
                    )
                )
    for scaling in SCALINGS[1:]:
        if ("full", scaling) in samples and ("full", "none") in samples:
            found.append(
                (
                    f"scaling {scaling}, full matrix",
                    cond_of(samples["full", scaling]) / cond_of(samples["full", "none"]),
                )
            )
    return found


def end_lines(samples: dict[tuple[str, str], dict]) -> list[list[str]]:
    rows = []
    for (stage, scaling), sample in samples.items():
        for end in sample.get("ends", []):
            terms = ", ".join(f"{t['term']} {t['share']:.0%}" for t in end["terms"] if t["share"] >= 0.005)
            rows.append(
                [
                    stage,
                    scaling,
                    end["side"],
                    significant(end["lambda"]),
                    terms,
                    f"{end['element']} ({end['element_share']:.0%})",
                    f"{end['body']} ({end['body_share']:.0%})",
                    f"{end['vertices']:.1f}",
                ]
            )
    return rows


def ends_text(samples: dict[tuple[str, str], dict]) -> list[str]:
    """The table of the eigenvectors of both ends, or why there are none."""
    ends = end_lines(samples)
    if not ends:
        return ["no eigenvectors: the run had no --set /diagnose/ends=true, or no Cholesky factor"]
    return aligned(
        [
            "stage",
            "scaling",
            "end",
            "lambda",
            "made by (share of lambda)",
            "largest element",
            "body (share of |v|^2)",
            "vertices",
        ],
        ends,
    )


def text(row: dict, count: int, scaling: str) -> str:
    samples = clamped(row)
    worst = samples["full", scaling]
    lines = [
        (
            f"step {row['step']}, iteration {row['iteration']} of {count} diagnosed: cond"
            f" 10^{math.log10(cond_of(worst)):.2f} (scaling {scaling}, {worst['status']})"
        ),
        "",
    ]
    lines += aligned(
        ["stage", "scaling", "cond", "lambda_min", "lambda_max", "status"],
        [
            [
                stage,
                name,
                significant(s["cond"]),
                significant(s["lambda_min"]),
                significant(s["lambda_max"]),
                s["status"],
            ]
            for (stage, name), s in samples.items()
        ],
    )
    lines += [
        "",
        *aligned(
            ["what is added", "multiplies cond by"],
            [[what, f"{factor:.3g}"] for what, factor in ratios(samples)],
        ),
        "",
        *ends_text(samples),
    ]
    return "\n".join(lines)


def run_folder(
    given: Path, out: Path | None, settings: list[str], plugins: list[str], replace: bool = False
) -> Path:
    """The folder of a record, or of the run that is made of a config with everything diagnosed. Raises
    UserError for what a record, whose run is over, cannot take: settings, plugins, another folder.
    """
    if given.is_dir() or given.name == "run.json":
        refused = (
            [f"--set {text}" for text in settings]
            + [f"--plugin {file}" for file in plugins]
            + ([f"--out {out}"] if out else [])
            + (["--replace"] if replace else [])
        )
        if refused:
            raise UserError(
                f"{refused[0]}: given with a record, whose run is over: {given}; allowed: with a config,"
                f" which is run, e.g. ./bench study causes CONFIG.json {refused[0]}"
            )
        return given if given.is_dir() else given.parent
    folder = out or ROOT / "results/runs" / f"causes-{given.stem}"
    words = ["run", str(given), "--out", str(folder)]
    if out is None or replace:
        words.append(
            "--replace"
        )  # the default folder is named after the config's file alone, whatever is set
    for option in [*OPTIONS, *settings]:
        words += ["--set", option]
    code = started(*words, plugins=plugins, stdout=subprocess.DEVNULL).returncode
    if code != 0:
        raise UserError(f"{given}: the run ended with exit code {code}", passed_on(code))
    return folder


@reported("study causes")
def main(words: list[str]) -> int:
    parser = parser_of("study causes", __doc__.split("\n\n", 1)[1])
    parser.add_argument(
        "run",
        type=Path,
        help=(
            "folder of a record with a trace, its run.json, or a config, which is run with everything"
            " diagnosed"
        ),
    )
    parser.add_argument(
        "--scaling",
        choices=SCALINGS,
        default="none",
        help="by which the worst iteration is picked (default none)",
    )
    parser.add_argument("--at", metavar="STEP,ITERATION", help="that iteration in place of the worst")
    set_argument(parser, "override of a config", "/time/steps=5")
    parser.add_argument("--out", type=Path, help="folder of that run (default results/runs/causes-NAME)")
    parser.add_argument(
        "--replace",
        action="store_true",
        help="the record of another config in the folder of --out goes, as in ./bench run",
    )
    plugin_argument(parser)
    given = parser.parse_args(words)
    try:
        at = tuple(int(part) for part in given.at.split(",")) if given.at is not None else None
        if at is not None and (len(at) != 2 or min(at) < 0):
            raise ValueError
    except ValueError:
        raise UserError(f"--at {given.at!r}: allowed: STEP,ITERATION, both from 0") from None
    folder = run_folder(given.run, given.out, given.overrides, given.plugin, given.replace)
    record, rows = diagnosed(folder)
    row = pick(rows, given.scaling, at)
    print(
        f"{record['labels']['scene']} {record['labels']['formulation']}:"
        f" {text(row, len(rows), given.scaling)}"
    )
    return 0

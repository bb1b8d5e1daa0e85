"""What a study takes, from the seconds that kept results have: the table of docs/guides/cluster.md."""

from collections.abc import Callable, Iterator
from pathlib import Path

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.claims import table as claims_table
from barrierbench_analysis.studies.kit.study.store import read_rows

RESULTS = ROOT / "results"
CORES = (4, 64)  # of a laptop and of a node
PRICE = 0.05  # of a core hour in a cloud, in any currency: an assumption that readers replace


def _counted(seconds: list[float | None]) -> tuple[int, float]:
    known = [one for one in seconds if one is not None]
    return len(known), sum(known)


def _of_rows(file: Path) -> tuple[int, float]:
    """Of a study of the kit, without rows of counts, which are no runs."""
    rows = read_rows(file).values()
    return _counted([row.seconds for row in rows if row.values.get("counts") is None])


def _claims(file: Path) -> tuple[int, float]:
    sweeps = claims_table.read(file).sweeps.values()
    return sum(len(one.rows) for one in sweeps), sum(one.about["seconds"] for one in sweeps)


# Study -> file, command, and its runs with their core seconds. Every run has one thread.
STUDIES: dict[str, tuple[str, str, Callable[[Path], tuple[int, float]]]] = {
    "claims": ("studies/claims.jsonl", "./bench study claims", _claims),
    "gap map": ("studies/gap_map.jsonl", "./bench study gap-map", _of_rows),
    "Pareto fronts": ("studies/pareto.jsonl", "./bench study pareto", _of_rows),
    "work-precision": ("studies/work_precision.jsonl", "./bench study work-precision", _of_rows),
    "catalogue": ("studies/catalogue.jsonl", "./bench study catalogue", _of_rows),
    "stress suite": ("studies/stress.jsonl", "./bench study stress", _of_rows),
    "ablation": ("studies/ablation.jsonl", "./bench study ablation", _of_rows),
}


def gather(folder: Path = RESULTS) -> list[dict]:
    """study, command, runs and core_s of every study whose results are there. Errors: UserError for a file
    that is no JSON object.
    """
    return list(_studies(folder))


def _studies(folder: Path) -> Iterator[dict]:
    for study, (name, command, read) in STUDIES.items():
        if (folder / name).is_file():
            runs, core_s = read(folder / name)
            yield {"study": study, "command": command, "runs": runs, "core_s": core_s}


def _hours(hours: float) -> str:
    return f"{hours:.2g} h" if hours >= 1 else f"{60 * hours:.2g} min"


def table(studies: list[dict]) -> list[str]:
    """Wall times are core hours over cores: runs share nothing, and each is far shorter than the whole."""
    rows = []
    for one in studies:
        hours = one["core_s"] / 3600
        shared = [_hours(hours / cores) for cores in CORES]
        row = [one["study"], f"`{one['command']}`", str(one["runs"]), f"{hours:.2f}"]
        rows.append([*row, *shared, f"{PRICE * hours:.2f}"])
    laptop, node = CORES
    head = ["study", "command", "runs that are kept", "core hours", f"laptop, {laptop} cores"]
    return markdown([*head, f"node, {node} cores", f"cloud, at {PRICE:g} a core hour"], rows)

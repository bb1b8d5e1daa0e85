"""What a study takes, from the seconds that kept results have: the table of docs/guides/cluster.md."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.store import Row, read_rows

RESULTS = ROOT / "results"
CORES = (4, 64)  # of a laptop and of a node
PRICE = 0.05  # of a core hour in a cloud, in any currency: an assumption that readers replace


def _column(data: dict, name: str) -> list[float]:
    """Of a table with columns once: the numbers that are there."""
    place = data["columns"].index(name)
    return [row[place] for row in data["rows"] if row[place] is not None]


def _stress(rows: list[Row]) -> tuple[int, float]:
    """Without the rows of geometry, which are no runs."""
    return _counted([row.seconds for row in rows if row.values["counts"] is None])


def _listed(parts) -> list:
    return list(parts.values()) if isinstance(parts, dict) else parts


# Study -> file, command, and its runs with their core seconds. Every run has one thread.
def _claims(data: dict) -> tuple[int, float]:
    sweeps = _listed(data["sweeps"])
    return sum(len(one["rows"]) for one in sweeps), sum(one["about"]["seconds"] for one in sweeps)


def _work_precision(data: dict) -> tuple[int, float]:
    abouts = [one["about"] for one in _listed(data["scenes"])]
    return sum(about["runs"] for about in abouts), sum(about["seconds"] for about in abouts)


def _catalogue(data: dict) -> tuple[int, float]:
    seconds = [row["seconds"] for scene in data["scenes"].values() for row in scene["rows"]]
    return len(seconds), sum(seconds)


def _counted(seconds: list[float]) -> tuple[int, float]:
    return len(seconds), sum(seconds)


STUDIES = {
    "claims": ("claims.json", "./bench study claims", _claims),
    "gap map": ("gap_map.json", "./bench study gap-map", lambda d: _counted(_column(d, "seconds"))),
    "Pareto fronts": (
        "pareto.json",
        "./bench study pareto",
        lambda d: (len(d["rows"]), d["about"]["seconds"]),
    ),
    "work-precision": ("work_precision.json", "./bench study work-precision", _work_precision),
    "catalogue": ("catalogue.json", "./bench study catalogue", _catalogue),
    "stress suite": ("studies/stress.jsonl", "./bench study stress", _stress),
    "ablation": ("ablation.json", "./bench study ablation", lambda d: _counted(_column(d, "core_s"))),
}


def _read(file: Path) -> dict | list[Row]:
    return list(read_rows(file).values()) if file.suffix == ".jsonl" else read_object(file)


def gather(folder: Path = RESULTS) -> list[dict]:
    """study, command, runs and core_s of every study whose results are there. Errors: UserError for a file
    that is no JSON object.
    """
    return list(_studies(folder))


def _studies(folder: Path) -> Iterator[dict]:
    for study, (name, command, read) in STUDIES.items():
        if (folder / name).is_file():
            runs, core_s = read(_read(folder / name))
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

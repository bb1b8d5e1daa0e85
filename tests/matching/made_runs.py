"""Rows of Pareto fronts, made up."""

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit.study.page import text_of
from barrierbench_analysis.studies.kit.study.spec import Study, read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules import pareto
from barrierbench_analysis.studies.rules.pareto.fronts import Runs

METRICS = tuple(name for name in read_study("pareto").data["metrics"] if name != "gap")
ORIGIN = {"date": "2024-01-31", "machine": "a cpu", "commit": "c", "build": "0123456789"}


def row(scene: str, formulation: str, scale: float, seed: int, outcome: str = "ok", **values) -> Row:
    place = {"scene": scene, "formulation": formulation, "scale": f"{scale:g}", "seed": str(seed)}
    values = dict.fromkeys(METRICS, 1.0) | {"matching": "equal_force, theta 0.1"} | values
    return Row(" ".join(place.values()), place, outcome, values, {}, 9, 1.0, "r", ORIGIN)


def runs_of(rows: list[Row]) -> Runs:
    return Runs(rows, METRICS, "smallest")


def page_of(runs: Runs, gaps=(0.02, 0.1, 0.99)) -> str:
    """The page of these rows."""
    data = read_study("pareto").data
    study = Study(ROOT / "configs/pareto/made.json", data | {"name": "made", "rule": "pareto", "about": data["about"] | {"gaps": list(gaps)}})
    return text_of(study, runs.rows, pareto.rule(study, runs.rows))

"""Pareto fronts: every formulation over decades of stiffness, compared at equal reached gap and never at
equal kappa (docs/results/method/pareto.md).
"""

import math
from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.spec_file import refused
from barrierbench_analysis.studies.kit.formulations import REFERENCE, label, preset, settings
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.studies.kit.runs import check_varied
from barrierbench_analysis.studies.kit.study.spec import Case, Cell, Study, product
from barrierbench_analysis.studies.kit.study.store import Row

from . import figure, tables
from .fronts import Runs

MEASURED = {"matching": "rule and theta of /matching"}
DECADES = 4.0  # of stiffness, at least
D_HAT = "/formulation/d_hat_m"
OWN = ("/matching", "/passes", "/seeds", "/formulation")  # what cells set themselves
COMMON = {
    "/threads": 1,
    "/matching/rule": "equal_force",
    "/passes": {"time": True, "diagnose": True, "audit": True},
    "/diagnose/scalings": ["none", "block_jacobi"],
    "/diagnose/stages": ["full", "without_contact", "without_contact_and_limit"],
}
GAPS = {"gap_min": "smallest", "gap_median": "median of the smallest"}  # metric -> in words


def _check(study: Study) -> None:
    """Errors: UserError for what no schema can say of a spec."""
    file, about, source = study.file, study.about, study.data["metrics"].get("gap")
    if source not in GAPS:
        raise refused(file, "metrics/gap", source, f"one of {', '.join(GAPS)}")
    scales = about["scales"]
    for key in ("scales", "gaps"):
        if about[key] != sorted(about[key]):
            raise refused(file, f"about/{key}", about[key], "a list of growing numbers, each once,")
    if math.log10(scales[-1] / scales[0]) < DECADES - 1e-9 or not scales[0] < 1 < scales[-1]:
        raise refused(
            file,
            "about/scales",
            f"{scales[0]:g} to {scales[-1]:g}",
            f"a range of at least {DECADES:g} decades round 1",
        )
    for k, name in enumerate(about["formulations"]):
        try:
            preset(name)
        except UserError as error:
            raise UserError(f"{file}#/about/formulations/{k}: {error}") from None
    places = {"set": study.data.get("set", {})}
    for case in study.data["axes"][0]["cases"]:
        places[f"axes/0/cases/{case['label']}/set"] = case["set"]
    for place, found in places.items():
        if own := next((p for p in found if p.startswith(OWN) and p != D_HAT), None):
            raise refused(file, place, own, f"nothing below {', '.join(OWN)} but {D_HAT}")


def cells(study: Study) -> Iterator[Case]:
    """The scenes and starts of the spec, of each every formulation at every scale. Errors: UserError."""
    _check(study)
    about, common = study.about, study.data.get("set", {})
    first = {p: v for p, v in COMMON.items() if p not in common} | {"/seeds/jitter_m": about["jitter_m"]}
    for start in product(study):
        d_hat = start.settings.get(D_HAT, common.get(D_HAT))
        own = {pointer: value for pointer, value in start.settings.items() if pointer != D_HAT}
        for name in about["formulations"]:
            for scale in about["scales"]:
                place = {"scene": start.place["scene"], "formulation": label(name), "scale": f"{scale:g}"}
                yield Case(
                    place | {"seed": start.place["seed"]},
                    first | own | settings(name, about["vary"], d_hat, scale),
                )


def measure(study: Study, cell: Cell, record: dict) -> dict:
    """Errors: UserError where a strain limit varies that the run does not have."""
    check_varied(record, study.about["vary"], f"{study.file}#/axes/0/cases/{cell.place['scene']}")
    matching = record["matching"]
    return {"matching": f"{matching['rule']}, theta {matching['theta']:g}"}


def rule(study: Study, rows: list[Row]) -> dict:
    """Tables of the page, and the paths for the figures. Errors: UserError for a scene without any gap."""
    metrics = {name: source for name, source in study.data["metrics"].items() if name != "gap"}
    runs = Runs(rows, tuple(metrics), GAPS[study.data["metrics"]["gap"]])
    for scene in runs.scenes:
        if not any(runs.gap(row) for row in rows if row.place["scene"] == scene):
            raise UserError(
                f"{study.file}#/axes/0/cases/{scene}: no run is in contact at the end of any step: there is"
                " no gap to compare at"
            )
    sizes, gaps = sorted({row.unknowns for row in rows}), study.about["gaps"]
    return {
        "runs": runs,
        "doc": study.about["doc"],
        "vary": study.about["vary"],
        "reference": REFERENCE,
        "gap": runs.gap_words,
        "decades": f"{runs.decades:g}",
        "starts": len(runs.seeds),
        "matching": ", ".join(sorted({row.values["matching"] for row in rows})),
        "scales": ", ".join(f"x{scale:g}" for scale in runs.scales),
        "unknowns": f"{sizes[0]} to {sizes[-1]}",
        "seconds": f"{sum(row.seconds for row in rows):.0f}",
        "build": ", ".join(sorted({row.origin["build"][:8] for row in rows})),
        "scenes": {scene: tables.of_scene(runs, scene, gaps) for scene in runs.scenes},
        "over_scenes": "\n".join(tables.over_all(runs, gaps)),
        "meanings": [tables.meaning(name, METRICS.get(source), source) for name, source in metrics.items()],
    }


def draw(study: Study, _rows: list[Row], numbers: dict, folder: Path) -> list[Path]:
    runs = numbers["runs"]
    return [
        file for scene in runs.scenes for file in figure.draw(runs, scene, folder / f"{study.name}_{scene}")
    ]

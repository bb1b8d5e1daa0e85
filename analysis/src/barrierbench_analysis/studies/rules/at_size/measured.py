"""What the study keeps of a run."""

import math
from itertools import chain
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.record_file import read_trace
from barrierbench_analysis.studies.kit.metrics import FOLDER
from barrierbench_analysis.studies.kit.study.spec import Cell, Study
from barrierbench_analysis.studies.rules.gap_map.measured import INFINITE, LARGEST, conditions

from .causes import CAUSES, by_step, counts, slopes
from .cells import BASE, sections, sized
from .loads import mass_factor
from .stops import LOOSE, RESIDUAL, RULES, WORK, until_slow, work

LOADS = 100.0  # of law 1: the range of loads, from the matched one down
LAWS = {
    "made": "largest cond over cond without contact of the same iterate",
    "cond_most": "largest cond of an iterate in contact",
    "price_most": "largest cond over the largest load of its iterate, at least 1/100 of the matched one",
    "bj_lambda_max": "largest eigenvalue of an iterate, block-Jacobi scaled",
    "load_high": "largest load of a contact at a step's end, the largest over steps in contact",
    "load_low": "the same, 5% quantile over steps in contact",
    "stiffness": "largest stiffness of a contact of an iterate, median over iterates in contact",
    "binding": "iterations that ACCD bounds and after which the largest load is above twice that of the end",
    "fall": "fall of ln of the largest load in an iteration, mean over those that begin above twice the end",
}
# Value of a row -> what it is.
MEASURED = {
    "contacts": "contacts of an iterate, mean",
    **{f"by_{name}": f"iterations to 1e-4 d_hat: {what}" for name, what in CAUSES.items()},
    **{
        f"slope_{name}": f"iterations of a step to 1e-4 d_hat over ln contacts: {what}"
        for name, what in CAUSES.items()
    },
    **{f"{rule}_{name}": f"{what} until {of}" for rule, of in RULES.items() for name, what in WORK.items()},
    **{f"{rule}_missed": f"steps without an iterate in which {of}" for rule, of in RULES.items()},
    "cond_p95": "95th percentile of cond over iterates in contact",
    "bj_p95": "the same, block-Jacobi scaled",
    "nc_p95": "the same of cond without contact",
    "pcg": "median of the iterations of PCG with block Jacobi to 1e-6, over iterates in contact",
    "samples": "iterates in contact with a condition number",
    **LAWS,
}


def _of(line: dict, stage: str, scaling: str, what: str) -> float | None:
    for one in line.get("cond") or []:
        if (one["matrix"], one["stage"], one["scaling"]) == ("clamped", stage, scaling):
            return LARGEST if what == "cond" and one["status"] in INFINITE else one[what]
    return None


def _conditioning(lines: list[dict]) -> dict[str, float | None]:
    touching = [line for line in lines if line["contacts"]["total"] > 0]
    cond = [c for line in touching if (c := _of(line, "full", "none", "cond")) is not None]
    made = [
        _of(line, "full", "none", "cond") / without
        for line in touching
        if (without := _of(line, "without_contact", "none", "cond")) and _of(line, "full", "none", "cond")
    ]
    scaled = [c for line in lines if (c := _of(line, "full", "block_jacobi", "lambda_max")) is not None]
    found = conditions(lines)
    return {
        "cond_p95": found["cond_p95"],
        "bj_p95": found["bj_p95"],
        "nc_p95": found["nc_p95"],
        "pcg": found["pcg"],
        "samples": len(cond),
        "made": max(made, default=None),
        "cond_most": max(cond, default=None),
        "bj_lambda_max": max(scaled, default=None),
    }


def _price(lines: list[dict], least: float) -> float | None:
    """Of law 1 in the form that its theorem implies: a condition number over the load of its iterate."""
    found = [
        cond / max(line["contact_load_max_N"], least)
        for line in lines
        if line["contact_load_max_N"] and (cond := _of(line, "full", "none", "cond")) is not None
    ]
    return max(found, default=None)


def _loads(record: dict, steps: dict[int, list[dict]]) -> dict[str, float | None]:
    """Of law 1 the range of loads, of law 3 how the load falls where it is too large."""
    ends = {step["step"]: step["contact_load_max_N"] for step in record["steps"]}
    loads = [load for load in ends.values() if load]
    falls, binding = [], 0
    for number, of in steps.items():
        end = ends.get(number)
        path = [line["contact_load_max_N"] for line in of]
        for k in range(len(of) - 1):
            if not end or not path[k] or not path[k + 1]:
                continue
            binding += of[k]["alpha_ccd"] < 1 and path[k + 1] > 2 * end
            if path[k] > 2 * end:
                falls.append(math.log(path[k] / path[k + 1]))
    stiff = [k for of in steps.values() for line in of if (k := line["contact_curvature_max_N_per_m"])]
    return {
        "load_high": max(loads, default=None),
        "load_low": float(np.percentile(loads, 5)) if loads else None,
        "stiffness": float(np.median(stiff)) if stiff else None,
        "binding": binding,
        "fall": float(np.mean(falls)) if falls else None,
    }


def limits(study: Study, cell: Cell) -> dict[str, float]:
    """Of the stop rules: the direction in m, the gradient in N. The inertia of a vertex, which the spec has
    for the scene as it is, follows a changed mass and a changed step length.
    """
    scene, size = sized(study, cell.place)
    slower = sections(study, scene, size)["/time"]["dt_s"] / cell.settings["/time"]["dt_s"]
    inertia = size["inertia_N_per_m"] * mass_factor(cell.place.get("setting", BASE)) * slower**2
    d_hat = cell.settings["/formulation"]["d_hat_m"]
    return {"velocity": LOOSE * d_hat, "residual": RESIDUAL * d_hat * inertia}


def _matched(study: Study, cell: Cell) -> float:
    """The load that both barriers are matched to in this scene and size."""
    _, size = sized(study, cell.place)
    return size.get("load_N", size.get("guess_N"))


def measure(study: Study, cell: Cell, record: dict) -> dict[str, float | None]:
    """Values of a row, of a record with its folder. A method in one piece has no step that converges: of it
    outcome and total work count alone.
    """
    found: dict[str, float | None] = dict.fromkeys(MEASURED)
    lines = read_trace(record, Path(record[FOLDER]))
    if not lines or "/method" in cell.settings:
        return found
    steps = by_step(lines)
    found |= {"contacts": float(np.mean([line["contacts"]["total"] for line in lines]))}
    ends = limits(study, cell)
    cut = until_slow(steps, ends["velocity"])
    found |= {f"by_{name}": value for name, value in counts(list(chain(*cut.values()))).items()}
    found |= {f"slope_{name}": value for name, value in slopes(cut).items()}
    found |= work(steps, record, ends) | _conditioning(lines) | _loads(record, steps)
    return found | {"price_most": _price(lines, _matched(study, cell) / LOADS)}

"""The formulations that the catalogue is run with. Fixed stiffnesses are matched to the loads that a scene
names, so that no calibration run is needed; a policy that makes its own stiffness is as it is.
"""

from __future__ import annotations

from barrierbench_analysis.io.errors import UserError

OWN_STIFFNESS = {"/matching/rule": "as_given"}
FORMULATIONS = {
    "log": {"/formulation/name": "log"},
    "quadratic": {"/formulation/name": "quadratic"},
    "cubic": {"/formulation/name": "cubic"},
    "cubic_dynamic_toi": {
        "/formulation/name": "cubic_dynamic",
        "/step_solver": {"name": "accumulated_toi"},
        **OWN_STIFFNESS,
    },
    "cubic_dynamic_consistent": {"/formulation/name": "cubic_dynamic_consistent", **OWN_STIFFNESS},
}
ABOUT = {
    "cubic_dynamic_toi": "kappa anew in every iteration and steps that end at an accumulated time"
    " of impact, as Ando 2024 published both, in double precision",
}
PAIR = ("log", "cubic_dynamic_consistent")  # of ./bench study robust, where none are named


def cases(labels: list[str]) -> list[dict]:
    """Of a sweep. Errors: UserError for a label that is none."""
    if unknown := [label for label in labels if label not in FORMULATIONS]:
        raise UserError(f"formulation {unknown[0]!r}: one of {', '.join(FORMULATIONS)}")
    return [{"label": label, "set": FORMULATIONS[label]} for label in labels]

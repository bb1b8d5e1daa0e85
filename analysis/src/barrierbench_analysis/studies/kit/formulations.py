"""Presets of configs/formulations as settings of a run: which of contact and strain limit take a formulation,
and which stay with the reference.
"""

import json
from difflib import get_close_matches
from functools import cache
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT

PRESETS = ROOT / "configs" / "formulations"
REFERENCE = "log"  # the formulation of the calibration run, whose run the others are compared with
VARY = ("contact", "limit", "both")
OF_LIMIT = (
    "mass_term",
    "elastic_term",
    "refresh",
    "gap_floor",
    "derivative",
)  # what the policy of a limit may take from that of contact


FORMULA = "formula:"


@cache
def _label_of_formula(name: str) -> str:
    """Errors: UserError for a formula that is no barrier."""
    from barrierbench_analysis.program.formula.compiled import compiled  # takes sympy
    from barrierbench_analysis.program.formula.grammar import FormulaError

    try:
        return compiled(name.removeprefix(FORMULA)).about["label"]
    except FormulaError as error:
        raise UserError(f"{name!r}: {error}", error.code) from None


def known() -> list[str]:
    return sorted(path.stem for path in PRESETS.glob("*.json"))


def preset(name: str) -> dict:
    """The section `formulation` of a preset, of a formula as a shape (formula:TEXT), or of a file like
    those of configs/formulations, NAME.json: of a shape or policy of a plugin, say. Errors: UserError with
    the nearest name, or with what is wrong with the formula.
    """
    if name.startswith(FORMULA):
        _label_of_formula(name)
        return {"shape": name, "argument": "gap", "stiffness_policy": {"name": "fixed"}}
    if name.endswith(".json"):
        formulation = read_object(Path(name)).get("formulation")
        if (
            not isinstance(formulation, dict)
            or not {"shape", "argument", "stiffness_policy"} <= formulation.keys()
        ):
            raise UserError(
                f"{name}#/formulation: found {json.dumps(formulation)[:60]}; allowed: a formulation with"
                " shape, argument and stiffness_policy"
            )
        return formulation
    if name not in known():
        near = get_close_matches(name, known(), 1)
        raise UserError(
            f"formulation {name!r}: one of {', '.join(known())}"
            + (f"; did you mean {near[0]!r}?" if near else "")
        )
    return read_object(PRESETS / f"{name}.json")["formulation"]


def label(name: str) -> str:
    """What a formulation is called in tables: the preset, the file without its folder and suffix, or a short
    word for the formula.
    """
    if name.startswith(FORMULA):
        return _label_of_formula(name)
    return Path(name).stem if name.endswith(".json") else name


def _limit(formulation: dict) -> dict:
    """Settings of a strain limit of this formulation. A policy that only contact can have becomes one fixed
    number, as in the program.
    """
    policy = formulation["stiffness_policy"]
    taken = {"name": "fixed"}
    if policy["name"] == "elasticity_inclusive":
        taken = {"name": policy["name"], **{key: policy[key] for key in OF_LIMIT if key in policy}}
    return {
        "/strain_limit/shape": formulation["shape"],
        "/strain_limit/argument": formulation["argument"],
        "/strain_limit/stiffness_policy": taken,
    }


def settings(name: str, vary: str, d_hat_m: float | None = None, scale: float | None = None) -> dict:
    """Overrides of a config: pointer -> value. vary: what takes the formulation; the other stays with the
    reference. scale: factor on the matched stiffness of what is varied; None leaves it. d_hat_m: kept where
    the config gives one.
    """
    chosen, reference = preset(name), preset(REFERENCE)
    of_preset = name in known()
    own = name if of_preset else {**chosen, "name": label(name)}
    found = {"/formulation": REFERENCE if vary == "limit" else own}
    if d_hat_m is not None:
        found["/formulation/d_hat_m"] = d_hat_m
    found |= _limit(reference if vary == "contact" else chosen)
    if scale is not None and vary != "limit":
        found["/formulation/stiffness_policy/scale"] = scale
    if scale is not None and vary != "contact":
        found["/strain_limit/stiffness_policy/scale"] = scale
    return found

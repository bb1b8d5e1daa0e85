"""What is scored: a formula, a shape of a plugin, a preset or a registered shape."""

import re
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.formula.compiled import compiled
from barrierbench_analysis.program.formula.grammar import FormulaError
from barrierbench_analysis.program.formula.verb import card
from barrierbench_analysis.program.start import shape_names
from barrierbench_analysis.studies.kit.formulations import known

NAME = re.compile(r"[a-z][a-z0-9_]*(:[0-9.]+)?")
RIVALS = {
    "log": {"name": "log"},
    "quadratic": {"name": "quadratic"},
    "cubic": {"name": "cubic"},
    "consistent": {"name": "cubic_dynamic_consistent"},
}


@dataclass(frozen=True)
class Candidate:
    label: str
    formulation: dict = field(hash=False)  # the section of a config
    about: str  # lines for the page
    plugins: tuple[str, ...] = ()
    place: tuple[str, ...] = ()  # words that name it on the command line


def fixed(label: str, shape: str) -> dict:
    """A shape with one matched stiffness, as the presets log, quadratic and cubic are."""
    return {"name": label, "shape": shape, "argument": "gap", "stiffness_policy": {"name": "fixed"}}


def candidate(text: str) -> Candidate:
    """Errors: UserError for what is none of them, and for a formula that is no barrier."""
    file, suffix, shape = text.partition(".so")
    if suffix and Path(f"{file}.so").is_file():
        return _of_plugin(f"{file}.so", shape.removeprefix(":"))
    if NAME.fullmatch(text):
        return _of_name(text)
    try:
        made = compiled(text.removeprefix("formula:"))
    except FormulaError as error:
        raise UserError(f"{text!r}: {error}", error.code) from None
    label = made.about["label"]
    return Candidate(label, fixed(label, f"formula:{made.about['formula']}"), card(made.about), (), (text,))


def _of_plugin(file: str, wanted: str) -> Candidate:
    before = shape_names()
    added = [name for name in shape_names([file]) if name not in before]
    if wanted not in added and (wanted or len(added) != 1):
        raise UserError(
            f"{file}: found the shapes {', '.join(added) or 'none'}; FILE.so:SHAPE names one of them"
        )
    name = wanted or added[0]
    return Candidate(
        name, fixed(name, name), f"shape {name} of the plugin {file}", (file,), (f"{file}:{name}",)
    )


def _of_name(name: str) -> Candidate:
    if name in RIVALS:
        raise UserError(f"found {name}; allowed: a barrier that is none of {', '.join(RIVALS)}")
    if name in known():
        return Candidate(name, {"name": name}, f"formulation {name} (configs/formulations)", (), (name,))
    if name.partition(":")[0] not in shape_names():
        allowed = (
            f"a formula, FILE.so, a formulation ({', '.join(known())}) or a shape of ./bench list shapes"
        )
        raise UserError(f"{name!r}: found none of that name; allowed: {allowed}")
    label = name.replace(":", "-")
    return Candidate(label, fixed(label, name), f"shape {name}", (), (name,))

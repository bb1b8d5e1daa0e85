"""The answer of a set of runs: what each kind of formulation is called, and when it is the one to use. The
one place of these names and sentences, for terminal, pages and studies.
"""

from __future__ import annotations

from collections.abc import Mapping

from .series import is_published

LOG, CUBIC = "fixed log", "fixed cubic"
PUBLISHED, POTENTIAL = "dynamic as published", "dynamic from a potential"
FIRST = (LOG, CUBIC, PUBLISHED, POTENTIAL)  # the rows that come first, in this order

NAMES = {  # preset of configs/formulations -> name
    "log": LOG,
    "cubic": CUBIC,
    "quadratic": "fixed quadratic",
    "cubic_dynamic_consistent": POTENTIAL,
    "cubic_dynamic_consistent_scaled": "dynamic from a potential, unit-consistent",
    "cubic_dynamic_lagged": "dynamic once a step",
    "cubic_dynamic": "dynamic to convergence",
    "ipc2020": "adaptive log of IPC",
    "article_cubic": "cubic of the article",
}
METHODS = {"ando2024": PUBLISHED, "ipc2020": "IPC as published"}  # of configs/methods -> name
COMMON_SOLVER = "line_search"  # of all runs that are not named apart

WHEN = {  # name -> one sentence: when it is the one to use
    LOG: "Use it when the largest load is not known: its force has no upper bound.",
    CUBIC: (
        "Use it when the largest load is known and small gaps are needed: its matrices stay better conditioned"
        " there, but a load above its capacity ends the run."
    ),
    PUBLISHED: "Use it when nobody can calibrate a stiffness and steps of 1 ms need not converge.",
    POTENTIAL: (
        "Use it when nobody can calibrate a stiffness and every step has to converge: its matrices are the"
        " worse conditioned ones."
    ),
    "fixed quadratic": "Use it like the cubic when contacts may rest farther apart.",
    "dynamic once a step": "Use it when nobody can calibrate a stiffness and loads change little in a step.",
    "dynamic to convergence": "Do not use it: the stiffness cycles, and steps may not converge.",
}


def formulation_name(preset: str, method: str | None = None, step_solver: str | None = None) -> str:
    """Of a preset, or of the label `formulation` of a record; a method in one piece has its own name
    (`NAME, changed` is none). A step solver other than the common one is named behind.
    """
    if is_published({"method": method}):
        return METHODS.get(method, f"{method} as published")
    name = NAMES.get(preset, preset)
    return f"{name} ({step_solver})" if step_solver not in (None, "", COMMON_SOLVER) else name


def name_of(row: Mapping) -> str:
    """Of a row of `runs`. A dynamic stiffness that a matching rule multiplies by s has `x s` behind."""
    name = formulation_name(row["formulation"], row.get("method"), row.get("step_solver"))
    return f"{name} x s" if row.get("matching_scale") not in (None, 1) and not is_published(row) else name


def when_to_use(name: str) -> str:
    """The sentence of a name; empty for one that has none."""
    return WHEN.get(name, "")

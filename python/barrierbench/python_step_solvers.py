"""A Python class as a step solver, for small scenes: Python decides the order of events, the program computes them."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from . import _core
from .python_sources import is_name, remember
from .step import Step

STATUSES = (
    "converged",
    "iteration_cap",
    "step_collapse",
    "line_search_failed",
    "not_descent",
    "linear_failed",
    "pin_infeasible",
    "non_finite",
)
OVER_STEPS = ("sum", "largest", "smallest")  # what the numbers of the steps make of the run's
Counters = list[tuple[str, str, str]]  # name, meaning, over steps


def _error(name: str, found: str, allowed: str) -> _core.ConfigError:
    return _core.ConfigError(f"step solver {name}: found {found}; allowed: {allowed}")


def _counters_of(solver: Any, name: str) -> Counters:
    given = getattr(solver, "counters", {})
    if not isinstance(given, Mapping):
        raise _error(name, f"counters {given!r}", 'a dict: {"backtracks": "trials beyond the first"}')
    out: Counters = []
    for counter, meaning in given.items():
        words = meaning if isinstance(meaning, tuple) else (meaning, "sum")
        if not isinstance(counter, str) or not re.fullmatch("[a-z][a-z0-9_]*[A-Za-z0-9]", counter):
            raise _error(name, f"the counter {counter!r}", "a word that ends with its unit, as drift_m or fall_J")
        if len(words) != 2 or not isinstance(words[0], str) or not words[0] or words[1] not in OVER_STEPS:
            raise _error(
                name, f"{meaning!r} of the counter {counter}", f"its meaning, or (meaning, {'|'.join(OVER_STEPS)})"
            )
        out.append((counter, words[0], words[1]))
    return out


def _numbers(name: str, counts: dict[str, float], counters: Counters) -> list[float]:
    """Errors: ConfigError for a counter that is not declared, that lacks, or that is no finite number."""
    declared = [counter for counter, _, _ in counters]
    if sorted(counts) != sorted(declared):
        raise _error(
            name, f"counts of {', '.join(sorted(counts)) or 'nothing'}", f"counts of {', '.join(declared) or 'nothing'}"
        )
    for counter in declared:
        number = counts[counter]
        try:
            finite = math.isfinite(number)
        except TypeError:
            finite = False
        if not finite:
            raise _error(name, f"counts[{counter!r}] = {number!r}", "a finite number")
    return [float(counts[counter]) for counter in declared]


def _driver(name: str, solver: Any, counters: Counters) -> Callable[[_core.Step], tuple[str, str, list[float]]]:
    def drive(core: _core.Step) -> tuple[str, str, list[float]]:
        step = Step(core, tuple(counter for counter, _, _ in counters))
        word = solver.advance(step)
        if word not in STATUSES:
            raise _error(name, f"{word!r} returned by advance", f"one of {', '.join(STATUSES)}")
        if not isinstance(step.detail, str):
            raise _error(name, f"detail {step.detail!r}", "a sentence")
        return word, step.detail, _numbers(name, step.counts, counters)

    return drive


def register_step_solver(solver: Any) -> str:
    """Makes a Python object a step solver that configs name until the process ends; returns the name.

    solver: has `name` (snake_case); `guarantee`, a sentence: what holds of every state that a step ends in; and
    `advance(step)`, which gets a barrierbench.Step, moves it and returns how it ended: "converged", or the word of
    a failure (STATUSES), which ends the run, or with /step_solver/retries has the step tried again at half its length.
    `counters`, if there are any: {name: meaning}, or {name: (meaning, "largest")}, how the numbers of the steps make
    that of the run: sum, largest or smallest. They are `step.counts`, and `solver` of the record.

    It runs on the CPU, with every Hessian clamped and saddles ignored unless the config says otherwise. That a step has
    converged is the object's own word: how far its end is from the solution is measured (`end_error_m` of the record).
    What it raises ends the step, and the run is where it was before that step. The same name again, with the same
    counters and guarantee, replaces the object; its docstring stays the first one's. None is registered while another
    thread runs. Errors: ConfigError that names what does not hold.

    >>> class Newton:
    ...     name, guarantee = "newton_of_python", "no surface passes through another in the motion of any iteration"
    ...     counters = {"backtracks": "trials beyond the first of an iteration"}
    ...     def advance(self, step):
    ...         for _ in step.iterations():
    ...             if failure := step.solve():
    ...                 return failure
    ...             bound = step.bound()
    ...             alpha = 1.0 if bound == 1 else 0.8 * bound
    ...             while alpha > 1e-14:
    ...                 if (trial := step.trial(alpha)) and trial.falls_by(-1e-4 * alpha * step.slope):
    ...                     break
    ...                 step.counts["backtracks"] += 1
    ...                 alpha /= 2
    ...             else:
    ...                 return "line_search_failed"
    ...             step.accept()
    ...             if step.converged():
    ...                 return "converged"
    ...         return "iteration_cap"
    >>> register_step_solver(Newton())
    'newton_of_python'
    """
    name = getattr(solver, "name", None)
    if not is_name(name):
        raise _error(str(name), f"name {name!r}", "a snake_case word")
    if not callable(getattr(solver, "advance", None)):
        raise _error(name, type(solver).__name__, "an object with advance(step)")
    guarantee = getattr(solver, "guarantee", None)
    if not isinstance(guarantee, str) or not guarantee.strip():
        raise _error(name, f"guarantee {guarantee!r}", "a sentence: what holds of every state that a step ends in")
    counters = _counters_of(solver, name)
    doc = inspect.getdoc(solver) or "a step solver of Python"
    _core.register_step_solver(name, doc.splitlines()[0], guarantee, counters, _driver(name, solver, counters))
    remember(solver, name)
    return name

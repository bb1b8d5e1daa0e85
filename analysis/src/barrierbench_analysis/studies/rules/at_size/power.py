"""Power of the questions that rest on a mean over scenes: how likely they are to find an effect of the size
that earlier runs lead one to expect, with their scatter between scenes (key `power` of the spec).
"""

from collections.abc import Callable

import numpy as np

from barrierbench_analysis.io.spec_file import refused
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.tables.estimate import sign_test

from .causes import CAUSES
from .p_values import LEVEL, p_above, p_other, p_within, simulated
from .questions import ALIKE, GROWS, MASKS, PERSISTS, VANISHES

HALF = 0.5
SIX = 6  # questions, over which Holm's method corrects: at worst each p counts so many times
OTHERS = 3  # formulations beside the log in question 5
# Outcome -> p of these values of scenes, as the question has it before Holm's correction.
RULES: dict[str, Callable[[list[float]], float]] = {
    "1 vanishes": lambda values: 2 * p_within(values, *VANISHES),
    "1 persists": lambda values: 2 * p_above(values, PERSISTS),
    "2 grows": lambda values: 2 * p_above(values, 0.0) if sum(values) > len(values) * GROWS else 1.0,
    "3 a cause": lambda values: len(CAUSES) * p_other(values),
    "4 equivalent": lambda values: 2 * p_within(values, *ALIKE),
    "5 more or less often": lambda values: OTHERS * sign_test(*_signs(values)),
    "6 a mask": lambda values: len(MASKS) * p_other(values),
}


def _signs(values: list[float]) -> tuple[int, int]:
    return sum(v > 0 for v in values), sum(v < 0 for v in values)


def powers(study: Study) -> dict[str, tuple[float, float]]:
    """Outcome -> power without Holm's correction, and at its largest factor. Errors: UserError for an outcome
    without a rule.
    """
    found = {}
    for k, (name, of) in enumerate(study.about["power"].items()):
        if name not in RULES:
            raise refused(study.file, f"about/power/{name}", name, ", ".join(RULES))
        p = simulated(RULES[name], of["effect"], of["scatter"], of["scenes"], seed=k + 1)
        found[name] = float(np.mean(p < LEVEL)), float(np.mean(SIX * p < LEVEL))
    return found


def table(study: Study) -> list[str]:
    """Markdown: effect, scatter, scenes and power, and which question is weak before it is asked."""
    body = []
    for name, (found, worst) in powers(study).items():
        of = study.about["power"][name]
        weak = "yes" if found < HALF else "after Holm" if worst < HALF else "no"
        numbers = [f"{np.exp(of['effect']):.3g}", f"{of['scatter']:.2g}", str(of["scenes"])]
        body.append([name, *numbers, f"{found:.2f}", f"{worst:.2f}", weak, of["from"]])
    head = [
        "outcome",
        "ratio expected",
        "scatter (ln)",
        "scenes",
        "power",
        "power at the worst factor of Holm",
        "below one half",
        "from",
    ]
    return markdown(head, body)

"""Power of the questions that rest on a mean over scenes: how likely they are to find an effect of the size
that earlier runs lead one to expect, with their scatter between scenes (key `power` of the spec).
"""

import numpy as np

from barrierbench_analysis.io.spec_file import refused
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.tables.estimate import sign_test

from .p_values import LEVEL, p_above, p_other, power, within
from .questions import ALIKE, GROWS, PERSISTS, VANISHES

HALF = 0.5


def _persists(values: np.ndarray) -> bool:
    return p_above(list(values), PERSISTS) < LEVEL / 2


def _vanishes(values: np.ndarray) -> bool:
    return within(list(values), *VANISHES)


def _grows(values: np.ndarray) -> bool:
    return p_above(list(values), 0.0) < LEVEL / 2 and float(np.mean(values)) > GROWS


def _differs(values: np.ndarray) -> bool:
    return p_other(list(values)) < LEVEL


def _alike(values: np.ndarray) -> bool:
    return within(list(values), *ALIKE)


def _one_sided(values: np.ndarray) -> bool:
    return sign_test(int(np.sum(values > 0)), int(np.sum(values < 0))) * OTHERS < LEVEL


OTHERS = 3  # formulations beside the log in question 5
# Outcome -> whether these values of scenes lead to it, before Holm's correction.
RULES = {
    "1 vanishes": _vanishes,
    "1 persists": _persists,
    "2 grows": _grows,
    "3 a cause": _differs,
    "4 equivalent": _alike,
    "5 more or less often": _one_sided,
    "6 a mask": _differs,
}


def powers(study: Study) -> dict[str, float]:
    """Outcome -> power. Errors: UserError for an outcome that has no rule here."""
    found = {}
    for k, (name, of) in enumerate(study.about["power"].items()):
        if name not in RULES:
            raise refused(study.file, f"about/power/{name}", name, ", ".join(RULES))
        found[name] = power(RULES[name], of["effect"], of["scatter"], of["scenes"], seed=k + 1)
    return found


def table(study: Study) -> list[str]:
    """Markdown: effect, scatter, scenes and power, and which question is weak before it is asked."""
    body = []
    for name, found in powers(study).items():
        of = study.about["power"][name]
        weak = (
            "yes: an effect of this size is found in less than half of such studies" if found < HALF else "no"
        )
        numbers = [f"{np.exp(of['effect']):.3g}", f"{of['scatter']:.2g}", str(of["scenes"]), f"{found:.2f}"]
        body.append([name, *numbers, weak, of["from"]])
    head = ["outcome", "ratio expected", "scatter (ln)", "scenes", "power", "below one half", "from"]
    return markdown(head, body)

"""What an iteration of Newton's method was limited by, and what it has to do with the number of contacts."""

import math
from collections import Counter, defaultdict

from barrierbench_analysis.tables.statistics import slope

# In this order: an iteration counts for the first that applies.
CAUSES = {
    "contact": "ACCD bounds the step",
    "limit": "the strain limit bounds the step",
    "indefinite": "the exact matrix is not positive definite, so that another one is solved",
    "search": "the line search takes less than the bound",
    "full": "none of these: the full step is taken",
}


def cause(line: dict) -> str:
    """Of one iteration, a line of the trace."""
    bound = min(line["alpha_ccd"], line["alpha_strain"])
    if bound < 1:
        return "contact" if line["alpha_ccd"] <= line["alpha_strain"] else "limit"
    if (line["hessian_t"] or 0) > 0 or line["hessian_fallbacks"] > 0:
        return "indefinite"
    return "full" if line["alpha"] == 1 else "search"


def by_step(lines: list[dict]) -> dict[int, list[dict]]:
    found: dict[int, list[dict]] = defaultdict(list)
    for line in lines:
        found[line["step"]].append(line)
    return found


def counts(lines: list[dict]) -> dict[str, int]:
    """Iterations of a run by their cause."""
    found = Counter(map(cause, lines))
    return {name: found[name] for name in CAUSES}


def slopes(steps: dict[int, list[dict]]) -> dict[str, float | None]:
    """Iterations of a step by cause over the logarithm of the contacts at its last iterate, over the steps of
    a run in contact: the slope of the least-squares line, None where contacts do not differ.
    """
    touching = [of for of in steps.values() if of[-1]["contacts"]["total"] > 0]
    contacts = [math.log(of[-1]["contacts"]["total"]) for of in touching]
    of_step = [Counter(map(cause, of)) for of in touching]
    return {
        name: slope((x, found[name]) for x, found in zip(contacts, of_step, strict=True)) for name in CAUSES
    }

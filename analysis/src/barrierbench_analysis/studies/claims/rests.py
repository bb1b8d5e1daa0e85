"""On what a verdict on who gets through rests: whether one of the things that the common success asks for
decides it alone.
"""

from barrierbench_analysis.studies.kit.success import COMMON, FAILURES

from . import outcomes
from .table import Runs
from .verdict import HOLDS, NOT, ONLY_IF, Judged

DECIDED = (HOLDS, NOT, ONLY_IF)
WORDS = {"close_gap": "the least gap of 0.05 d_hat"}


def rests_on(part: dict, runs: Runs, judged: Judged) -> str:
    """In words, with the verdict as it would be without; empty where every single demand may be dropped, and
    for parts that do not ask for the common success.
    """
    if part.get("rule") != "outcomes" or part.get("bad") != COMMON or judged.verdict not in DECIDED:
        return ""
    alone = []
    for name in FAILURES:
        without = Runs(runs.about, [{**row, name: 0.0} for row in runs.rows])
        verdict = outcomes.outcomes(part, without).verdict
        if verdict != judged.verdict:
            alone.append(f"{WORDS.get(name, f'`{name}`')} alone: without it `{verdict}`")
    return "rests on " + "; on ".join(alone) if alone else ""

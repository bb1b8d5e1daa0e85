"""What a part of a claim may say, held against its sweep: a word that no rule reads would change nothing and
look as if it did.
"""

from barrierbench_analysis.io.errors import UserError

from .entry import Sweep

MOST = "residual_at_most"  # of a part: a larger residual at a step end, in tolerances, is a failure
THRESHOLDS = ("above", "below", "within", "beyond")
OF_A_PROOF = ("left", "right", "u", "shape", "argument", "loads", "mass_term", "changes")
OF_A_RULE = (
    *"says rule sweep metric case over counts scenes equal beside needs bad every starts reason".split(),
    *("confirm", "limit", "theta", MOST, *THRESHOLDS),
)
KEYS = ("proof", *OF_A_RULE, *OF_A_PROOF)


def check(part: dict, sweep: Sweep) -> None:
    """Errors: UserError for a key that no rule reads and the sweep does not vary, and for a scene that the
    sweep does not have.
    """
    says, scenes = part.get("says", part), {place[0] for place in sweep.cases.values()}
    if unknown := sorted(part.keys() - {*OF_A_RULE, *sweep.axes}):
        raise UserError(
            f"{says}: {unknown[0]}: unknown; allowed: {', '.join(sorted({*OF_A_RULE, *sweep.axes}))}"
        )
    if absent := [name for name in part.get("scenes", []) if name not in scenes]:
        raise UserError(f"{says}: scenes: found {absent[0]!r}; {sweep.file} has {', '.join(sorted(scenes))}")
    if "scenes" in part and not part["scenes"]:
        raise UserError(f"{says}: scenes: found none; {sweep.file} has {', '.join(sorted(scenes))}")

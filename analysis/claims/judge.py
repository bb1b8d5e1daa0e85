"""Claims to verdicts."""

from __future__ import annotations

from dataclasses import dataclass

from . import equal_gap, numbers, outcomes
from .ends import ends_of_part
from .entry import Claim, ClaimError, read_sweep
from .metrics import METRICS
from .proofs import PROOFS, Eval
from .table import Table
from .verdict import Judged, together, undecided

RULES = {"ratio": numbers.ratio, "level": numbers.level, "slope": numbers.slope, "outcomes": outcomes.outcomes,
         "at_equal_gap": equal_gap.at_equal_gap}
BY_GAP = ("ratio", "level", "slope")  # rules that leave out runs that are not comparable


@dataclass
class Answer:
    claim: Claim
    verdict: Judged
    parts: list[Judged]

    @property
    def main(self) -> Judged | None:
        """The number of the figure: that of the first part."""
        return next((j for j in self.parts if not j.beside and j.value is not None), None)


def missing(claim: Claim, table: Table) -> list[str]:
    """One line a sweep whose records are not all there, with the command that makes them."""
    lines = []
    for name in claim.sweeps:
        sweep, runs = read_sweep(name), table.sweeps.get(name)
        found = len(runs.rows) if runs else 0
        if runs and runs.about.get("sha256") != sweep.sha256:
            lines.append(f"{claim.id}: the records of {name} are of another {sweep.file}: {sweep.command}")
        elif found < len(sweep.cases):
            lines.append(f"{claim.id}: {len(sweep.cases) - found} of {len(sweep.cases)} records of {name} are missing: {sweep.command}")
    return lines


def judge_part(part: dict, table: Table, asker: Eval) -> Judged:
    if "proof" in part:
        if part["proof"] not in PROOFS:
            raise ClaimError(f"proof {part['proof']!r}: one of {', '.join(PROOFS)}")
        judged = PROOFS[part["proof"]](part, asker)
    else:
        if part.get("rule") not in RULES:
            raise ClaimError(f"rule {part.get('rule')!r}: one of {', '.join(RULES)}, or a proof: {', '.join(PROOFS)}")
        runs = table.sweeps[part["sweep"]]
        judged = RULES[part["rule"]](part, runs)
        judged.ends = ends_of_part(part, runs.rows, read_sweep(part["sweep"]))
        judged.smallest_gaps = part["rule"] in BY_GAP and part.get("counts", "comparable") == "comparable" and runs.of_earlier_rule
    judged.says, judged.beside, judged.sweep = part["says"], part.get("beside", False), part.get("sweep", "")
    judged.machine = METRICS[part["metric"]][2] if "metric" in part else False
    return judged


def judge(claim: Claim, table: Table, asker: Eval) -> Answer:
    if lines := missing(claim, table):
        return Answer(claim, undecided("; ".join(lines)), [])
    parts = [judge_part(part, table, asker) for part in claim.parts]
    return Answer(claim, together(parts, claim.waits_for), parts)

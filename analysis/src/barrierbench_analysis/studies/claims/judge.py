"""Claims to verdicts."""

from dataclasses import dataclass, field

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit.metrics import METRICS

from . import equal_gap, numbers, outcomes, registry
from .ends import ends_of_part
from .entry import Claim, Sweep, read_sweep
from .inputs import inputs_of
from .parts import check
from .proofs import PROOFS, Eval
from .registry import State
from .rests import rests_on
from .slices import rows_of, slice_of
from .table import Runs, Table, used_metrics
from .verdict import Judged, together, undecided

RULES = {
    "ratio": numbers.ratio,
    "level": numbers.level,
    "slope": numbers.slope,
    "outcomes": outcomes.outcomes,
    "at_equal_gap": equal_gap.at_equal_gap,
}
BY_GAP = ("ratio", "level", "slope")  # rules that leave out runs that are not comparable


@dataclass
class Answer:
    claim: Claim
    verdict: Judged
    parts: list[Judged]
    state: State = State()  # of its confirmation
    confirmed: Judged | None = None  # over scenes that no rule was tuned on
    confirmed_parts: list[Judged] = field(default_factory=list)
    rests: dict[str, str] = field(default_factory=dict)  # what a part says -> the one demand that decides it
    confirmed_rests: dict[str, str] = field(default_factory=dict)

    @property
    def proven(self) -> bool:
        """Nothing but closed forms decides it: no scene does."""
        return bool(self.claim.deciding) and all("proof" in part for part in self.claim.deciding)

    @property
    def why_exploratory(self) -> str:
        """Empty for a closed form."""
        if self.proven or not self.claim.deciding:
            return ""
        changes = len(self.claim.rule_changes)
        if not changes:
            return "exploratory: its rule was not registered before its first run"
        how_many = "a change" if changes == 1 else f"{changes} changes"
        return f"exploratory: {how_many} after numbers were seen"

    @property
    def main(self) -> Judged | None:
        """The number of the first part."""
        return next((j for j in self.parts if not j.beside and j.value is not None), None)

    @property
    def confirmed_main(self) -> Judged | None:
        """That of the same part over scenes that no rule was tuned on; None where there is none, or where no
        scene decides.
        """
        if self.main is None or self.main.proof or self.confirmed is None:
            return None
        same = [j for j in self.confirmed_parts if j.says == self.main.says and j.value is not None]
        return same[0] if same else None


def stale(runs: Runs, sweep: Sweep) -> str:
    """Why kept numbers are none of this sweep; empty when they are."""
    if runs.about.get("sha256") != sweep.sha256:
        return f"the records of {sweep.name} are of another {sweep.file}"
    if "inputs_sha256" not in runs.about:
        return f"the numbers of {sweep.name} do not say of which base config, presets and meshes they are"
    if runs.about["inputs_sha256"] == inputs_of(sweep):
        return ""
    return (
        f"the records of {sweep.name} are of another base config, preset or mesh than {sweep.file} names now"
    )


def missing(claim: Claim, table: Table) -> list[str]:
    """One line a sweep whose records are not all there, or of other inputs, with the command that makes
    them."""
    lines, used = [], used_metrics([claim])
    for name in claim.sweeps:
        sweep, runs = read_sweep(name), table.sweeps.get(name, Runs({}, []))
        cases, found = len(sweep.cases), len(runs.rows)
        absent = sorted(set(used.get(name, ())) - set(runs.rows[0])) if found else []
        if name in table.sweeps and (other := stale(runs, sweep)):
            why = other
        elif absent:
            why = f"the kept numbers of {name} have no {', '.join(absent)}, which its rule reads"
        elif found < cases:
            why = f"{cases - found} of {cases} records of {name} are missing"
        else:
            continue
        lines.append(f"{claim.id}: {why}: {sweep.command}")
    return lines


def judge_part(part: dict, table: Table, asker: Eval) -> Judged:
    if "proof" in part:
        if part["proof"] not in PROOFS:
            raise UserError(f"proof {part['proof']!r}: one of {', '.join(PROOFS)}")
        judged = PROOFS[part["proof"]](part, asker)
    else:
        if part.get("rule") not in RULES:
            raise UserError(
                f"rule {part.get('rule')!r}: one of {', '.join(RULES)}, or a proof: {', '.join(PROOFS)}"
            )
        sweep = read_sweep(part["sweep"])
        check(part, sweep)
        table.sweeps[part["sweep"]].check_one_rule(sweep)
        runs = rows_of(part, table.sweeps[part["sweep"]], sweep)
        judged = RULES[part["rule"]](part, runs)
        judged.ends = ends_of_part(part, runs.rows, sweep)
        by_gap = part["rule"] in BY_GAP and part.get("counts", "comparable") == "comparable"
        judged.smallest_gaps = by_gap and runs.of_earlier_rule
        judged.rule, judged.slice = part["rule"], slice_of(part, sweep)
    judged.says, judged.beside, judged.sweep = part["says"], part.get("beside", False), part.get("sweep", "")
    judged.machine = METRICS[part["metric"]][2] if "metric" in part else False
    return judged


def _rests(parts: list[dict], judged: list[Judged], table: Table) -> dict[str, str]:
    """Of the parts that one demand decides alone."""
    found = {}
    for part, j in zip(parts, judged):
        if part.get("rule") == "outcomes":
            runs = rows_of(part, table.sweeps[part["sweep"]], read_sweep(part["sweep"]))
            if text := rests_on(part, runs, j):
                found[j.says] = text
    return found


def judge(claim: Claim, table: Table, asker: Eval, entries: dict | None = None) -> Answer:
    """The exploratory verdict, and the confirmed one where its registration is verified. entries: those of
    the registry.
    """
    state = registry.state(claim, table, registry.read() if entries is None else entries)
    if lines := missing(claim, table):
        return Answer(claim, undecided("; ".join(lines)), [], state)
    parts = [judge_part(part, table, asker) for part in claim.parts]
    answer = Answer(claim, together(parts, claim.waits_for), parts, state)
    answer.rests = _rests(list(claim.parts), parts, table)
    if state.verified:
        again = registry.as_confirmation(claim).parts
        answer.confirmed_parts = [judge_part(part, table, asker) for part in again]
        answer.confirmed_rests = _rests(list(again), answer.confirmed_parts, table)
        answer.confirmed = together(answer.confirmed_parts)
    return answer

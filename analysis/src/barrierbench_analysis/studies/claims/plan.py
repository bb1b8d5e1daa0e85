"""What a call runs, and what that is expected to take by the kept seconds of the same sweeps."""

from barrierbench_analysis.studies.kit.study.cost import in_lines

from .entry import Claim, read_sweep
from .judge import stale
from .table import FILE, Table


def sweeps_to_run(claims: list[Claim], entries: dict) -> list[str]:
    """Names of the sweeps of the claims; those of a confirmation where it is registered (`entries`)."""
    confirmed = {claim.id: claim.confirmation_sweeps for claim in claims if claim.id in entries}
    return list(
        dict.fromkeys(name for claim in claims for name in claim.sweeps + confirmed.get(claim.id, []))
    )


def plan(claims: list[Claim], table: Table, entries: dict) -> list[str]:
    """Lines, as of every study. Kept rows of another sweep file or other inputs are run again."""
    cells, there, seconds = 0, 0, []
    for name in sweeps_to_run(claims, entries):
        sweep, runs = read_sweep(name), table.sweeps.get(name)
        kept = len(runs.rows) if runs and not stale(runs, sweep) else 0
        a_run = runs.about["seconds"] / len(runs.rows) if runs and runs.rows else None
        cells, there = cells + len(sweep.cases), there + kept
        seconds += [a_run] * (len(sweep.cases) - kept)
    return in_lines("claims", FILE, cells, there, seconds)

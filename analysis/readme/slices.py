"""The log beside the cubic over theta, with the strain limit off and on: from results/claims.json to a sentence of README."""

from __future__ import annotations

import textwrap

from ..claims.entry import read_sweep
from ..claims.numbers import ratio
from ..claims.slices import rows_of
from ..claims.table import FILE, Table
from ..claims.table import read as read_claims
from .numbers import ReadmeError

SWEEP = "contact_slices"
LIMITS = ("off", "log")


def gather(table: Table | None = None) -> dict[str, list[dict]]:
    """Strain limit -> of every theta, the largest first: ratio of the 95th percentiles of cond, log over cubic, as the mean over scenes of valid
    pairs of runs; how many scenes that are, and in how many of all pairs the cubic did not end `ok`. Raises ReadmeError without the runs."""
    runs = (table or read_claims(FILE)).sweeps.get(SWEEP)
    if runs is None or not runs.rows:
        raise ReadmeError(f"{FILE}: no runs of {SWEEP}; ./bench claims K3 makes them")
    sweep = read_sweep(SWEEP)
    found: dict[str, list[dict]] = {limit: [] for limit in LIMITS}
    for limit, rows in found.items():
        for theta in sweep.axes["theta"]:
            part = {"rule": "ratio", "sweep": SWEEP, "theta": theta, "limit": limit, "metric": "cond_p95", "case": "log", "over": "cubic", "counts": "valid", "above": 1}
            mine = rows_of(part, runs, sweep)
            judged, cubics = ratio(part, mine), [row for row in mine.rows if row["case"] == "cubic"]
            if judged.value is None:
                raise ReadmeError(f"{FILE}: {SWEEP}: no pair of runs counts at theta {theta:g}, limit {limit}")
            rows.append({"theta": theta, "ratio": judged.value, "scenes": judged.scenes, "failed": sum(row["outcome"] != "ok" for row in cubics), "of": len(cubics)})
    return found


def _times(ratio: float) -> str:
    """Two digits, without a power of ten."""
    return f"{float(f'{ratio:.2g}'):g}"


def _listed(values: list[str]) -> str:
    return f"{', '.join(values[:-1])} and {values[-1]}"


def sentence(found: dict[str, list[dict]], width: int) -> list[str]:
    """What theta and the strain limit do to the ratio of condition numbers, as item 4 of the results."""
    off, on = (found[limit] for limit in LIMITS)
    scenes, thetas = [row["scenes"] for row in off + on], _listed([f"{row['theta']:g}" for row in off])
    alone, limited = (_listed([_times(row["ratio"]) for row in rows]) for rows in (off, on))
    failed = [f"{row['failed']} of {row['of']} runs at theta {row['theta']:g}" for row in off if row["failed"]]
    text = (f"4. Result 2 is one slice. theta says how small a gap, theta times d_hat, the largest load may need. At theta {thetas} the 95th percentile of the logarithm's condition "
            f"numbers is {alone} times the cubic's where contact is alone, and {limited} times with a strain limit, whose own stiffness hides that of contact (means over "
            f"{min(scenes)} to {max(scenes)} scenes of at most 576 unknowns, equal forces)")
    text += f". The cubic has a largest force: without a limit it does not get through in {_listed(failed) if len(failed) > 1 else failed[0]}" if failed else ""
    return textwrap.wrap(f"{text} ([all slices](results/CLAIMS.md)).", width, subsequent_indent="   ", break_long_words=False, break_on_hyphens=False)

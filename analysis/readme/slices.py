"""The log beside the cubic over theta, with the strain limit off and on: from the parts of a claim and
results/claims.json to a sentence of README.
"""

from __future__ import annotations

import textwrap
from dataclasses import replace

from ..claims.entry import read_claim, read_sweep
from ..claims.judge import judge_part, missing
from ..claims.proofs import Eval
from ..claims.slices import rows_of
from ..claims.table import FILE, Table
from ..claims.table import read as read_claims
from ..errors import UserError

CLAIM, SWEEP = "H1", "contact_slices"
LIMITS = ("off", "log")


def _parts() -> list[dict]:
    """The parts of the claim that ask at one theta and strain limit by how much the log is above the
    cubic."""
    return [part for part in read_claim(CLAIM).parts if part.get("sweep") == SWEEP and "above" in part]


def gather(table: Table | None = None) -> dict:
    """unknowns: smallest to largest scene, in words. limits: strain limit -> of every theta, the largest
    first, the claim's ratio of the 95th percentiles of cond, log over cubic, over how many scenes, and in how
    many runs of all the cubic did not end `ok`. Raises UserError without runs of today's sweep.
    """
    table, parts = table or read_claims(FILE), _parts()
    if lines := missing(replace(read_claim(CLAIM), parts=tuple(parts)), table):
        raise UserError(f"{FILE}: {lines[0]}")
    found: dict[str, list[dict]] = {limit: [] for limit in LIMITS}
    for part in sorted(parts, key=lambda part: -part["theta"]):
        judged = judge_part(part, table, Eval(None, {}))
        if judged.value is None:
            raise UserError(f"{FILE}: {SWEEP}: {part['says']}: no pair of runs counts")
        cubics = [
            row["outcome"]
            for row in rows_of(part, table.sweeps[SWEEP], read_sweep(SWEEP)).rows
            if row["case"] == part["over"]
        ]
        found[part["limit"]].append(
            {
                "theta": part["theta"],
                "ratio": judged.value,
                "scenes": judged.scenes,
                "failed": sum(word != "ok" for word in cubics),
                "of": len(cubics),
            }
        )
    return {"unknowns": table.sweeps[SWEEP].about["unknowns"], "limits": found}


def _times(ratio: float) -> str:
    """Two digits, without a power of ten."""
    return f"{float(f'{ratio:.2g}'):g}"


def _listed(values: list[str]) -> str:
    return f"{', '.join(values[:-1])} and {values[-1]}" if len(values) > 1 else values[0]


def sentence(found: dict, width: int) -> list[str]:
    """What theta and the strain limit do to the ratio of condition numbers, as item 4 of the results."""
    off, on = (found["limits"][limit] for limit in LIMITS)
    scenes, thetas = [row["scenes"] for row in off + on], _listed([f"{row['theta']:g}" for row in off])
    without, limited = (_listed([_times(row["ratio"]) for row in rows]) for rows in (off, on))
    failed = [
        f"{row['failed']} of {row['of']} runs at theta {row['theta']:g}" for row in off if row["failed"]
    ]
    text = (
        "4. Result 2 is one slice. Forces are made equal at the gap theta d_hat under the largest load, so"
        f" that a smaller theta lets contacts come closer. At theta {thetas} the 95th percentile of the"
        f" logarithm's condition numbers over a run is {without} times the cubic's without a strain limit,"
        f" and {limited} times with one (geometric means over those {min(scenes)} to {max(scenes)} scenes, of"
        f" {found['unknowns']} unknowns, in which both get through)"
    )
    text += (
        ". Without a limit the cubic, whose force has a largest value, does not get through in"
        f" {_listed(failed)}"
        if failed
        else ""
    )
    return textwrap.wrap(
        f"{text} ([all slices](results/CLAIMS.md)).",
        width,
        subsequent_indent="   ",
        break_long_words=False,
        break_on_hyphens=False,
    )

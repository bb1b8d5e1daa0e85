"""The rule of comparability (docs/theory/audit.md) for two runs of which neither is the reference of
the other: at which gaps each pair of bodies carries its load. The program judges a run against its reference;
a test holds this rule to its verdicts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

QUANTILES = ("gap_rel_p05", "gap_rel_median", "gap_rel_p95")
# A pair counts with either, in one of the two runs; shares are sums over steps, and rounded.
LEAST_LOAD_SHARE, LEAST_TIME_SHARE = 0.01, 0.1 * (1 - 1e-9)
MAX_RATIO = 2.0
NO_LOAD = 1.0  # from d_hat on the barrier carries nothing

Gaps = dict[str, list]  # pair of bodies -> its three quantiles, and whether it counts


@dataclass(frozen=True)
class Apart:
    """The pair and the quantile in which two runs disagree most."""

    pair: str
    quantile: str
    ratio: float | None  # of the first run over the second; None: a gap is not above 0, surfaces overlap

    @property
    def comparable(self) -> bool:
        return self.ratio is not None and 1 / MAX_RATIO <= self.ratio <= MAX_RATIO

    @property
    def factor(self) -> float:
        """How far apart, as the logarithm of a factor."""
        return math.inf if self.ratio is None else abs(math.log(self.ratio))


def gaps_of(record: dict) -> Gaps | None:
    """What the rule reads of a record; None where it has no such gaps, as before 3.5.0."""
    pairs = record["summary"].get("contact_gaps")
    if pairs is None:
        return None
    return {
        pair: [
            *(of[name] for name in QUANTILES),
            of["load_share"] >= LEAST_LOAD_SHARE or of["time_share"] >= LEAST_TIME_SHARE,
        ]
        for pair, of in sorted(pairs.items())
    }


def _ratio(mine: float, other: float) -> float | None:
    return mine / other if mine > 0 and other > 0 else None


def farthest(run: Gaps, other: Gaps) -> Apart | None:
    """None when no pair carries load in either. Among equals the first, as in the program."""
    every = sorted({*run, *other})
    counting = [pair for pair in every if any(gaps[pair][-1] for gaps in (run, other) if pair in gaps)]
    none = [NO_LOAD] * len(QUANTILES)
    found = [
        Apart(pair, name, _ratio(run.get(pair, none)[k], other.get(pair, none)[k]))
        for pair in counting or every
        for k, name in enumerate(QUANTILES)
    ]
    return max(found, key=lambda apart: apart.factor, default=None)

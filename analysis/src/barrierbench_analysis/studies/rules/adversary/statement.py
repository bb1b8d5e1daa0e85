"""A statement that is attacked: what it compares, on which side of which threshold it says the number is."""

import math
from dataclasses import dataclass

from .region import Region

EVERY, MEAN = "every run", "mean over scenes"
INSIDE = ("within",)  # sides whose ends hold; those of above, below and beyond do not


@dataclass(frozen=True)
class Side:
    """Where the number is if the statement is right: above `low`, below `high`, within both, or beyond one of
    them. Of ratios these are logarithms. A Threshold of the claims has the same attributes."""

    kind: str
    low: float = -math.inf
    high: float = math.inf


def contrary(side: Side, x: float) -> float:
    """How far a number is on the other side; below 0 it is on that of the statement."""
    return {
        "above": side.low - x,
        "below": x - side.high,
        "within": max(side.low - x, x - side.high),
        "beyond": min(x - side.low, side.high - x),
    }[side.kind]


@dataclass(frozen=True)
class Statement:
    """label: a word. refuted_by: in how many scenes a draw has to contradict it to refute it; 0 of a mean,
    which no draw refutes. arms: the runs of a draw. compares: what is made of their numbers (COMPARED).
    part: that of a claim, with what its rule reads. comparable: whether runs at other gaps make no ratio.
    """

    label: str
    threshold: str
    side: Side | None
    arms: tuple[str, ...]
    compares: str
    metric: str
    region: Region
    source: str = ""
    says: str = ""
    verdict: str = ""
    refuted_by: int = 0
    part: dict | None = None
    comparable: bool = False

    @property
    def kind(self) -> str:
        return EVERY if self.refuted_by else MEAN

    def contradicts(self, margin: float) -> bool:
        """A number on the threshold is on the other side of above, below and beyond."""
        return margin > 0 or (margin == 0 and self.side is not None and self.side.kind not in INSIDE)


@dataclass(frozen=True)
class Left:
    """A statement that is not attacked, and why."""

    source: str
    says: str
    why: str

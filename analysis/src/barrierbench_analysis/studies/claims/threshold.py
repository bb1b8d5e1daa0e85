"""What a part of a claim asks of a number."""

from __future__ import annotations

import math

from barrierbench_analysis.io.errors import UserError

from .verdict import HOLDS, NOT, OPEN


class Threshold:
    """above, below: of one number. within, beyond: of the range [1/t, t] for ratios, [-t, t] for others."""

    def __init__(self, part: dict, log: bool):
        kinds = [k for k in ("above", "below", "within", "beyond") if k in part]
        if len(kinds) != 1:
            raise UserError(f"{part.get('says', part)}: one of above, below, within, beyond is needed")
        self.kind, number = kinds[0], part[kinds[0]]
        t = math.log(number) if log else number
        self.low, self.high = (t, t) if self.kind in ("above", "below") else (-t, t)
        name = {
            "within": "within a factor" if log else "at most +-",
            "beyond": "beyond a factor" if log else "more than +-",
        }
        self.text = f"{name.get(self.kind, self.kind)} {number:g}"
        self.bounds = (number,) if self.low == self.high else (1 / number if log else -number, number)

    def judge(self, lower: float, upper: float) -> str:
        """Of all numbers between two: holds, does not, or both occur. above, below and beyond are strict, so
        that a number on the threshold does not hold; within, whose opposite is beyond, has its ends.
        """
        inside, outside = lower >= self.low and upper <= self.high, upper < self.low or lower > self.high
        if self.kind == "within":
            return HOLDS if inside else NOT if outside else OPEN
        if self.kind == "beyond":
            return HOLDS if outside else NOT if inside else OPEN
        if self.kind == "above":
            return HOLDS if lower > self.low else NOT if upper <= self.low else OPEN
        return HOLDS if upper < self.low else NOT if lower >= self.low else OPEN

"""Cells of a gap map that need no run, since a run that is there decides them. A run that ended
`stall_overload` bore a load over what its barrier can carry. At a smaller theta the same load is matched by a
smaller kappa, kappa |b'(theta)| being that load, so that the largest force kappa max|b'| is smaller too: the
cells of the same scene, resolution, limit and shape at smaller theta end in the same way. A cell that follows
from such a run and was run all the same checks the rule.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

from barrierbench_analysis.io.text_table import markdown

from .rows import CANNOT, NOT_RUN, PLACE

OVERLOAD = "stall_overload"
REASON = f"a run at a larger theta ended {OVERLOAD}: at a smaller one the barrier carries less"


def _series(place: tuple) -> tuple:
    """All of a place but theta, which is its last."""
    return place[:-1]


def place_of(row: dict) -> tuple:
    return tuple(row[column] for column in PLACE)


def overloaded(ends: dict[tuple, str]) -> dict[tuple, float]:
    """Of the outcomes of places: scene, resolution, shape and limit -> the largest theta at which a run ended
    so.
    """
    found: dict[tuple, float] = {}
    for place, outcome in ends.items():
        if outcome == OVERLOAD:
            found[_series(place)] = max(found.get(_series(place), 0.0), place[-1])
    return found


def follows(place: tuple, known: dict[tuple, float]) -> tuple | None:
    """The place of the run from which it follows how this cell ends; None where no run decides it."""
    theta = known.get(_series(place))
    return None if theta is None or not place[-1] < theta else (*_series(place), theta)


@dataclass(frozen=True)
class Skip:
    place: tuple
    follows: tuple

    def json(self) -> dict:
        return {"place": list(self.place), "reason": REASON, "follows": list(self.follows)}


@dataclass(frozen=True)
class Skips:
    """left_out: cells without a run. checks: cells that were run all the same -> their outcome."""

    left_out: list[Skip]
    checks: dict[Skip, str]

    @property
    def held(self) -> int:
        """Checks that ended as was inferred."""
        return sum(outcome == OVERLOAD for outcome in self.checks.values())

    def sample(self, most: int, seed: int) -> list[tuple]:
        """Places of cells to be run all the same."""
        places = [skip.place for skip in self.left_out]
        return random.Random(seed).sample(places, min(most, len(places)))


def skips_of(rows: list[dict]) -> Skips:
    known, found = overloaded({place_of(row): row["outcome"] for row in rows}), Skips([], {})
    for row in rows:
        by = follows(place_of(row), known)
        if by is None or row["outcome"] == CANNOT:
            continue
        skip = Skip(place_of(row), by)
        if row["outcome"] == NOT_RUN:
            found.left_out.append(skip)
        else:
            found.checks[skip] = row["outcome"]
    return found


def _table(skips: Skips) -> list[str]:
    """A row a cell that was left out, or that ended otherwise than was inferred."""
    wrong = {skip: outcome for skip, outcome in skips.checks.items() if outcome != OVERLOAD}
    ends = {
        **dict.fromkeys(skips.left_out, "left out"),
        **{skip: f"**{end}**" for skip, end in wrong.items()},
    }
    head = ["scene", "level", "shape", "conditions", "theta", "a run decides it, at theta", "how it ended"]
    rows = []
    for skip, end in ends.items():
        scene, resolution, shape, limit, theta = skip.place
        cells = [scene, resolution, f"`{shape}`", f"limit {limit}", f"{theta:g}"]
        rows.append([*cells, f"{skip.follows[-1]:g}", end])
    return markdown(head, rows) if rows else []


def lines(skips: Skips) -> list[str]:
    """The part of the page: counts, each cell that was left out, each check that ended otherwise."""
    if not skips.left_out and not skips.checks:
        return []
    return [
        "## Cells that a run decides",
        "",
        (
            f"A cell is left out where {REASON} (docs/results/method/gap-map.md). {len(skips.left_out)} cells"
            f" are left out, and count as not run. {len(skips.checks)} such cells were run all the same, of"
            f" which {skips.held} ended {OVERLOAD}; `./bench study gap-map --spot-check N` runs N more."
        ),
        "",
        *_table(skips),
        "",
    ]

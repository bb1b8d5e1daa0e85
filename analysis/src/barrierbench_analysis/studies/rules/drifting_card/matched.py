"""Stiffnesses that carry the card at one gap: a search of a few runs for each formulation and surface."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from barrierbench_analysis.studies.kit.alone import REFUSED, TIMEOUT
from barrierbench_analysis.studies.kit.study import store
from barrierbench_analysis.studies.kit.study.collect import sources_of
from barrierbench_analysis.studies.kit.study.spec import Case, Study
from barrierbench_analysis.tables.numbers import rounded

from . import arms
from .arms import ALL_PAIRS, Arm

MATCH = "match"  # before the number of a run of a search, in its label
START = 1.0
STIFFER = 4.0  # a scale over one that carries nothing, without one that does
MARGIN = 1.01  # of a scale over one that is too soft
DIGITS = 6  # of a scale

Rows = dict[str, store.Row]


@dataclass(frozen=True)
class Search:
    """The runs of a search, and the scale that it found; None while it goes on, or where it ended."""

    cases: list[Case]
    scale: float | None


def slack(gap: float) -> float:
    """2 ln(1 - gap): how the force of a barrier changes with the gap, near enough to begin a search."""
    return 2 * math.log(1 - gap)


def _next(tried: list[tuple[float, float]], theta: float, too_soft: float) -> float:
    """The scale after those that were tried, as (scale, gap), above one that is too soft to carry the card.
    The force of the card's weight stays, so ln scale falls as the slack grows: by as much at first, then as
    the last two tries have it.
    """
    (scale, gap) = tried[-1]
    slope = -1.0
    if len(tried) > 1 and tried[-2][1] != gap:
        before = tried[-2]
        slope = math.log(scale / before[0]) / (slack(gap) - slack(before[1]))
    found = scale * math.exp(slope * (slack(theta) - slack(gap)))
    return found if found > MARGIN * too_soft else math.sqrt(too_soft * scale)


def search(study: Study, arm: Arm, rows: Rows) -> Search:
    """The runs of an arm as far as their rows are there, and the next one. A refused one ends the search,
    and so does one that takes too long, which says nothing of its stiffness."""
    theta, cases, tried = study.about["theta"], [], []
    scale, too_soft = START, 0.0
    for k in range(study.about["tries"]):
        cases.append(arms.case(study, arm, f"{MATCH}{k + 1}", 0, scale))
        row = rows.get(study.cell(cases[-1]).key)
        if row is None or row.outcome in (REFUSED, TIMEOUT):
            return Search(cases, None)
        gap = row.values["gap"]
        if gap is None or not 0 < gap < 1:  # it fails, as a run does whose contacts are too soft
            too_soft = scale
            scale = math.sqrt(scale * tried[-1][0]) if tried else STIFFER * scale
        else:
            tried.append((scale, gap))
            if abs(gap - theta) <= study.about["within"]:
                break
            scale = _next(tried, theta, too_soft)
        scale = rounded(scale, DIGITS)
    best = min(tried, key=lambda one: abs(one[1] - theta), default=(None, None))
    return Search(cases, best[0])


def matched_as(arm: Arm) -> Arm:
    """The arm whose stiffness an arm has: sets of pairs without weights are compared at that of all pairs."""
    has_own = arm.model in (ALL_PAIRS, arms.PLANE, *arms.weightings())
    return arm if has_own else replace(arm, model=ALL_PAIRS)


def rows_of_today(study: Study) -> Rows:
    """key -> kept row that has every value of today."""
    now = sources_of(study).items()
    kept = store.read_rows(store.file_of(study))
    return {key: row for key, row in kept.items() if now <= row.sources.items()}


def cells(study: Study) -> Iterator[Case]:
    """The runs of all searches, and the placements of each arm whose search has ended."""
    rows = rows_of_today(study)
    found: dict[Arm, Search] = {}
    for arm in arms.arms(study):
        if matched_as(arm) == arm:
            found[arm] = search(study, arm, rows)
            yield from found[arm].cases
    for arm in arms.arms(study):
        scale = found[matched_as(arm)].scale
        for placement in range(1, study.about["placements"] + 1) if scale else ():
            yield arms.case(study, arm, str(placement), placement, scale)

"""The draws of each statement, as cells. The label of a draw is its number, and that of the draw that it is
close to: `17of4`. So the label of a kept row gives its whole draw, and its cell stays the same whatever rows
come after it or are made again.
"""

import random
import re
from collections.abc import Iterator
from dataclasses import dataclass

from barrierbench_analysis.studies.kit.study import store
from barrierbench_analysis.studies.kit.study.collect import sources_of
from barrierbench_analysis.studies.kit.study.spec import Case, Study
from barrierbench_analysis.tables.words import counted

from .compared import Contrast, contrast
from .gathered import gathered
from .region import Point
from .statement import Statement

LABEL = re.compile(r"(\d+)(?:of(\d+))?")
GROWTH = 4  # a round has at most one new draw for so many that are there, so that rounds stay few


@dataclass(frozen=True)
class Draw:
    """One comparison. rows: arm -> kept run, of those that are there, in the order of the arms."""

    statement: Statement
    label: str
    point: Point
    rows: dict[str, store.Row]

    @property
    def number(self) -> int:
        return int(LABEL.fullmatch(self.label)[1])

    @property
    def whole(self) -> bool:
        return len(self.rows) == len(self.statement.arms)

    @property
    def seconds(self) -> float:
        return sum(row.seconds or 0.0 for row in self.rows.values())

    @property
    def contrast(self) -> Contrast | None:
        """None while a run is missing."""
        return contrast(self.statement, self.rows) if self.whole else None


def point_of(statement: Statement, seed: int, label: str, points: dict[int, Point]) -> Point:
    """The point of a draw: a function of the seed, the statement, its number and, of a draw that is close to
    another one, of that one's point. points: of the draws before it."""
    number, near = LABEL.fullmatch(label).groups()
    rng = random.Random(f"{seed} {statement.label} {number}")
    return statement.region.near(points[int(near)], rng) if near else statement.region.draw(rng)


def cases_of(study: Study, draw: Draw) -> list[Case]:
    """Of a draw a case for each arm."""
    found = []
    for arm in draw.statement.arms:
        base, settings = draw.statement.region.settings(draw.point, arm)
        place = {"statement": draw.statement.label, "draw": draw.label, "scene": draw.point.scene, "arm": arm}
        found.append(Case(place, settings, base))
    return found


def _with_rows(study: Study, draw: Draw, rows: dict[str, store.Row]) -> Draw:
    kept = {
        arm: study.cell(case).key
        for arm, case in zip(draw.statement.arms, cases_of(study, draw), strict=True)
    }
    return Draw(
        draw.statement, draw.label, draw.point, {arm: rows[key] for arm, key in kept.items() if key in rows}
    )


def kept_draws(study: Study, statement: Statement, rows: dict[str, store.Row]) -> list[Draw]:
    """Those of which a run has a row, in the order of their numbers. Rows of another region or seed have
    other keys and are of no draw, nor are draws close to them."""
    labels = {row.place["draw"] for row in rows.values() if row.place["statement"] == statement.label}
    points: dict[int, Point] = {}
    found = []
    for label in sorted(labels, key=lambda label: int(LABEL.fullmatch(label)[1])):
        number, near = LABEL.fullmatch(label).groups()
        if near and int(near) not in points:
            continue
        point = point_of(statement, study.about["seed"], label, points)
        draw = _with_rows(study, Draw(statement, label, point, {}), rows)
        if draw.rows:
            points[int(number)] = point
            found.append(draw)
    return found


def most_contrary(draws: list[Draw]) -> Draw | None:
    """The first of those whose margin is largest; None where no draw compares anything."""
    said = [(found.margin, draw) for draw in draws if (found := draw.contrast) and found.margin is not None]
    return max(said, key=lambda one: one[0])[1] if said else None


def hours(draws: list[Draw]) -> float:
    """Of one core, of all runs of some draws."""
    return sum(draw.seconds for draw in draws) / 3600


def spent(study: Study, draws: list[Draw]) -> str:
    """What ended the search of a statement; empty while it goes on."""
    about = study.about
    if hours(draws) >= about["hours_each"]:
        return "hours"
    return "draws" if len(draws) >= about.get("draws_each", len(draws) + 1) else ""


def next_draws(study: Study, statement: Statement, draws: list[Draw]) -> list[Draw]:
    """The draws of the next round: of even number anywhere in the region, of odd number close to the most
    contrary draw so far, where there is one. None once the budget of the statement is spent."""
    if spent(study, draws):
        return []
    first = max((draw.number for draw in draws), default=-1) + 1
    most = max(study.about["round"], len(draws) // GROWTH)
    if "draws_each" in study.about:
        most = min(most, study.about["draws_each"] - len(draws))
    points, best, found = {draw.number: draw.point for draw in draws}, most_contrary(draws), []
    for number in range(first, first + most):
        label = f"{number}of{best.number}" if best and number % 2 else str(number)
        found.append(Draw(statement, label, point_of(statement, study.about["seed"], label, points), {}))
    return found


def rows_of_today(study: Study) -> dict[str, store.Row]:
    """key -> kept row that has every value of today."""
    now = sources_of(study).items()
    kept = store.read_rows(store.file_of(study))
    return {key: row for key, row in kept.items() if now <= row.sources.items()}


def cells(study: Study) -> Iterator[Case]:
    """Of each statement the draws that have rows, and those of the next round."""
    rows = rows_of_today(study)
    for statement in gathered(study).statements:
        draws = kept_draws(study, statement, rows)
        for draw in (*draws, *next_draws(study, statement, draws)):
            yield from cases_of(study, draw)


def planned(study: Study, rows: dict[str, store.Row]) -> list[str]:
    """Lines of a plan: of each statement draws, core hours, and what is left of its budget."""
    lines = []
    for statement in gathered(study).statements:
        draws = kept_draws(study, statement, rows)
        left = max(0.0, study.about["hours_each"] - hours(draws))
        why = spent(study, draws)
        rest = f"search ended by its {why}" if why else f"{left:.2f} h left"
        lines.append(
            f"{statement.label}: {counted(len(draws), 'draw')}, {hours(draws):.2f} core hours, {rest}"
        )
    return lines

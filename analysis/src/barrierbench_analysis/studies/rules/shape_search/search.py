"""The cells of the study: each is one shape on the kept steps of one half. Searches see rows of `tune` alone.

A row has the parameters of its shape, and the search is replayed from them. The label of a point is its
generation and its place in it, as `g3.07`.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.studies.kit.study import store
from barrierbench_analysis.studies.kit.study.collect import sources_of
from barrierbench_analysis.studies.kit.study.spec import Case, Study
from barrierbench_analysis.studies.rules.least_price import exponent
from barrierbench_analysis.studies.steps.step_corpus_states import HALVES
from barrierbench_analysis.tables.statistics import geometric

from . import shape
from .evolution import Evolution
from .states import STATES

TUNE, REPORT = HALVES
KNOWN = "known"  # in place of a search, of shapes that the program has
BEST, CENTRE = "best", "centre"  # of a search that has ended
LOG = "log"  # with which others are compared
LAW = "minimax"  # at the exponent of law 1, which follows from the loads of the log in these steps
LABEL = re.compile(r"g(\d+)\.(\d+)")
PARAMETERS = "/parameters"  # of a cell
Rows = dict[str, store.Row]


@dataclass(frozen=True)
class Search:
    """One, as far as its rows go. todo: the points of its generation that have no row, by label. best: label
    and row with the least work."""

    name: str
    evolution: Evolution
    rows: list[store.Row]
    todo: dict[str, list[float]]
    ended: bool

    @property
    def best(self) -> store.Row | None:
        return min(self.rows, key=work, default=None)


def rows_of_today(study: Study) -> Rows:
    """key -> kept row that has every value of today."""
    now = sources_of(study).items()
    kept = store.read_rows(store.file_of(study))
    return {key: row for key, row in kept.items() if now <= row.sources.items()}


def work(row: store.Row) -> float:
    """What a search makes small: the mean over states of ln(Newton iterations). A step that does not converge
    counts as the limit of iterations."""
    return sum(map(math.log, row.values["iterations"])) / len(row.values["iterations"])


def rounded(parameters) -> list[float]:
    return [round(float(x), shape.DIGITS) for x in parameters]


def _case(study: Study, half: str, search: str, label: str, settings: dict, against: dict) -> Case:
    names = study.about["states"][half]
    hashes = [read_object(STATES / f"{name}.json")["archive"]["sha256"] for name in names]
    against = {**against, "states": hashes, "theta": study.about["theta"]}
    return Case({"half": half, "search": search, "shape": label}, settings, against=against)


def known_case(study: Study, half: str, label: str, name: str) -> Case:
    """A shape that the program has, by its name."""
    return _case(study, half, KNOWN, label, {"/shape": name}, {"label": label})


def found_case(study: Study, half: str, search: str, label: str, parameters: list[float]) -> Case:
    """A shape of a search. Another start, seed or size of generations is another search."""
    about = study.about
    against = {"search": [about["searches"][search], *(about[k] for k in ("seed", "step", "generation"))]}
    return _case(study, half, search, label, {PARAMETERS: parameters}, against | {"label": label})


def replayed(study: Study, name: str, rows: Rows) -> Search | None:
    """A search from its kept rows: generation by generation, as far as they are whole. None before the shape
    that it begins with has its row."""
    about = study.about
    begin = known_row(study, rows, about["searches"][name])
    if begin is None:
        return None
    seed = [*about["searches"]].index(name) + about["seed"]
    start = shape.parameters_of(begin.values["curvature"])
    evolution = Evolution(start, about["step"], about["generation"], seed)
    mine = _rows_of(study, name, rows)
    told: list[store.Row] = []
    while evolution.generation < about["generations"]:
        labels = [f"g{evolution.generation}.{place:02}" for place in range(evolution.size)]
        there = [mine[label] for label in labels if label in mine]
        if len(there) < evolution.size:
            asked = zip(labels, map(rounded, evolution.ask()))
            left = {label: point for label, point in asked if label not in mine}
            return Search(name, evolution, told + there, left, ended=False)
        evolution.tell([row.values["parameters"] for row in there], list(map(work, there)))
        told += there
    return Search(name, evolution, told, {}, ended=True)


def _rows_of(study: Study, name: str, rows: Rows) -> dict[str, store.Row]:
    """label -> row of a point of this very search, measured on `tune`; none of `report`."""
    found = {}
    for row in rows.values():
        label = row.place["shape"]
        if (row.place["half"], row.place["search"]) != (TUNE, name) or not LABEL.fullmatch(label):
            continue
        if study.cell(found_case(study, TUNE, name, label, row.values["parameters"])).key == row.key:
            found[label] = row
    return found


def known_row(study: Study, rows: Rows, name: str, half: str = TUNE) -> store.Row | None:
    """Of a shape of the program that the spec names."""
    return rows.get(study.cell(known_case(study, half, name, name)).key)


def law_exponent(study: Study, rows: Rows) -> float | None:
    """Of `minimax`, by the geometric mean over steps of the range of loads that the log had in them."""
    log = known_row(study, rows, LOG)
    ratios = [one for one in log.values["load_ratio"] if one] if log else []
    return exponent(LAW, geometric(ratios), study.about["theta"]) if ratios else None


def known_shapes(study: Study, rows: Rows) -> dict[str, str]:
    """label -> name, of the shapes of the program. That of law 1 is known once the log has its row."""
    found = {name: name for name in study.about["shapes"]}
    a = law_exponent(study, rows)
    return found | ({LAW: f"{LAW}:{a:.3g}"} if a else {})


def ends_of(study: Study, search: Search) -> Iterator[Case]:
    """Of a search that has ended its best shape and the centre of its draws, on the halves that they were not
    measured on."""
    centre = rounded(search.evolution.mean)
    yield found_case(study, TUNE, search.name, CENTRE, centre)
    yield found_case(study, REPORT, search.name, CENTRE, centre)
    yield found_case(study, REPORT, search.name, BEST, search.best.values["parameters"])


def searches_of(study: Study, rows: Rows) -> list[Search]:
    found = (replayed(study, name, rows) for name in study.about["searches"])
    return [one for one in found if one]


def cells(study: Study) -> Iterator[Case]:
    """Known shapes on both halves, the points of each search that have rows, those of its next generation,
    and what a search ends with."""
    rows = rows_of_today(study)
    for half in HALVES:
        for label, name in known_shapes(study, rows).items():
            yield known_case(study, half, label, name)
    for search in searches_of(study, rows):
        for row in search.rows:
            yield found_case(study, TUNE, search.name, row.place["shape"], row.values["parameters"])
        for label, point in search.todo.items():
            yield found_case(study, TUNE, search.name, label, point)
        if search.ended:
            yield from ends_of(study, search)


def planned(study: Study, rows: Rows) -> list[str]:
    """Lines of a plan: how far each search is."""
    return [
        f"{one.name}: {one.evolution.generation} of {study.about['generations']} generations"
        for one in searches_of(study, rows)
    ]

"""The numbers of the page: work of each shape, rho(u), and whether what was found is the shape of law 1."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.numbers import significant, written
from barrierbench_analysis.tables.statistics import Ratio, geometric, ratio_over
from barrierbench_analysis.tables.words import counted, listed

from . import search, shape
from .measured import CONVERGED
from .search import BEST, CENTRE, HALVES, LAW, LOG, TUNE, Search

# Largest standard deviation of a parameter in the last draws above which a search has not converged: the
# parameters are logarithms, so 0.2 lets b'' grow by a fifth more or less at a knot.
SETTLED = 0.2
OVER = {"iterations": "Newton iterations over the log", "products": "products over the log"}


@dataclass(frozen=True)
class Found:
    """A shape as the page shows it: its rows by half, and rho at the gaps CURVE."""

    label: str
    rows: dict[str, Row]
    rho: list[float]

    @property
    def rests(self) -> tuple[float, float]:
        """The gaps between which 5 % and 95 % of the load rest, the widest range over the steps of `tune`."""
        values = self.rows[TUNE].values
        return min(filter(None, values["gap_p05"])), max(filter(None, values["gap_p95"]))


def _found(study: Study, one: Search, rows: search.Rows) -> Iterator[Found]:
    """Best shape and centre of a search; of one that goes on the best, on the half of the search alone."""
    cases = {(TUNE, BEST): one.best} if one.best else {}
    if one.ended:
        for case in search.ends_of(study, one):
            if row := rows.get(study.cell(case).key):
                cases[case.place["half"], case.place["shape"]] = row
    for label in (BEST, CENTRE):
        mine = {half: cases[half, label] for half in HALVES if (half, label) in cases}
        if mine:
            rho = shape.relative_stiffness([*mine.values()][0].values["parameters"], shape.CURVE)
            yield Found(f"{one.name}, {label}", mine, rho)


def _known(study: Study, rows: search.Rows) -> Iterator[Found]:
    for label, name in search.known_shapes(study, rows).items():
        cells = {half: study.cell(search.known_case(study, half, label, name)) for half in HALVES}
        if mine := {half: rows[cell.key] for half, cell in cells.items() if cell.key in rows}:
            title = f"{LAW} (law 1: {name.partition(':')[2]})" if label == LAW else label
            yield Found(title, mine, [*mine.values()][0].values["rho"])


def over(row: Row, under: Row, value: str) -> Ratio | None:
    """Geometric mean over states of a ratio, of those where both have a value above 0."""
    pairs = zip(row.values[value], under.values[value], strict=True)
    logs = [math.log(a / b) for a, b in pairs if a and b]
    return ratio_over(logs) if logs else None


def _line(one: Found, half: str, log: Row | None) -> list[str]:
    row = one.rows[half]
    gaps = [gap for gap in row.values["gap_min"] if gap]
    ratios = [over(row, log, value) if log else None for value in OVER]
    return [
        one.label,
        significant(geometric(row.values["iterations"]), 4),
        *map(written, ratios),
        str(sum(end != CONVERGED for end in row.values["ends"])),
        f"{row.place['shape']}" if one.label.endswith(BEST) else "",
        significant(min(gaps, default=None), 2),
    ]


def _work(shapes: list[Found], half: str) -> str:
    """A line for each shape that has a row on a half, the least work first."""
    there = sorted((one for one in shapes if half in one.rows), key=lambda one: search.work(one.rows[half]))
    log = next((one.rows[half] for one in there if one.label == LOG), None)
    head = ["shape", "Newton iterations", *OVER.values(), "not converged", "point", "smallest gap"]
    return "\n".join(markdown(head, [_line(one, half, log) for one in there]))


def _rho(shapes: list[Found]) -> str:
    places = [shape.CURVE.index(u) for u in shape.TABLE]
    body = [[one.label, *(significant(one.rho[k], 3) for k in places)] for one in shapes]
    return "\n".join(markdown(["shape", *(f"u = {u:g}" for u in shape.TABLE)], body))


def apart(one: Found, other: Found) -> tuple[float, float]:
    """Least and largest ratio of rho over that of another shape, over the gaps at which its contacts rest."""
    low, high = one.rests
    ratios = [a / b for u, a, b in zip(shape.CURVE, one.rho, other.rho, strict=True) if low <= u <= high]
    return min(ratios), max(ratios)


def _same(study: Study, found: list[Found], law: Found | None, spreads: dict[str, float]) -> list[str]:
    """A computed sentence for each shape that was found. spreads: of the last draws, by name of a search."""
    most, lines = study.about["same_within"], []
    for one in found if law else []:
        low, high = apart(one, law)
        spread = spreads[one.label.partition(",")[0]]
        if spread > SETTLED:
            verdict = f"has not settled (its draws still scatter by {spread:.2g}) beside"
        else:
            is_same = high <= most and low >= 1 / most
            verdict = "is the same shape as" if is_same else "is another shape than"
        gaps = " to ".join(f"{u:.2g}" for u in one.rests)
        lines.append(
            f"{one.label}, {verdict} {law.label}: between the gaps {gaps} d_hat, where its contacts rest, its"
            f" rho is {low:.2f} to {high:.2f} times that of minimax."
        )
    return lines


def _agreement(study: Study, found: list[Found]) -> list[str]:
    """Whether searches from two starts found one shape: a computed sentence for each pair of best ones."""
    lines, most = [], study.about["same_within"]
    for one, other in combinations([one for one in found if one.label.endswith(BEST)], 2):
        low, high = apart(one, other)
        word = "are the same shape" if high <= most and low >= 1 / most else "are two shapes"
        works = [f"{geometric(each.rows[TUNE].values['iterations']):.4g}" for each in (one, other)]
        lines.append(
            f"{one.label}, and {other.label}, {word}: where contacts of the first rest, its rho is {low:.2f}"
            f" to {high:.2f} times that of the second. They take {' and '.join(works)} Newton iterations on"
            " `tune`."
        )
    return lines


def _best(shapes: list[Found], half: str) -> str:
    """What has the fewest iterations on a half, among the shapes of the program and among those of searches,
    and the ratio of the two: a computed sentence, or nothing where a half lacks one of them."""
    there = [one for one in shapes if half in one.rows]
    first = sorted(there, key=lambda one: search.work(one.rows[half]))
    mine = [one for one in first if ", " in one.label]
    known = [one for one in first if ", " not in one.label]
    if not mine or not known:
        return ""
    ratio = written(over(mine[0].rows[half], known[0].rows[half], "iterations"))
    return (
        f"On `{half}` {mine[0].label}, takes {ratio} times the Newton iterations of {known[0].label}, which"
        " takes the fewest of the shapes of the program."
    )


def _rest(known: list[Found]) -> str:
    """At which gaps the median of the load rests, step by step, with the log."""
    log = next((one for one in known if one.label == LOG), None)
    gaps = [
        g
        for half in HALVES
        for g in (log.rows[half].values["gap_median"] if log and half in log.rows else [])
    ]
    return ", ".join(significant(gap, 2) for gap in gaps if gap)


def rule(study: Study, rows: list[Row]) -> dict:
    """Sentences and tables of the page, and the curves of its figure."""
    of = {row.key: row for row in rows}
    searches = search.searches_of(study, of)
    known = list(_known(study, of))
    found = [one for each in searches for one in _found(study, each, of)]
    law = next((one for one in known if one.label.startswith(f"{LAW} (")), None)
    about, ends = study.about, all(one.ended for one in searches) and bool(searches)
    generations = [f"{one.name} {one.evolution.generation}" for one in searches]
    return {
        "evaluations": counted(sum(len(one.rows) for one in searches), "shape"),
        "minutes": f"{sum(row.values['processor_s'] for row in rows) / 60:.0f}",
        "states": {half: listed([f"`{name}`" for name in about["states"][half]]) for half in HALVES},
        "work": {half: _work([*known, *found], half) for half in HALVES},
        "rho": _rho([*known, *found]),
        "same": _same(study, found, law, {one.name: one.evolution.spread for one in searches}),
        "agreement": _agreement(study, found),
        "best": [line for half in HALVES if (line := _best([*known, *found], half))],
        "rest": _rest(known),
        "settled": f"{SETTLED:g}",
        "generations": ", ".join(generations)
        + f" of {about['generations']} generations of {about['generation']}",
        "ended": ends,
        "dates": ", ".join(sorted({row.origin["date"] for row in rows})),
        "machine": ", ".join(sorted({row.origin["machine"] for row in rows})),
        "commit": ", ".join(sorted({row.origin["commit"] for row in rows})),
        "theta": f"{about['theta']:g}",
        "within": f"{about['same_within']:g}",
        "parameters": shape.PARAMETERS,
        "knots": f"{shape.LOWEST:g} to {shape.HIGHEST:g}",
        "curves": {"known": known, "found": found},
    }

"""One quantity, several studies: the table of docs/results/several-studies.md. Every study's number of the
log over another shape stands there with its conditions; `apart` finds what studies decide differently.
"""

import re
from collections.abc import Iterable
from dataclasses import replace

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.rules.gap_map.compare import METRICS
from barrierbench_analysis.studies.rules.gap_map.spec import REFERENCE
from barrierbench_analysis.studies.rules.gap_map.table import Map

from .number import OFF, OWN, SAME, Number
from .sources import of_ablation, of_claims, of_map

# limit mode -> targets of the gap map that are shown; its page has all.
OF_MAP = {"off": (0.1, 0.01, 0.001), "on": (0.1, 0.01, 0.001), "contact": (0.1,)}
HEADS = {"cond_p95": "cond, raw", "bj_p95": "cond, block Jacobi", "pcg": "PCG", "newton": "Newton"}


def gather(table: Table, found: Map, ablation: Study) -> list[Number]:
    """Of every shape that two studies or more set beside the log; claims first, then gap map and ablation."""
    claims = [n for n in of_claims(table) if n.case == REFERENCE]
    effects = of_ablation(ablation)
    elsewhere = {n.over for n in (*claims, *effects)}
    of = [
        number
        for shape in found.shapes
        if shape in elsewhere
        for limit, thetas in OF_MAP.items()
        for theta in thetas
        for number in of_map(found, shape, limit, theta)
    ]
    every = [*claims, *of, *effects]
    studies = {shape: {n.study for n in every if n.over == shape} for shape in {n.over for n in every}}
    return [n for n in every if len(studies[n.over]) > 1]


def _side(number: Number) -> int:
    return 0 if not number.decided else 1 if number.value > 1 else -1


def apart(numbers: Iterable[Number]) -> dict[tuple[str, str], set[int]]:
    """(metric, other shape) -> verdicts, of those on which not all numbers agree: 1 the log's is larger, -1
    smaller, 0 not decided."""
    found: dict[tuple[str, str], set[int]] = {}
    for number in numbers:
        found.setdefault((number.metric, number.over), set()).add(_side(number))
    return {key: sides for key, sides in found.items() if len(sides) > 1}


def _cell(numbers: list[Number]) -> str:
    return "; ".join(f"**{n}**" if n.decided else str(n) for n in numbers) or "-"


def _row(numbers: list[Number]) -> list[str]:
    first = numbers[0]
    theta = "stiffness as given" if first.theta is None else f"theta {first.theta:g}"
    conditions = f"{theta}, {first.limit}" + (f"; {first.places}" if first.places else "")
    low, high = first.unknowns
    cells = [_cell([n for n in numbers if n.metric == metric]) for metric in METRICS]
    size = f"{first.scenes}, {low} to {high}"
    return [f"`{first.over}`", f"{first.study}, {first.evidence}", conditions, size, *cells]


def _key(number: Number) -> tuple:
    n = number
    return n.over, n.study, n.confirmed, n.conditions, n.places, n.sweep, n.scenes, n.unknowns


def _shown(numbers: list[Number]) -> list[Number]:
    """Claims that have the same number once, with all their names; no exploratory number of a claim beside a
    confirmed one of the same conditions."""
    once: dict[Number, list[str]] = {}
    for n in numbers:
        once.setdefault(replace(n, study="") if n.sweep else n, []).append(n.study)
    named = [replace(n, study=", ".join(dict.fromkeys(studies))) for n, studies in once.items()]
    best = {(n.quantity, n.conditions) for n in named if n.sweep and n.confirmed}
    return [n for n in named if not n.sweep or n.confirmed or (n.quantity, n.conditions) not in best]


def _order(number: Number) -> tuple:
    """Numbers of one condition stand below each other, the strongest evidence first."""
    limits = (OFF, SAME, OWN)
    return number.over, limits.index(number.limit), -(number.theta or 1), not number.confirmed, number.study


def table_lines(numbers: list[Number]) -> list[str]:
    rows: dict[tuple, list[Number]] = {}
    for number in sorted(_shown(numbers), key=_order):
        rows.setdefault(_key(number), []).append(number)
    heads = ["the log over", "study", "conditions", "scenes, unknowns", *(HEADS[m] for m in METRICS)]
    return markdown(heads, [_row(of) for of in rows.values()])


def shapes_of_table(page: str) -> set[str]:
    """The other shapes that the table of a page has rows of."""
    return set(re.findall(r"^\| `(\w+)` \| [^|]+, (?:confirmed|exploratory) \|", page, re.M))

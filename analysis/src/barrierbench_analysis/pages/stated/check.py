"""Statements that disagree: numbers with the same words under the same heading of one page, quantities for
which readers are made on any page, and these against the kept data.
"""

import re
from collections.abc import Iterable
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError

from .kept import kept
from .number import Number
from .pages import NO_NUMBERS, NUMBER, by_page
from .several import apart, shapes_of_table
from .statement import Statement

SEVERAL = "docs/results/several-studies.md"
# Pages that take numbers from the pages of results/.
PROSE = (
    "README.md",
    "docs/results/which-barrier.md",
    SEVERAL,
    "docs/results/claims.md",
    "docs/results/dominoes.md",
)
PAGES = {"ablation": "results/ABLATION.md", "gap map": "results/GAP_MAP.md"}  # study -> page; claims have one


def contradictions(found: Iterable[Statement]) -> list[str]:
    """One line for every quantity that is stated with two numbers under one condition; verdicts stand beside
    them and are not compared."""
    by: dict[tuple[str, str], dict[tuple[str, str | None], str]] = {}
    for one in found:
        by.setdefault((one.quantity, one.conditions), {}).setdefault((one.number, one.verdict), one.page)
    return [
        f"{quantity}{f' ({conditions})' if conditions else ''}: "
        + "; ".join(
            f"{number}{f', {verdict}' if verdict else ''} in {page}" for (number, verdict), page in of.items()
        )
        for (quantity, conditions), of in by.items()
        if len({number for number, _ in of}) > 1
    ]


def _line(text: str, claim: str) -> str:
    """Of a claim in the tables of results/CLAIMS.md."""
    return next((line for line in text.splitlines() if line.startswith(f"| [{claim}]")), "")


def unreconciled(root: Path, numbers: Iterable[Number]) -> list[str]:
    """One line for every page that decides, or leaves open, what another study decides otherwise, and does
    not lead its reader to the table in which both stand.
    """
    numbers, faults = list(numbers), []
    told = shapes_of_table(input_file.read_text(root / SEVERAL))
    claims = input_file.read_text(root / "results/CLAIMS.md")
    for (metric, shape), _ in apart(numbers).items():
        if shape not in told:
            faults.append(f"{SEVERAL}: no row on {shape}, of which studies decide {metric} differently")
        for study in dict.fromkeys(n.study for n in numbers if (n.metric, n.over) == (metric, shape)):
            page = PAGES.get(study, f"results/CLAIMS.md, {study}")
            text = input_file.read_text(root / PAGES[study]) if study in PAGES else _line(claims, study)
            if SEVERAL not in text:
                faults.append(
                    f"{page}: {metric} of the log over {shape} is decided differently by other studies; a"
                    f" link to {SEVERAL} is needed"
                )
    return list(dict.fromkeys(faults))


def _values(text: str) -> tuple[str, ...]:
    """`1.95 [1.1, 3.47]` as its three numbers."""
    return tuple(re.findall(r"[+-]?[\d.]+(?:e[+-]\d+)?|inf", text))


def _same(stated: tuple[str, ...], known: tuple[float, ...]) -> bool:
    """Whether a page states these numbers, in the digits that it has."""
    return all(float(a) == float(f"{b:.{digits(a)}g}") for a, b in zip(stated, known))


def digits(number: str) -> int:
    """Significant digits, two at least: a page may leave out a last zero."""
    return max(2, len(number.lstrip("+-").partition("e")[0].replace(".", "").lstrip("0")))


def unfounded(root: Path, found: Iterable[Statement], numbers: Iterable[Number]) -> list[str]:
    """One line for every number with an interval in PROSE that no study has: as it stands, or turned."""
    known = [tuple(map(float, _values(one.number))) for one in found if NUMBER.fullmatch(one.number)]
    known += [(n.value, n.lower, n.upper) for n in numbers if n.lower is not None]
    known += [(1 / v, 1 / upper, 1 / lower) for v, lower, upper in known if min(v, lower, upper) > 0]
    lines = []
    for page in PROSE:
        stated = list(dict.fromkeys(NUMBER.findall(" ".join(input_file.read_text(root / page).split()))))
        if not stated:
            raise UserError(f"{page}: no number with an interval is found")
        for text in stated:
            if not any(_same(_values(text), one) for one in known):
                lines.append(f"{page}: {text}: no page of results/ has this number")
    return lines


def silent(found: dict[str, list[Statement]]) -> list[str]:
    """One line for every page in which nothing is read, though it is not known to state no number."""
    return [
        f"{page}: no statement is read, of {len(found)} pages; a reader is needed, or its name in NO_NUMBERS"
        " of analysis/src/barrierbench_analysis/pages/stated/pages.py"
        for page, of in found.items()
        if not of and page not in NO_NUMBERS
    ]


def faults(root: Path, numbers: Iterable[Number]) -> list[str]:
    """All of it. Errors: UserError for a page in which a reader that is made for it finds nothing."""
    found, numbers = by_page(root), list(numbers)
    every = [one for of in found.values() for one in of] + list(kept(root / "results"))
    return (
        silent(found) + contradictions(every) + unreconciled(root, numbers) + unfounded(root, every, numbers)
    )

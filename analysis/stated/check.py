"""Two statements on one thing that disagree, over all pages."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from .number import Number
from .pages import Statement, statements
from .several import apart, shapes_of_table

SEVERAL = "#one-quantity-several-studies"
PAGES = {"ablation": "results/ABLATION.md", "gap map": "results/GAP_MAP.md"}  # study -> page; claims have one


def contradictions(found: Iterable[Statement]) -> list[str]:
    """One line for every quantity that is stated with two numbers, or two verdicts, under one condition."""
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


def _section(text: str, claim: str) -> str:
    """Of a claim in results/CLAIMS.md."""
    _, _, rest = text.partition(f"\n## {claim}:")
    return rest.partition("\n## ")[0]


def unreconciled(root: Path, numbers: Iterable[Number]) -> list[str]:
    """One line for every page that decides, or leaves open, what another study decides otherwise, and does
    not lead its reader to the table in which both stand.
    """
    numbers, faults = list(numbers), []
    told = shapes_of_table((root / "docs/results.md").read_text())
    claims = (root / "results/CLAIMS.md").read_text()
    for (metric, shape), _ in apart(numbers).items():
        if shape not in told:
            faults.append(
                f"docs/results.md{SEVERAL}: no row on {shape}, of which studies decide {metric} differently"
            )
        for study in dict.fromkeys(n.study for n in numbers if (n.metric, n.over) == (metric, shape)):
            page = PAGES.get(study, f"results/CLAIMS.md, {study}")
            text = (root / PAGES[study]).read_text() if study in PAGES else _section(claims, study)
            if SEVERAL not in text:
                faults.append(
                    f"{page}: {metric} of the log over {shape} is decided differently by other studies; a"
                    f" link to docs/results.md{SEVERAL} is needed"
                )
    return list(dict.fromkeys(faults))


def faults(root: Path, numbers: Iterable[Number]) -> list[str]:
    """All of it. Errors: UserError for a page in which nothing is read."""
    return contradictions(statements(root)) + unreconciled(root, numbers)

"""Which series stand in a figure: at most five, the rest in supplements beside it."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import pandas as pd

MOST = 5
FIRST = (
    "log",
    "cubic",
    "cubic_dynamic",
    "cubic_dynamic_consistent",
)  # what the project compares; the others come in the order of the sweep
MORE = "_more"


@dataclass(frozen=True)
class Part:
    """One figure of several: what its name ends with, its series, and what its caption says of the others."""

    suffix: str
    names: tuple[str, ...]
    says: str


def ranked(names: Iterable[str]) -> list[str]:
    """FIRST, then the others as they come."""
    names = list(names)
    return [name for name in FIRST if name in names] + [name for name in names if name not in FIRST]


def parts(names: Iterable[str], by_rank: list[str], figure: str) -> list[Part]:
    """names: as drawn; by_rank: the same, what stands in the main figure first, the reference at the head;
    figure: name of the main one.
    """
    names = list(names)
    if len(names) <= MOST:
        return [Part("", tuple(names), "")]
    rest = [name for name in names if name not in by_rank[:MOST]]
    count = math.ceil(len(rest) / MOST)
    size = math.ceil(len(rest) / count)
    groups = [rest[k * size : (k + 1) * size] for k in range(count)]
    suffixes = [MORE, *(f"{MORE}_{k + 1}" for k in range(1, count))]
    listed = "; ".join(f"{figure}{suffix}: {', '.join(group)}" for suffix, group in zip(suffixes, groups))
    found = [Part("", tuple(name for name in names if name in by_rank[:MOST]), f"Other series: {listed}.")]
    for suffix, group in zip(suffixes, groups):
        beside = [by_rank[0]] if len(group) < MOST else []
        found.append(
            Part(
                suffix,
                (*beside, *group),
                f"The series that {figure} leaves out{f', beside {beside[0]}' if beside else ''}.",
            )
        )
    return found


def is_published(row: pd.Series) -> bool:
    """Whether a run is a published method in one piece (configs/methods); `NAME, changed` is none."""
    method = row.get("method")
    return isinstance(method, str) and method != "" and not method.endswith(", changed")


def _rank(runs: pd.DataFrame, first: Iterable[str]) -> list[str]:
    """Names of series: the reference of the others, `first`, published methods, plain runs of FIRST, the rest
    in their order.
    """
    references, first = set(runs["comparability_reference_run"]), set(first)

    def key(k: int) -> tuple:
        row = runs.iloc[k]
        plain = row["series"] == row["formulation"] and row["series"] in FIRST
        return (
            row["folder"] not in references,
            row["series"] not in first,
            not is_published(row),
            FIRST.index(row["series"]) if plain else len(FIRST),
            k,
        )

    return [runs["series"].iloc[k] for k in sorted(range(len(runs)), key=key)]


def parts_of_runs(
    runs: pd.DataFrame, figure: str, first: Iterable[str] = ()
) -> list[tuple[Part, pd.DataFrame]]:
    """Every figure of a group of runs with its rows, in their order. first: series that have to be in the
    main one.
    """
    found = parts(runs["series"], _rank(runs, first), figure)
    return [(part, runs[runs["series"].isin(part.names)]) for part in found]

"""The text file beside every figure: what is shown, and what the records say of settings, machine and day."""

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass

SETTINGS = "scene matching_rule step_solver integrator linear_solver d_hat_m dt_s steps dt_min_s".split()
PLACE = (
    "machine_cpu_model machine_cores provenance_threads provenance_blas_kernel provenance_git_commit".split()
)


@dataclass(frozen=True)
class Facts:
    """What the caption of every figure of the comparison says beside what is shown. Errors: ValueError where
    one is left empty.
    """

    n: str  # of what the numbers are, and how many
    statistic: str  # what a number is of them
    reference: str  # what they are compared with
    conditions: str  # which scenes, levels and settings they are of

    def __post_init__(self):
        if empty := [name for name, value in self.__dict__.items() if not value.strip()]:
            raise ValueError(f"a caption without {', '.join(empty)}")

    def sentence(self) -> str:
        return " ".join(f"{name.capitalize()}: {value}." for name, value in self.__dict__.items())


def _distinct(rows: Iterable[dict], column: str) -> str:
    """Each value once, in order of appearance."""
    return ", ".join(dict.fromkeys(str(row[column]) for row in rows if row.get(column) not in (None, "")))


def _settings(rows: list[dict], column: str) -> str:
    """As _distinct; where most runs share a value, the others say which series they are of."""
    of: dict[str, list[str]] = {}
    for row in rows:
        value = row.get(column)
        if value not in (None, "") and value == value:  # nan: not in the record
            of.setdefault(f"{value:g}" if isinstance(value, float) else str(value), []).append(
                str(row.get("series", ""))
            )
    most = max(map(len, of.values()), default=0)
    few = 2 * (len(rows) - most) < len(rows)
    return ", ".join(
        f"{value} ({', '.join(names)})" if few and len(names) < most else value for value, names in of.items()
    )


def caption(shown: str, rows: list[dict]) -> str:
    """Wrapped text. `shown`: what the figure shows, in sentences; `rows`: its runs, as in load.run_row()."""
    lines = [shown]
    if not rows:
        return textwrap.fill(shown, 100) + "\n"
    named = {column: _settings(rows, column) for column in SETTINGS}
    words = "; ".join(f"{column} {value}" for column, value in named.items() if value)
    lines.append(f"Settings: {words}.")
    cpu, cores, threads, blas, commit = (_distinct(rows, column) for column in PLACE)
    lines.append(
        f"Machine: {cpu or 'not recorded'}, {cores or '?'} cores, {threads or '?'} threads; "
        f"BLAS: {blas or 'not recorded'}; program: commit {commit[:10] or 'not recorded'}."
    )
    days = sorted({str(row.get("started_utc") or "")[:10] for row in rows} - {""})
    lines.append(
        f"Recorded: {' to '.join(dict.fromkeys((days[0], days[-1]))) if days else 'no date'} (UTC),"
        f" {len(rows)} run{'s' if len(rows) != 1 else ''}."
    )
    return "\n\n".join(textwrap.fill(line, 100) for line in lines) + "\n"

"""The answer of a set of runs: a line for each kind of formulation (how many runs ended ok, smallest gap,
what it takes beside the reference, when it is the one to use), and the log over the cubic in every pair of
runs. The one place of these names, sentences and numbers, for terminal, pages and studies.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from .outcomes import OK, counted_as
from .series import is_published
from .statistics import geometric
from .words import listed, number

LOG, CUBIC = "fixed log", "fixed cubic"
PUBLISHED, POTENTIAL = "dynamic as published", "dynamic from a potential"
FIRST = (LOG, CUBIC, PUBLISHED, POTENTIAL)  # the rows that come first, in this order

NAMES = {  # preset of configs/formulations -> name
    "log": LOG,
    "cubic": CUBIC,
    "quadratic": "fixed quadratic",
    "cubic_dynamic_consistent": POTENTIAL,
    "cubic_dynamic_consistent_scaled": "dynamic from a potential, unit-consistent",
    "cubic_dynamic_lagged": "dynamic once a step",
    "cubic_dynamic": "dynamic to convergence",
    "ipc2020": "adaptive log of IPC",
    "article_cubic": "cubic of the article",
}
METHODS = {"ando2024": PUBLISHED, "ipc2020": "IPC as published"}  # of configs/methods -> name
COMMON_SOLVER = "line_search"  # of all runs that are not named apart

WHEN = {  # name -> one sentence: when it is the one to use
    LOG: "Use it when the largest load is not known: its force has no bound, its gaps may get small.",
    CUBIC: (
        "Use it when the largest load is known: a load above its capacity ends the run, below it gaps stay"
        " large."
    ),
    PUBLISHED: "Use it when nobody can calibrate a stiffness and steps of 1 ms need not converge.",
    POTENTIAL: (
        "Use it when nobody can calibrate a stiffness and every step has to converge; it is a variant of this"
        " project."
    ),
    "fixed quadratic": "Use it like the cubic when contacts may rest farther apart.",
    "dynamic once a step": "Use it when nobody can calibrate a stiffness and loads change little in a step.",
    "dynamic to convergence": "Do not use it: the stiffness cycles, and steps may not converge.",
}


def formulation_name(preset: str, method: str | None = None, step_solver: str | None = None) -> str:
    """Of a preset, or of the label `formulation` of a record; a method in one piece has its own name
    (`NAME, changed` is none). A step solver other than the common one is named behind.
    """
    if is_published({"method": method}):
        return METHODS.get(method, f"{method} as published")
    name = NAMES.get(preset, preset)
    return f"{name} ({step_solver})" if step_solver not in (None, "", COMMON_SOLVER) else name


def name_of(row: Mapping) -> str:
    """Of a row of `runs`. A dynamic stiffness that a matching rule multiplies by s has `x s` behind."""
    name = formulation_name(row["formulation"], row.get("method"), row.get("step_solver"))
    scale = row.get("matching_scale")
    is_scaled = scale is not None and scale == scale and scale != 1
    return f"{name} x s" if is_scaled and not is_published(row) else name


def when_to_use(name: str) -> str:
    """The sentence of a name; empty for one that has none."""
    return WHEN.get(name, "")


# --- numbers of a run, by its row of `runs`


def cond_of(row: Mapping, matrix: str, statistic: str = "median") -> float | None:
    """A condition number of the clamped matrices of a run; matrix: stage/scaling, as in the summary."""
    found = ((row.get("cond") or {}).get(matrix) or {}).get("log10_cond") or {}
    value = found.get(statistic)
    return None if value is None else 10**value


def is_good(row: Mapping) -> bool:
    """Whether the run ended ok and every check of its validity passed."""
    return counted_as(row["outcome"], bool(row["valid"])) == OK


def reference_of(row: Mapping, by_run: Mapping[str, Mapping]) -> Mapping | None:
    """The row of the run that the record names as its reference, where that very run is there. by_run: by
    `run`, the folder of each below the root.
    """
    beside = row.get("comparability_reference_run")
    found = by_run.get(str(Path(row["run"]).parent / beside)) if beside else None
    same = found and found["run_id"] == row.get("comparability_reference_run_id")
    return found if same else None


def compared(rows: Iterable[Mapping]) -> list[tuple[Mapping, Mapping]]:
    """(row, row of its reference) of every run that the program calls comparable with another run; both ended
    ok and are valid.
    """
    by_run = {row["run"]: row for row in rows}
    found = []
    for row in by_run.values():
        reference = reference_of(row, by_run)
        judged = row.get("comparability_verdict") == "comparable" and reference is not row
        if judged and reference is not None and is_good(row) and is_good(reference):
            found.append((row, reference))
    return found


def _by_solver(row: Mapping) -> float | None:
    return row.get("linear_iterations") or None


def _by_probe(row: Mapping) -> float | None:
    newton, probe = row.get("newton_iterations"), row.get("probe_pcg_median")
    return newton * probe if newton and probe else None


# --- the lines


@dataclass(frozen=True)
class Line:
    """One kind of formulation. Of the reference `values` are the smallest and the largest of its runs, of
    others the geometric mean of factors over the reference; keys: COLUMNS.
    """

    name: str
    formulation: str  # of its first run: for the colour
    runs: int
    ok: int  # ended ok and valid
    pairs: int  # runs that are comparable with the reference
    is_reference: bool
    gap: float | None  # the smallest of the runs that are compared, in units of d_hat
    values: dict[str, tuple[float, ...]]

    def cells(self) -> list[str]:
        """Texts below HEAD."""
        beside = "reference" if self.is_reference else str(self.pairs)
        shown = [_shown(self.values.get(key, ()), self.is_reference) for key in COLUMNS]
        gap, when = number(self.gap), when_to_use(self.name)
        return [self.name, f"{self.ok} of {self.runs}", beside, gap, *shown, when]


COLUMNS = {"newton": "Newton", "products": "products", "seconds": "seconds"}
HEAD = ("formulation", "ended ok", "compared", "gap/d_hat", *COLUMNS.values(), "when to use")


@dataclass(frozen=True)
class Answer:
    lines: list[Line]
    reference: str  # name of the line that the factors are over; empty: no two runs are comparable
    left_out: int  # comparable pairs whose reference is of another name
    other_steps: list[str]  # names of lines with other time steps than the reference's in some pair
    is_probed: bool  # products: of the probe on the diagnosed matrices, not of the runs' own solver

    def notes(self) -> list[str]:
        """What the columns mean, in sentences."""
        if not self.reference:
            return ["No two runs here are comparable, so the table has no factors."]
        products = (
            "Newton iterations times the median PCG iterations on the diagnosed matrices (block Jacobi, to"
            " 1e-6)"
            if self.is_probed
            else "iterations of the linear solver of the run"
        )
        found = [
            f"Row {self.reference}: the numbers of its runs, from the smallest to the largest. Other rows: x"
            f" times the {self.reference}'s number, geometric mean over the compared runs, which are those"
            " that their records call comparable with it.",
            "ended ok: and every check of validity passed. gap/d_hat: the smallest gap of the compared runs"
            f" at a converged step end. products: {products}. seconds: of the pass time, one"
            " repetition, beside what else the machine did.",
        ]
        if self.other_steps:
            found.append(f"Other time steps than the reference: {listed(self.other_steps)}.")
        if self.left_out:
            has, are = ("run has", "is") if self.left_out == 1 else ("runs have", "are")
            found.append(
                f"{self.left_out} comparable {has} another reference, or one of the same formulation, and"
                f" {are} in no factor."
            )
        return found


def _shown(values: tuple[float, ...], is_reference: bool) -> str:
    if not values:
        return "-"
    if not is_reference:
        return f"x {number(values[0], 2)}"
    low, high = (number(value) for value in values)
    return low if low == high else f"{low} to {high}"


def _mean(factors: list[float]) -> tuple[float, ...]:
    return (geometric(factors),) if factors else ()


def _line(
    name: str, rows: list[Mapping], pairs: list[tuple], references: list[Mapping], measures: dict
) -> Line:
    """rows: all of this name; pairs: those that are compared; references: rows that others are compared
    with.
    """
    counted = [row for row, _ in pairs] + references
    gaps = [gap for row in counted if (gap := row.get("gap_min_rel_min")) is not None]
    values = {}
    for key, of in measures.items():
        if references:
            found = [value for row in references if (value := of(row)) is not None]
            values[key] = (min(found), max(found)) if found else ()
        else:
            values[key] = _mean([of(row) / of(other) for row, other in pairs if of(row) and of(other)])
    good, first = sum(map(is_good, rows)), rows[0]["formulation"]
    return Line(name, first, len(rows), good, len(pairs), bool(references), min(gaps, default=None), values)


def _ranked(lines: list[Line]) -> list[Line]:
    """FIRST, then those with comparable runs, those with good ones, the rest; else as they come."""

    def rank(line: Line) -> tuple:
        first = FIRST.index(line.name) if line.name in FIRST else len(FIRST)
        return first, not line.pairs and not line.is_reference, not line.ok

    return sorted(lines, key=rank)


def answer(rows: Iterable[Mapping]) -> Answer:
    """Of rows of `runs`, `run` being the folder of each below one root."""
    rows = list(rows)
    every = compared(rows)
    counts = Counter(name_of(other) for _, other in every)
    reference = next(iter(sorted(counts, key=lambda name: -counts[name])), "")
    pairs = [pair for pair in every if name_of(pair[1]) == reference != name_of(pair[0])]
    both = [row for pair in pairs for row in pair]
    is_probed = not (both and all(map(_by_solver, both)))
    measures = {
        "newton": lambda row: row.get("newton_iterations"),
        "products": _by_probe if is_probed else _by_solver,
        "seconds": lambda row: row.get("wall_s"),
    }
    used = {other["run"]: other for _, other in pairs}
    lines = []
    for name in dict.fromkeys(map(name_of, rows)):
        mine = [pair for pair in pairs if name_of(pair[0]) == name]
        references = list(used.values()) if name == reference else []
        lines.append(_line(name, [r for r in rows if name_of(r) == name], mine, references, measures))
    stepped = dict.fromkeys(name_of(one) for one, other in pairs if one.get("dt_s") != other.get("dt_s"))
    return Answer(_ranked(lines), reference, len(every) - len(pairs), list(stepped), is_probed)


# --- the log over the cubic

RATIOS = {
    "cond_raw": ("cond, raw", lambda row: cond_of(row, "full/none")),
    "cond_bj": ("cond, block Jacobi", lambda row: cond_of(row, "full/block_jacobi")),
    "pcg": ("PCG iterations", lambda row: row.get("probe_pcg_median")),
    "newton": ("Newton iterations", lambda row: row.get("newton_iterations")),
}  # key -> title, number of a run


@dataclass(frozen=True)
class Pair:
    """The fixed log over the fixed cubic, where one of the two is the reference of the other."""

    place: str
    theta: float | None
    unknowns: int | None
    is_comparable: bool
    ratios: dict[str, float]  # keys of RATIOS


def _ratios(log: Mapping, cubic: Mapping) -> dict[str, float]:
    found = {key: (of(log), of(cubic)) for key, (_, of) in RATIOS.items()}
    return {key: one / other for key, (one, other) in found.items() if one and other}


def log_over_cubic(rows: Iterable[Mapping]) -> list[Pair]:
    """Every pair of a fixed log and a fixed cubic that both ended ok and are valid; comparable ones first."""
    by_run, found = {row["run"]: row for row in rows}, []
    for row in by_run.values():
        reference = reference_of(row, by_run)
        if reference is None or not is_good(row) or not is_good(reference):
            continue
        named = {name_of(one): one for one in (row, reference)}
        if set(named) != {LOG, CUBIC} or not (ratios := _ratios(named[LOG], named[CUBIC])):
            continue
        place = f"{row['group']}: {(row if row is named[CUBIC] else reference)['series']}"
        theta = None if row.get("matching_rule") == "as_given" else row.get("matching_theta")
        is_comparable = row.get("comparability_verdict") == "comparable"
        found.append(Pair(place, theta, row.get("scene_free_dofs"), is_comparable, ratios))
    return sorted(found, key=lambda pair: not pair.is_comparable)

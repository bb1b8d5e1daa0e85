"""Each formulation beside the reference that its records name, within a sweep: how many runs ended ok, how
many are comparable, and by which factor their numbers differ. Only pairs that the program calls comparable
have a factor.
"""

from collections.abc import Callable
from dataclasses import dataclass

from barrierbench_analysis.tables.statistics import geometric

from .gather import Entry, Folder

RAW, SCALED = "full/none", "full/block_jacobi"


@dataclass(frozen=True)
class Metric:
    """A number of a run that is shown, and compared as a quotient."""

    key: str
    heading: str
    words: str  # in a sentence, behind `the`
    meaning: str
    of: Callable[[Entry], float | None]


def _at(column: str) -> Callable[[Entry], float | None]:
    return lambda entry: entry.row.get(column)


RAW_MEANS = (
    "median over the diagnosed Newton iterations of the condition number of the clamped matrix, as it is"
)
SCALED_MEANS, PCG_MEANS = (
    "the same after block-Jacobi scaling",
    "median of block-Jacobi PCG on the diagnosed matrices, to 1e-6",
)
TIME_MEANS = "seconds of the pass `time`, one repetition a record"
BJ = "median block-Jacobi-scaled condition number"
METRICS = (
    Metric("cond_raw", "cond raw", "median condition number", RAW_MEANS, lambda entry: entry.cond(RAW)),
    Metric("cond_bj", "cond bJ", BJ, SCALED_MEANS, lambda entry: entry.cond(SCALED)),
    Metric("newton", "Newton", "Newton iterations", "over all steps", _at("newton_iterations")),
    Metric("pcg", "PCG", "PCG iterations", PCG_MEANS, _at("probe_pcg_median")),
    Metric("wall", "time s", "time", TIME_MEANS, lambda entry: entry.wall_s),
)


@dataclass(frozen=True)
class Factor:
    """Quotients over the reference's number. n pairs."""

    n: int
    mean: float  # geometric
    low: float
    high: float


@dataclass(frozen=True)
class Beside:
    """A contender beside one reference contender, in one group."""

    group: str
    contender: str
    reference: str  # empty: it is the reference, or has none
    runs: list[Entry]
    factors: dict[str, Factor]  # key of METRICS -> over the comparable pairs that have both numbers

    def count(self, verdict: str) -> int:
        return sum(run.row.get("comparability_verdict") == verdict for run in self.runs)

    @property
    def is_reference(self) -> bool:
        return not self.reference and any(
            run.row.get("comparability_reference_run_id") == run.row["run_id"] for run in self.runs
        )

    @property
    def good(self) -> int:
        return sum(run.good for run in self.runs)


def kind(entry: Entry) -> tuple:
    """What makes two runs of a sweep the same contender at other places of its axes."""
    names = ("formulation", "method", "step_solver", "matching_rule", "precision", "linear_solver")
    return tuple(entry.row.get(name) for name in names)


def contenders(entries: list[Entry]) -> dict[tuple, str]:
    """Names: the formulation, and what tells it from others with the same one."""
    kinds = dict.fromkeys(map(kind, entries))
    names = {}
    for one in kinds:
        same = [other for other in kinds if other[0] == one[0]]
        differ = [k for k in range(1, len(one)) if len({other[k] for other in same}) > 1]
        words = [str(one[k]) for k in differ if one[k]]
        names[one] = f"{one[0]} ({', '.join(words)})" if words else str(one[0])
    return names


def _factor(quotients: list[float]) -> Factor | None:
    if not quotients:
        return None
    mean = geometric(quotients)
    return Factor(len(quotients), mean, min(quotients), max(quotients))


def quotients(folder: Folder, entry: Entry) -> dict[str, float]:
    """Key of METRICS -> number of the run over that of its reference; empty where the two are not comparable,
    or either is not ok and valid, or the reference is not in the folder.
    """
    reference = folder.reference_of(entry)
    judged = entry.row.get("comparability_verdict") == "comparable"
    if reference is None or reference is entry or not judged or not entry.good or not reference.good:
        return {}
    found = {}
    for metric in METRICS:
        value, other = metric.of(entry), metric.of(reference)
        if value and other:
            found[metric.key] = value / other
    return found


def _beside(folder: Folder, group: str, contender: str, reference: str, runs: list[Entry]) -> Beside:
    each = [quotients(folder, run) for run in runs]
    factors = {
        metric.key: found
        for metric in METRICS
        if (found := _factor([one[metric.key] for one in each if metric.key in one]))
    }
    return Beside(group, contender, reference, runs, factors)


def compared(folder: Folder) -> list[Beside]:
    """Every contender of every group, references first, then in the order of the records."""
    out = []
    for group, entries in folder.groups.items():
        names = contenders(entries)
        parts: dict[tuple[str, str], list[Entry]] = {}
        for entry in entries:
            reference = folder.reference_of(entry)
            beside = "" if reference is None or reference is entry else names[kind(reference)]
            parts.setdefault((names[kind(entry)], beside), []).append(entry)
        order = sorted(parts, key=lambda part: part[1] != "")
        out += [_beside(folder, group, *part, parts[part]) for part in order]
    return out

"""Fields that mean something else in a record of an earlier version: named, and their numbers compared with
nothing.
"""

from barrierbench_analysis.io.record_file import other_meanings

from . import shares
from .baseline import PRESENT, Kept
from .finding import Finding, not_judged
from .metrics import Metric
from .records import Run

# Field that has changed its meaning -> families of numbers that are made of it (measure.py, shares.py). Class
# I and II look at one record alone.
FAMILIES: dict[str, tuple[str, ...]] = {
    "summary.contacts": ("contacts_median",),
    "summary.stiffness.kappa_start_N_per_m": ("kappa_start",),
    "summary.stiffness.kappa_end_N_per_m": ("kappa_end",),
    "trace error_estimate_m": ("error_estimate",),
}
OF_NO_NUMBER = frozenset(
    "comparability.verdict, comparability.max_ratio, audit.obstacle_queries, audit.crossings, audit.touches,"
    " summary.end_error_tolerances, steps[].end_error_m, steps[].end_error_tolerances, steps[].contacts,"
    " steps[].kappa_min_N_per_m, steps[].kappa_max_N_per_m, matching.contacts_considered,"
    " matching.contacts_left_out, trace contraction, trace energy_change_J, trace cond[].tier,"
    " trace contacts, trace kappa_min_N_per_m, trace kappa_max_N_per_m,"
    " trace contact_curvature_max_N_per_m".split(", ")
)


def _has(run: Run, field: str) -> bool:
    """Whether the record (`trace ...`: its trace) has the field. A record of another program may lack it."""
    if field.startswith("trace "):
        return bool(run.trace)
    value = run.record
    for name in field.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    return value is not None


def of_other_version(case: str, runs: list[Run], *versions: str) -> list[Finding]:
    """A line when these runs have fields that mean something else in the one version than in the other, by
    default this program's.
    """
    fields = [field for field in other_meanings(*versions) if any(_has(run, field) for run in runs)]
    if not fields:
        return []
    between = " and ".join(versions) if len(versions) > 1 else f"{versions[0]} and now"
    note = f"of {between}, in which {', '.join(fields)} mean different things: not compared"
    return [not_judged(case, "I", "meanings", note)]


def shared(
    case: str, kept: dict[str, Kept], values: dict[Metric, float], old: str, new: str
) -> tuple[dict[str, Kept], dict[Metric, float], list[Finding]]:
    """Both sides without the families that are made of fields with another meaning in the one version than in
    the other, and a line for each of these.
    """
    changed = {family: field for field in other_meanings(old, new) for family in FAMILIES.get(field, ())}

    def unlike(name: str) -> bool:
        return shares.family_of(name) in changed

    names = dict.fromkeys([*kept, *(metric.name for metric in values)])
    there = dict.fromkeys(shares.family_of(name) for name in names if unlike(name))
    note = f"which means different things in {old} and {new}"
    lines = [not_judged(case, "III", family, f"made of {changed[family]}, {note}") for family in there]
    return (
        {name: k for name, k in kept.items() if not unlike(name)},
        {metric: v for metric, v in values.items() if not unlike(metric.name)},
        lines,
    )


def without_version(case: str, version: str | None) -> list[Finding]:
    """A line for a baseline that does not say of which version its records were: it is taken for this
    one's."""
    if version is not None:
        return []
    said = f"the baseline does not say of which record version it is: taken as {PRESENT}"
    return [not_judged(case, "III", "meanings", f"{said} (bench gate calibrate, bench gate accept)")]

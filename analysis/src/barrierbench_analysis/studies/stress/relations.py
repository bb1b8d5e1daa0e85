"""What has to hold between runs of one formulation: equal, differs, ratio, rises, and bounds on single
runs."""

from __future__ import annotations

from dataclasses import dataclass, field

from barrierbench_analysis.io.errors import UserError

from .entry import Test
from .run import METRICS, WAITS, Row

KINDS = {"equal": ("within",), "differs": ("beyond",), "ratio": ("above", "below"), "rises": (), "bound": ()}
COMMON = ("kind", "metric", "groups", "formulations", "reason", "below", "above")


@dataclass
class Relation:
    """One relation of a test over all its formulations."""

    test: str
    says: str
    reason: str
    judged: int = 0  # groups of runs
    not_judged: int = 0  # groups where a run has no such number, or one is zero where quotients are asked
    worst: str = ""  # the number nearest to, or farthest beyond, what is allowed, and whose
    broken: list[str] = field(default_factory=list)

    @property
    def holds(self) -> bool:
        return self.judged > 0 and not self.broken


def check(test: Test, entry: dict, k: int) -> None:
    """Raises UserError for a relation that cannot be judged."""
    place = f"{test.path}: /relations/{k}"
    kind = entry.get("kind")
    if kind not in KINDS:
        raise UserError(f"{place}/kind: {kind!r}; one of {', '.join(KINDS)}")
    if unknown := set(entry) - {*COMMON, *KINDS[kind]}:
        raise UserError(
            f"{place}/{sorted(unknown)[0]}: unknown; allowed: {', '.join((*COMMON, *KINDS[kind]))}"
        )
    if entry.get("metric") not in METRICS:
        raise UserError(f"{place}/metric: {entry.get('metric')!r}; one of {', '.join(METRICS)}")
    if (
        not entry.get("reason")
        or any(key not in entry for key in KINDS[kind])
        or (kind == "bound" and not {"below", "above"} & set(entry))
    ):
        raise UserError(f"{place}: a reason and {', '.join(KINDS[kind]) or 'below or above'} are needed")
    labels = [case.label for case in test.cases]
    for group in entry.get("groups", []):
        if missing := [label for label in group if label not in labels]:
            raise UserError(f"{place}/groups: {missing[0]!r} is no case; cases: {', '.join(labels)}")
        if len(group) < 2 and kind != "bound":
            raise UserError(f"{place}/groups: two cases at least")
    if kind != "bound" and not entry.get("groups"):
        raise UserError(f"{place}/groups: needed")


def _says(entry: dict) -> str:
    metric, kind = entry["metric"], entry["kind"]
    among = "; ".join(", then ".join(group) for group in entry.get("groups", [])) or "every run"
    rule = {
        "equal": lambda: "equal" if entry["within"] == 0 else f"equal within {entry['within']:g}",
        "differs": lambda: f"differs by more than {entry['beyond']:g}",
        "rises": lambda: "rises from each to the next",
        "ratio": lambda: f"first over second between {entry['above']:g} and {entry['below']:g}",
        "bound": lambda: " and ".join(
            f"{word} {entry[word]:g}" for word in ("above", "below") if word in entry
        ),
    }[kind]()
    return f"{metric} of {among}: {rule}"


def _verdict(entry: dict, values: list) -> tuple[bool, float]:
    """Whether it holds, and the number that says so."""
    kind = entry["kind"]
    if isinstance(values[0], str):
        same = len(set(values)) == 1
        return same if kind == "equal" else len(set(values)) == len(values), float(len(set(values)))
    if kind == "bound":
        return entry.get("above", -float("inf")) <= values[0] <= entry.get("below", float("inf")), values[0]
    if kind == "rises":
        steps = [b / a for a, b in zip(values, values[1:])]
        return min(steps) > 1, min(steps)
    if kind == "ratio":
        return entry["above"] <= values[0] / values[1] <= entry["below"], values[0] / values[1]
    spread = (
        0.0
        if min(values) == max(values)
        else max(values) / min(values) - 1
        if min(values) > 0
        else float("inf")
    )
    return (spread <= entry["within"], spread) if kind == "equal" else (spread > entry["beyond"], spread)


def relations(test: Test, rows: list[Row], only: list[str] | None = None) -> list[Relation]:
    """All relations of a test whose cases were run. only: cases that were asked for; a group that was not
    asked for as a whole is left out.
    """
    out = []
    for k, entry in enumerate(test.data.get("relations", [])):
        check(test, entry, k)
        ran = {row.case for row in rows if row.outcome != WAITS}
        groups = entry.get("groups") or [[case.label] for case in test.cases if case.label in ran]
        if only is not None:
            groups = [group for group in groups if set(group) <= set(only)]
        if not groups:
            continue
        found = Relation(test.id, _says(entry), entry["reason"])
        numbers = []
        for label in dict.fromkeys(row.formulation for row in rows):
            if label in test.named(entry.get("formulations", ["@all"]), f"/relations/{k}/formulations"):
                _judge(
                    found,
                    entry,
                    groups,
                    {row.case: row for row in rows if row.formulation == label},
                    label,
                    numbers,
                )
        if numbers:
            low, high = min(numbers), max(numbers)
            found.worst = f"{low[0]:.4g} ({low[1]})" + (
                f" to {high[0]:.4g} ({high[1]})" if high[0] != low[0] else ""
            )
        out.append(found)
    return out


def _judge(
    found: Relation, entry: dict, groups: list, rows: dict[str, Row], label: str, numbers: list
) -> None:
    for group in groups:
        values = [
            (
                getattr(rows[case], entry["metric"])
                if case in rows and rows[case].outcome not in (WAITS, "timeout", "crash")
                else None
            )
            for case in group
        ]
        # An end that did not converge is no state to compare.
        if any(value in (None, "") for value in values) or (
            entry["kind"] != "bound" and any(rows[case].outcome != "ok" for case in group)
        ):
            found.not_judged += 1
            continue
        if entry["kind"] in ("ratio", "rises") and 0 in values:  # what is over zero says nothing
            found.not_judged += 1
            continue
        good, number = _verdict(entry, values)
        found.judged += 1
        numbers.append((number, label))
        if not good:
            found.broken.append(f"{label}, {', then '.join(group)}: {number:.4g}")

"""What has to hold between runs of one formulation: equal, differs, ratio, rises, and bounds on single
runs."""

from dataclasses import dataclass, field

from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.outcomes import OK

from .entry import Test


@dataclass
class Relation:
    """One relation of a test over all its formulations."""

    sentence: str
    reason: str
    judged: int = 0  # groups of runs
    not_judged: int = 0  # groups where a run has no such number, or one is zero where quotients are needed
    numbers: list[tuple[float, str]] = field(default_factory=list)  # what the verdict is of, and whose
    broken: list[str] = field(default_factory=list)

    @property
    def holds(self) -> bool:
        return self.judged > 0 and not self.broken

    @property
    def worst(self) -> str:
        """The smallest and the largest number."""
        if not self.numbers:
            return "-"
        ends = min(self.numbers), max(self.numbers)
        words = [f"{number:.4g} ({label})" for number, label in ends]
        return " to ".join(words if ends[0][0] != ends[1][0] else words[:1])


def _sentence(entry: dict) -> str:
    among = "; ".join(", then ".join(group) for group in entry.get("groups", [])) or "every run"
    bounds = [f"{word} {entry[word]:g}" for word in ("above", "below") if word in entry]
    rule = {
        "equal": lambda: "equal" if entry["within"] == 0 else f"equal within {entry['within']:g}",
        "differs": lambda: f"differs by more than {entry['beyond']:g}",
        "rises": lambda: "rises from each to the next",
        "ratio": lambda: f"first over second between {entry['above']:g} and {entry['below']:g}",
        "bound": lambda: " and ".join(bounds),
    }[entry["kind"]]()
    return f"{entry['metric']} of {among}: {rule}"


def _verdict(entry: dict, values: list) -> tuple[bool, float]:
    """Whether it holds, and the number that decides it."""
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
    low, high = min(values), max(values)
    spread = 0.0 if low == high else high / low - 1 if low > 0 else float("inf")
    return (spread <= entry["within"], spread) if kind == "equal" else (spread > entry["beyond"], spread)


def relations(test: Test, rows: list[Row]) -> list[Relation]:
    """All relations of a test that runs were made for; a group of which a case was not run is left out."""
    out = []
    ran = {row.place["case"] for row in rows}
    for k, entry in enumerate(test.data.get("relations", [])):
        groups = entry.get("groups") or [[case.label] for case in test.cases]
        if not (groups := [group for group in groups if set(group) <= ran]):
            continue
        found = Relation(_sentence(entry), entry["reason"])
        named = test.named(entry.get("formulations", ["@all"]), f"relations/{k}/formulations")
        for label in dict.fromkeys(row.place["formulation"] for row in rows):
            if label in named:
                of = {row.place["case"]: row for row in rows if row.place["formulation"] == label}
                for group in groups:
                    _judge(found, entry, group, [of.get(case) for case in group], label)
        out.append(found)
    return out


def _judge(found: Relation, entry: dict, group: list[str], rows: list[Row | None], label: str) -> None:
    values = [row.values[entry["metric"]] if row else None for row in rows]
    # An end that did not converge is no state to compare, and a quotient by zero is none.
    if (
        None in values
        or (entry["kind"] != "bound" and any(row.outcome != OK for row in rows))
        or (entry["kind"] in ("ratio", "rises") and 0 in values)
    ):
        found.not_judged += 1
        return
    good, number = _verdict(entry, values)
    found.judged += 1
    found.numbers.append((number, label))
    if not good:
        found.broken.append(f"{label}, {', then '.join(group)}: {number:.4g}")

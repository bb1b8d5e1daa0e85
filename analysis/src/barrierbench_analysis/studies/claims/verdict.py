"""What a rule says, and what the parts of a claim say together."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

HOLDS, ONLY_IF, IN_PART, NOT, OPEN = "holds", "holds only if", "holds in part", "does not hold", "not decided"
SCENES, LEVELS = 3, 3  # what a verdict needs; a proof needs neither
STARTS = 5  # what a level needs where a part says that starts matter


@dataclass
class Judged:
    """The answer of one part."""

    verdict: str
    says: str = ""
    condition: str = (
        ""  # of ONLY_IF the levels or scenes, of IN_PART the parts that hold and those that do not
    )
    groups: tuple[int, ...] = ()  # of IN_PART: how many parts hold, do not, and are not decided
    missing: str = ""  # of OPEN
    value: float | None = None
    lower: float | None = None  # 95% interval, over scenes
    upper: float | None = None
    extremes: bool = False  # the smallest and the largest number in the place of an interval
    threshold: str = ""
    bounds: tuple[float, ...] = ()  # thresholds as numbers, for the figure
    measures: str = ""
    counted: str = ""  # how much was judged, and what was left out and why
    per_scene: list[tuple[str, float, float, float, int, int]] = field(
        default_factory=list
    )  # value, least and largest of its levels, levels, runs
    scenes: int = 0  # samples
    starts: str = ""  # how much alike the starts are
    slice: str = ""  # theta and limit of its runs
    rule: str = ""
    runs: list[str] = field(default_factory=list)  # a pair to follow by hand
    beside: bool = False
    proof: bool = False
    sweep: str = ""
    machine: bool = False  # the number depends on it
    ends: str = ""  # cases whose steps are not asked to converge, with their residuals
    smallest_gaps: bool = False  # its runs are compared by the rule of before 3.5.0

    def json(self) -> dict:
        return asdict(self)


def undecided(missing: str, **more) -> Judged:
    return Judged(OPEN, missing=missing, **more)


def _named(j: Judged) -> str:
    text = j.says or j.measures
    return f"{text} ({j.condition})" if j.verdict == ONLY_IF else text


def _in_part(good: list[Judged], bad: list[Judged], still: list[Judged]) -> Judged:
    """Parts are joined by `and`: those that hold are no condition under which the refuted ones would."""
    groups = (
        ("holds", [_named(j) for j in good]),
        ("does not hold", [j.says for j in bad]),
        ("not decided", [j.says for j in still]),
    )
    return Judged(
        IN_PART,
        condition=". ".join(f"{word}: {'; '.join(names)}" for word, names in groups if names),
        groups=tuple(len(names) for _, names in groups),
    )


def together(parts: list[Judged], waits_for: str = "") -> Judged:
    """All parts that are not beside have to hold. What the claim waits for leaves it open, whatever they say.
    Where some hold and some do not it holds in part; where every one holds, but some only at levels or in
    scenes, these are its condition.
    """
    deciding = [j for j in parts if not j.beside]
    if waits_for or not deciding:
        seen = "; ".join(f"{_named(j)}: {j.verdict}" for j in deciding)
        return undecided(f"waits for {waits_for}" + (f". Measured so far: {seen}" if seen else ""))
    verdicts = [j.verdict for j in deciding]
    if all(v == HOLDS for v in verdicts):
        return Judged(HOLDS)
    if all(v == NOT for v in verdicts):
        return Judged(NOT)
    good = [j for j in deciding if j.verdict in (HOLDS, ONLY_IF)]
    bad = [j for j in deciding if j.verdict == NOT]
    still = [j for j in deciding if j.verdict == OPEN]
    if still and not bad:
        missing = "; ".join(f"{j.says}: {j.missing}" for j in still)
        return undecided(
            missing + (f". Otherwise: {'; '.join(f'{_named(j)}: {j.verdict}' for j in good)}" if good else "")
        )
    if not good:
        return Judged(NOT)
    if bad:
        return _in_part(good, bad, still)
    return Judged(ONLY_IF, condition="; ".join(_named(j) for j in good if j.verdict == ONLY_IF))

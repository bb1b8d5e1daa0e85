"""The log beside another shape against the number of unknowns: what a finer mesh leaves of the difference."""

import math
from dataclasses import dataclass

from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import Mean, Ratio, mean_over
from barrierbench_analysis.tables.statistics import slope as line_slope

from .compare import METRICS, Place, over_scenes, runs_of, samples
from .spec import REFERENCE

BORDER = 1000  # unknowns: what is below and what is not is shown side by side
SHAPE, LIMIT = "cubic", "off"


@dataclass(frozen=True)
class Size:
    """One scene and resolution at one target. ratios: metric -> the log's over the shape's; None where a run
    of the two has none, and then `failed` has the outcomes that say why."""

    scene: str
    resolution: str
    theta: float
    unknowns: int
    ratios: dict[str, float] | None
    failed: str

    @property
    def place(self) -> Place:
        return self.scene, self.resolution


def by_size(rows: list[dict]) -> list[Size]:
    """Of every place and target at which both were run, the fewest unknowns first."""
    log, other = (
        {(place, r["theta"]): r for place, runs in runs_of(rows, LIMIT, shape).items() for r in runs}
        for shape in (REFERENCE, SHAPE)
    )
    found = [_size(log[at], r) for at, r in other.items() if at in log]
    return sorted(found, key=lambda size: (size.scene, size.unknowns, -size.theta))


def _size(log: dict, other: dict) -> Size:
    failed = "; ".join(f"{r['shape']}: {r['outcome']}" for r in (log, other) if r["outcome"] != OK)
    whole = not failed and all(log[metric] and other[metric] for metric in METRICS)
    ratios = {metric: log[metric] / other[metric] for metric in METRICS} if whole else None
    return Size(log["scene"], log["resolution"], log["theta"], log["unknowns"], ratios, failed)


@dataclass(frozen=True)
class Halves:
    """metric -> below BORDER and from it on, each over the same scenes; unknowns: smallest and largest of
    both halves."""

    ratios: dict[str, tuple[Ratio, Ratio]]
    scenes: tuple[str, ...]
    unknowns: tuple[tuple[int, int], tuple[int, int]]


def halves(sizes: list[Size], theta: float) -> Halves | None:
    """At one target. None where no scene has numbers on both sides."""
    mine = [size for size in sizes if size.theta == theta and size.ratios]
    sides = [[s for s in mine if (s.unknowns >= BORDER) == large] for large in (False, True)]
    scenes = tuple(dict.fromkeys(s.scene for s in sides[0] if s.scene in {x.scene for x in sides[1]}))
    sides = [[s for s in side if s.scene in scenes] for side in sides]
    if not scenes:
        return None
    ratios = {
        metric: tuple(over_scenes({s.place: math.log(s.ratios[metric]) for s in side}) for side in sides)
        for metric in METRICS
    }
    spans = tuple((min(s.unknowns for s in side), max(s.unknowns for s in side)) for side in sides)
    return Halves(ratios, scenes, spans)


def thetas_of(sizes: list[Size]) -> list[float]:
    """Targets that were run at the most sizes, the largest first: others have no line to speak of."""
    places = {theta: {s.place for s in sizes if s.theta == theta} for theta in {s.theta for s in sizes}}
    most = max(map(len, places.values()), default=0)
    return sorted((theta for theta, of in places.items() if len(of) == most), reverse=True)


def drawn_sizes(rows: list[dict]) -> list[Size]:
    """What the figure has a marker for, and what slopes are of."""
    every = by_size(rows)
    thetas = thetas_of(every)
    return [s for s in every if s.ratios and s.theta in thetas]


@dataclass(frozen=True)
class Slope(Mean):
    """d ln(ratio)/d ln(unknowns): of each scene the least-squares line through its meshes, and the mean over
    scenes, those of a FAMILY averaged first."""

    by_scene: dict[str, float]

    @property
    def word(self) -> str:
        """What the interval decides; empty where 0 lies in it, or there is none."""
        if self.lower is None or self.lower <= 0 <= self.upper:
            return ""
        return "falls" if self.upper < 0 else "grows"


def slope(sizes: list[Size], metric: str) -> Slope | None:
    """Over all that is given, of one target. None where no scene has two sizes."""
    lines: dict[str, list[tuple[float, float]]] = {}
    for s in sizes:
        lines.setdefault(s.scene, []).append((math.log(s.unknowns), math.log(s.ratios[metric])))
    of = {scene: found for scene, line in lines.items() if (found := line_slope(line)) is not None}
    if not of:
        return None
    mean = mean_over(samples(of))
    return Slope(mean.value, mean.lower, mean.upper, mean.scenes, of)


def slopes(rows: list[dict]) -> dict[float, dict[str, Slope]]:
    """Target of the figure -> metric -> slope, where every metric has one; the largest target first."""
    sizes, found = drawn_sizes(rows), {}
    for theta in sorted({s.theta for s in sizes}, reverse=True):
        of = {metric: slope([s for s in sizes if s.theta == theta], metric) for metric in METRICS}
        if all(of.values()):
            found[theta] = of
    return found

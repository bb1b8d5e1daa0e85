"""Tables and a sentence of the log beside the cubic against the number of unknowns."""

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.tables.estimate import CONFIDENCE
from barrierbench_analysis.tables.words import listed

from .compare import METRICS, at_theta, count
from .size import BORDER, SHAPE, Halves, by_size, drawn_sizes, halves, slopes
from .table import Map

NAMES = {"cond_p95": "raw cond", "bj_p95": "block Jacobi", "pcg": "PCG", "newton": "Newton"}
DIFFERENT = (0.01, 0.001)  # targets of the sentence: where the two barriers differ
PAIR_TITLE = f"The log over the {SHAPE}, of the two alone"
SIZE_TITLE = f"The log over the {SHAPE}, by size"
HEADS = [f"{NAMES[metric]}, log over {SHAPE}" for metric in METRICS]


def _both(found: Map) -> dict[float, Halves]:
    sizes = by_size(found.rows)
    return {theta: both for theta in found.gaps if (both := halves(sizes, theta)) is not None}


def _span(both: Halves, side: int) -> str:
    low, high = both.unknowns[side]
    return f"{low} to {high} unknowns"


def _with_size(found: Map) -> str:
    """What falls and what grows, by the intervals of the slopes alone; empty without any."""
    of = slopes(found.rows)
    if not of:
        return ""
    parts = []
    for metric in METRICS:
        words = [
            f"{word} at theta {listed(thetas)}"
            for word in ("falls", "grows")
            if (thetas := [f"{theta:g}" for theta, slope in of.items() if slope[metric].word == word])
        ]
        parts.append(f"{NAMES[metric]} {' and '.join(words) or 'is decided at none'}")
    return (
        f" Against the number of unknowns the slope of this ratio, at theta {listed([f'{t:g}' for t in of])},"
        f" is decided where its 95% interval leaves 0 out: {'; '.join(parts)}; elsewhere it is not decided."
    )


def sentences(found: Map) -> list[str]:
    """What falls with size and what grows; nothing where no scene was run on both sides of the border."""
    shown = {theta: both for theta, both in _both(found).items() if theta in DIFFERENT}
    if not shown:
        return []
    parts = []
    for theta, both in shown.items():
        ends = (f"{NAMES[m]} {small} and {large}" for m, (small, large) in both.ratios.items())
        parts.append(f"at theta {theta:g} ({count(both.scenes)} scenes) {', '.join(ends)}")
    first = next(iter(shown.values()))
    return [
        f"By the size of a system: without a strain limit the log's numbers over the {SHAPE}'s are, with"
        f" {_span(first, 0)} and with {_span(first, 1)} of the same scenes, {'; '.join(parts)}."
        f"{_with_size(found)} No finer mesh was run."
    ]


def pair_table(found: Map) -> list[str]:
    """The two alone, in every place in which both got through, at every target and limit."""
    rows = []
    for limit in found.limits:
        for theta in found.gaps:
            here = at_theta(found.rows, limit, theta, [SHAPE])
            if SHAPE in here.ratios:
                numbers = (str(here.ratios[SHAPE][m].turned()) for m in METRICS)
                rows.append([limit, f"{theta:g}", *numbers, here.cut.words])
    return markdown(["limit", "theta", *HEADS, "of"], rows) if rows else []


def size_table(found: Map) -> list[str]:
    """Two rows a target, of the same scenes below and from BORDER on."""
    rows = [
        [f"{theta:g}", side, _span(of, k), str(count(of.scenes)), *(str(of.ratios[m][k]) for m in METRICS)]
        for theta, of in _both(found).items()
        for k, side in enumerate((f"below {BORDER}", f"{BORDER} and more"))
    ]
    return markdown(["theta", "unknowns", "of", "scenes", *HEADS], rows) if rows else []


def failed(found: Map, thetas: list[float] | None = None) -> str:
    """Places and targets, all or these, at which one of the two did not get through."""
    return ", ".join(
        f"{size.scene} {size.resolution} at theta {size.theta:g} ({size.failed})"
        for size in by_size(found.rows)
        if size.failed and (thetas is None or size.theta in thetas)
    )


def slope_table(found: Map) -> list[str]:
    """A row a target of the figure, of what the figure draws."""
    rows, sizes = [], drawn_sizes(found.rows)
    for theta, of in slopes(found.rows).items():
        scenes = of["newton"].by_scene
        unknowns = [s.unknowns for s in sizes if s.theta == theta and s.scene in scenes]
        span = f"{min(unknowns)} to {max(unknowns)}"
        rows.append([f"{theta:g}", str(count(scenes)), span, *(str(of[metric]) for metric in METRICS)])
    heads = [f"{NAMES[metric]}, slope of log over {SHAPE}" for metric in METRICS]
    return markdown(["theta", "scenes", "unknowns", *heads], rows) if rows else []


def slope_numbers(found: Map) -> dict:
    """How many intervals of slopes there are, how many leave 0 out, and how many would by chance."""
    every = [slope for of in slopes(found.rows).values() for slope in of.values()]
    intervals = sum(slope.lower is not None for slope in every)
    decided = sum(bool(slope.word) for slope in every)
    return {"intervals": intervals, "decided": decided, "by_chance": f"{(1 - CONFIDENCE) * intervals:.1f}"}

"""What the page says of the log beside the cubic against the number of unknowns."""

from __future__ import annotations

from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.tables.estimate import CONFIDENCE

from .compare import METRICS, at_theta, count
from .size import BORDER, LIMIT, SHAPE, Halves, by_size, drawn_sizes, halves, slopes
from .table import Map

NAMES = {"cond_p95": "raw cond", "bj_p95": "block Jacobi", "pcg": "PCG", "newton": "Newton"}
TOLD = (0.01, 0.001)  # targets of the sentence: where the two barriers differ


def _both(found: Map) -> dict[float, Halves]:
    sizes = by_size(found.rows)
    return {theta: both for theta in found.gaps if (both := halves(sizes, theta)) is not None}


def _span(both: Halves, side: int) -> str:
    low, high = both.unknowns[side]
    return f"{low} to {high} unknowns"


def _listed(thetas: list[float]) -> str:
    *first, last = (f"{theta:g}" for theta in thetas)
    return f"{', '.join(first)} and {last}" if first else last


def _with_size(found: Map) -> str:
    """What falls and what grows, by the intervals of the slopes alone; empty without any."""
    of = slopes(found.rows)
    if not of:
        return ""
    parts = []
    for metric in METRICS:
        words = [
            f"{word} at theta {_listed(thetas)}"
            for word in ("falls", "grows")
            if (thetas := [theta for theta, slope in of.items() if slope[metric].word == word])
        ]
        parts.append(f"{NAMES[metric]} {' and '.join(words) or 'is decided at none'}")
    return (
        f" Against the number of unknowns the slope of this ratio, at theta {_listed(list(of))}, is decided"
        f" where its 95% interval leaves 0 out: {'; '.join(parts)}; elsewhere it is not decided."
    )


def sentences(found: Map) -> list[str]:
    """What falls with size and what grows; nothing where no scene was run on both sides of the border."""
    told = [(theta, both) for theta, both in _both(found).items() if theta in TOLD]
    if not told:
        return []
    parts = []
    for theta, both in told:
        ends = (f"{NAMES[m]} {small} and {large}" for m, (small, large) in both.ratios.items())
        parts.append(f"at theta {theta:g} ({count(both.scenes)} scenes) {', '.join(ends)}")
    first = told[0][1]
    return [
        f"By the size of a system: without a strain limit the log's numbers over the {SHAPE}'s are, with"
        f" {_span(first, 0)} and with {_span(first, 1)} of the same scenes, {'; '.join(parts)}."
        f"{_with_size(found)} No finer mesh was run."
    ]


def pair_section(found: Map) -> list[str]:
    """The two alone, in every place in which both got through, at every target and limit."""
    rows = []
    for limit in found.limits:
        for theta in found.gaps:
            here = at_theta(found.rows, limit, theta, [SHAPE])
            if SHAPE in here.ratios:
                numbers = (str(here.ratios[SHAPE][m].turned()) for m in METRICS)
                rows.append([limit, f"{theta:g}", *numbers, here.cut.words])
    if not rows:
        return []
    heads = ["limit", "theta", *(f"{NAMES[m]}, log over {SHAPE}" for m in METRICS), "of"]
    return [
        f"## The log over the {SHAPE}, of the two alone",
        "",
        "Under the same loads, in every place in which both got through, whatever other shapes did there."
        " Rows are of different places: a row compares the two shapes, not one target with another.",
        "",
        *table_lines(heads, rows),
        "",
    ]


def _slopes(found: Map) -> list[str]:
    """A row a target of the figure, of what the figure draws."""
    rows, sizes, every = [], drawn_sizes(found.rows), slopes(found.rows)
    for theta, of in every.items():
        scenes = of["newton"].by_scene
        unknowns = [s.unknowns for s in sizes if s.theta == theta and s.scene in scenes]
        span = f"{min(unknowns)} to {max(unknowns)}"
        rows.append([f"{theta:g}", str(count(scenes)), span, *(str(of[metric]) for metric in METRICS)])
    if not rows:
        return []
    intervals = sum(slope.lower is not None for of in every.values() for slope in of.values())
    decided = sum(bool(slope.word) for of in every.values() for slope in of.values())
    heads = [f"{NAMES[m]}, slope of log over {SHAPE}" for m in METRICS]
    return [
        "Slopes d ln(ratio)/d ln(unknowns) of the markers of the figure: the least-squares line through the"
        " markers of each scene (the figure joins them and draws no such line), and the mean over scenes with"
        " its 95% interval (Student's t; scenes are the samples). Below 0 the ratio falls as the mesh gets"
        f" finer: -1 halves it when unknowns double. Of these {intervals} intervals {decided} leave 0 out; by"
        f" chance alone {(1 - CONFIDENCE) * intervals:.1f} would, and none is corrected for their number.",
        "",
        *table_lines(["theta", "scenes", "unknowns", *heads], rows),
        "",
    ]


def section(found: Map) -> list[str]:
    both = _both(found)
    if not both:
        return []
    rows = [
        [f"{theta:g}", side, _span(of, k), str(count(of.scenes)), *(str(of.ratios[m][k]) for m in METRICS)]
        for theta, of in both.items()
        for k, side in enumerate((f"below {BORDER}", f"{BORDER} and more"))
    ]
    failed = [
        f"{size.scene} {size.resolution} at theta {size.theta:g} ({size.failed})"
        for size in by_size(found.rows)
        if size.failed
    ]
    heads = [f"{NAMES[m]}, log over {SHAPE}" for m in METRICS]
    lines = [
        f"## The log over the {SHAPE}, by size",
        "",
        f"Limit {LIMIT}, the same loads. Both rows of a target are of the same scenes, the second with finer"
        " meshes. Left out, since one of the two did not get through: " + (", ".join(failed) or "none") + ".",
        "",
        "![the log over the cubic against unknowns](../docs/gap_size.png)",
        "",
        *table_lines(["theta", "unknowns", "of", "scenes", *heads], rows),
        "",
        *_slopes(found),
    ]
    return lines

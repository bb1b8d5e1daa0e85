"""The tables of results/PARETO.md."""

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.formulations import REFERENCE
from barrierbench_analysis.tables.numbers import interval, ratio
from barrierbench_analysis.tables.statistics import Ratio

from .fronts import Estimate, Runs, at_gap, failures, over_scenes, over_shared, range_of, unreached


def _cell(e: Estimate | None) -> str:
    if e is None:
        return "-"
    scatter = f" ({ratio(e.low)} to {ratio(e.high)})" if e.n > 1 else ""
    return ratio(e.value) + scatter + (f" ({e.n}/{e.of})" if e.n < e.of else "")


def _cell_over_scenes(e: Ratio | None, of: int) -> str:
    if e is None:
        return "-"
    alone = " (one scene: no interval)" if e.lower is None else ""
    return (
        interval(e.value, e.lower, e.upper, ratio)
        + alone
        + (f" ({e.scenes}/{of})" if 1 < e.scenes < of else "")
    )


def _reached(runs: Runs, scene: str) -> list[str]:
    rows = []
    for name in runs.formulations:
        span = range_of(runs, scene, name)
        failed = "; ".join(
            f"x{scale:g}: {', '.join(f'{n} {word}' for word, n in sorted(words.items()))}"
            for scale, words in failures(runs, scene, name).items()
        )
        rows.append([name, f"{ratio(span[0])} to {ratio(span[1])}" if span else "none", failed or "none"])
    return markdown(
        ["formulation", "gaps reached", "runs that failed or touched nothing, by stiffness"], rows
    )


def _unreached(runs: Runs, scene: str) -> str:
    def words(low: float, high: float) -> str:
        if low == 0:
            return f"below {ratio(high)}"
        return f"above {ratio(low)}" if high == 1 else f"{ratio(low)} to {ratio(high)}"

    if found := unreached(runs, scene):
        return f"No formulation reaches gaps {', '.join(words(*span) for span in found)}."
    return "Every gap up to d_hat is reached by some formulation."


def _heading(gaps: list[float]) -> list[str]:
    return ["number", "formulation", *(f"{gap:g} d_hat" for gap in gaps), "shared gaps"]


def _others(runs: Runs) -> list[str]:
    return [name for name in runs.formulations if name != REFERENCE]


def _of_gaps(runs: Runs, scene: str, formulation: str, name: str, gaps: list[float]) -> list[Estimate | None]:
    """Ratios to the log at these gaps, and over all gaps that both reach."""
    ratios = [at_gap(runs, scene, formulation, name, gap)[1] for gap in gaps]
    return [*ratios, over_shared(runs, scene, formulation, name)]


def _ratios(runs: Runs, scene: str, gaps: list[float]) -> list[str]:
    rows = []
    for name in runs.metrics:
        values = [at_gap(runs, scene, REFERENCE, name, gap)[0] for gap in gaps]
        shown = ["-" if v is None else ratio(v.value) for v in values]
        rows.append([name, f"{REFERENCE}: value", *shown, ""])
        for other in _others(runs):
            found = _of_gaps(runs, scene, other, name, gaps)
            rows.append([name, f"{other} / {REFERENCE}", *map(_cell, found)])
    return markdown(_heading(gaps), rows)


def over_all(runs: Runs, gaps: list[float]) -> list[str]:
    """Ratios over all scenes."""
    rows = []
    for name in runs.metrics:
        for other in _others(runs):
            columns = zip(*(_of_gaps(runs, scene, other, name, gaps) for scene in runs.scenes))
            cells = [_cell_over_scenes(over_scenes(column), len(runs.scenes)) for column in columns]
            rows.append([name, f"{other} / {REFERENCE}", *cells])
    return markdown(_heading(gaps), rows)


def of_scene(runs: Runs, scene: str, gaps: list[float]) -> dict:
    return {
        "reached": "\n".join(_reached(runs, scene)),
        "unreached": _unreached(runs, scene),
        "ratios": "\n".join(_ratios(runs, scene, gaps)),
    }


def meaning(name: str, metric: tuple | None, source: str) -> str:
    """What a number is. metric: of kit/metrics.py; None where the spec names a place in the record."""
    if metric is None:
        return f"`{name}`: {source} of the record"
    words, unit, machine, _ = metric
    return (
        f"`{name}`: {words}{f' ({unit})' if unit != '1' else ''}"
        f"{' (depends on the machine)' if machine else ''}"
    )

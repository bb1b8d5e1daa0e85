"""results/PARETO.md, made of results/pareto.json alone."""

from __future__ import annotations

from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.program.verbs import renewed
from barrierbench_analysis.studies.kit.formulations import REFERENCE
from barrierbench_analysis.studies.kit.metrics import METRICS as MEANINGS
from barrierbench_analysis.tables.numbers import interval, ratio
from barrierbench_analysis.tables.statistics import Ratio

from .fronts import (
    METRICS,
    Estimate,
    Runs,
    at_gap,
    failures,
    over_scenes,
    over_shared,
    range_of,
    unreached,
)

HEAD = """# Formulations at equal reached gap

Made by `{command}` from results/pareto.json. For every formulation the stiffness goes over {decades:g} decades round the value that the matching rule
gives it ({rule}), from {starts} jittered starts. A path of runs is compared with that of `{reference}` where both reach the same gap, by interpolation
between neighbours in stiffness (logarithms of gap and number); nothing is interpolated across a run that failed, and nothing is compared
at equal kappa. A gap is the {gap} over the step ends of a run, in units of d_hat. Cells of a scene: ratio to `{reference}` from the same start,
geometric mean over starts (the least to the largest of them); `(n/{starts})`: only n starts reach the gap with both; `-`: none does. Jittered starts are one
sample, so their scatter is no interval. Cells of all scenes: geometric mean over scenes [95% interval by Student's t, scenes the samples]; `(n/{scenes})`:
only n scenes have the number. Last column: mean over all gaps that both reach. Neither knows the error of the interpolation between stiffnesses: a
ratio that swings from one gap to the next is a shape of the paths, to be read in the figure. Every failed run is listed, here and in the
caption of its figure. At equal load instead of equal gap, and over more scenes, claims, gap map and ablation set shapes side by side:
[One quantity, several studies](../docs/results/several-studies.md).
"""


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
        span, failed = range_of(runs, scene, name), failures(runs, scene, name)
        said = "; ".join(
            f"x{scale:g}: {', '.join(f'{n} {word}' for word, n in sorted(words.items()))}"
            for scale, words in sorted(failed.items())
        )
        reached = f"{ratio(span[0])} to {ratio(span[1])}" if span else "none"
        rows.append([name, reached, said or "none"])
    return table_lines(
        ["formulation", "gaps reached", "runs that failed or touched nothing, by stiffness"], rows
    )


def _nobody(runs: Runs, scene: str) -> str:
    said = [
        (
            f"below {ratio(high)}"
            if low == 0
            else f"above {ratio(low)}"
            if high == 1
            else f"{ratio(low)} to {ratio(high)}"
        )
        for low, high in unreached(runs, scene)
    ]
    return (
        f"No formulation reaches gaps {', '.join(said)}."
        if said
        else "Every gap up to d_hat is reached by some formulation."
    )


def _heading(gaps: list[float]) -> list[str]:
    return ["number", "formulation", *(f"{gap:g} d_hat" for gap in gaps), "shared gaps"]


def _ratios(runs: Runs, scene: str, gaps: list[float]) -> list[str]:
    rows = []
    for name in METRICS:
        values = [at_gap(runs, scene, REFERENCE, name, gap)[0] for gap in gaps]
        shown = ["-" if v is None else ratio(v.value) for v in values]
        rows.append([name, f"{REFERENCE}: value", *shown, ""])
        for formulation in runs.formulations:
            if formulation != REFERENCE:
                found = [at_gap(runs, scene, formulation, name, gap)[1] for gap in gaps]
                found.append(over_shared(runs, scene, formulation, name))
                rows.append([name, f"{formulation} / {REFERENCE}", *map(_cell, found)])
    return table_lines(_heading(gaps), rows)


def _ratios_over_scenes(runs: Runs, gaps: list[float]) -> list[str]:
    rows = []
    for name in METRICS:
        for formulation in runs.formulations:
            if formulation != REFERENCE:
                found = [
                    over_scenes([at_gap(runs, scene, formulation, name, gap)[1] for scene in runs.scenes])
                    for gap in gaps
                ]
                found.append(
                    over_scenes([over_shared(runs, scene, formulation, name) for scene in runs.scenes])
                )
                rows.append(
                    [
                        name,
                        f"{formulation} / {REFERENCE}",
                        *(_cell_over_scenes(e, len(runs.scenes)) for e in found),
                    ]
                )
    return table_lines(_heading(gaps), rows)


def _head(runs: Runs) -> list[str]:
    """How the numbers came about and are read, what was varied, and by what it was run."""
    about = runs.about
    scales = sorted({row["scale"] for row in runs.rows})
    lines = [
        HEAD.format(
            command=renewed(about["command"]),
            decades=about["decades"],
            rule=about["rule"],
            starts=about["starts"],
            scenes=len(runs.scenes),
            reference=REFERENCE,
            gap=about["gap"],
        )
    ]
    return lines + [
        f"{about['doc']}. Varied: {about['vary']}. Stiffness: "
        + ", ".join(f"x{s:g}" for s in scales)
        + f". {len(runs.rows)} runs, {about['unknowns']} unknowns, {about['seconds']:.0f} s of one core in"
        f" all on a machine that did other work as well, {about['date']}, {about['machine']}, build"
        f" {about['build'][:8]}.",
        "",
    ]


def markdown(runs: Runs) -> str:
    lines, gaps = _head(runs), runs.about["gaps"]
    for scene in runs.scenes:
        lines += [
            f"## {scene}",
            "",
            f"![cost against reached gap](../docs/pareto_{scene}.png)",
            "",
            *_reached(runs, scene),
            "",
            _nobody(runs, scene),
            "",
            *_ratios(runs, scene, gaps),
            "",
        ]
    lines += ["## All scenes", "", *_ratios_over_scenes(runs, gaps), "", "## Numbers", ""]
    for name in METRICS:
        meaning, unit, machine, _ = MEANINGS[name]
        lines.append(
            f"- `{name}`:"
            f" {meaning}{f' ({unit})' if unit != '1' else ''}{' (depends on the machine)' if machine else ''}"
        )
    return "\n".join(lines) + "\n"

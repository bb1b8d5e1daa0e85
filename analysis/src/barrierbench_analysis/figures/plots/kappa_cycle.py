"""The step in which a refresh of kappa in every iteration does not settle, beside the runs that get through
it.
"""

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.tables import series
from barrierbench_analysis.tables.records import Records, step_spans

from . import swings

# settled_kappa and unsettled_iterations of core/terms/report.cpp (tests/front/test_program_constants.py).
SETTLED = 0.01  # a change of kappa below it leaves Newton alone
UNSETTLED_ITERATIONS = 10  # that many above it in a row are a cycle
SHOWN = (
    "{group}, the time step of {time} in which the stiffness kappa of the {whose}, computed anew in every"
    " Newton iteration, does not settle: the smallest gap that this kappa is computed from ({left}), and the"
    " largest relative change of a kappa since the iteration before ({right}). All iterations of the step are"
    " drawn."
)
OTHER = "Steps of other lengths, in the middle of that time: {names}."
EDGE = 0.5  # of the width: below it kappa = m/gap^2 amplifies an error of the cubic (docs/theory/barriers.md)


@dataclass(frozen=True)
class Kappa:
    """One of the two stiffnesses that a policy refreshes: where the trace keeps its change and its gap, and
    their names.
    """

    whose: str
    change: str
    gap: str
    gap_label: str


KAPPAS = (
    Kappa("contacts", "kappa_change_rel", "gap_min_iterates_rel", r"smallest gap / $\hat d$"),
    Kappa(
        "strain limit",
        "limit_kappa_change_rel",
        "limit_gap_min_rel",
        "smallest distance to the limit / width",
    ),
)


def _column(trace: pd.DataFrame, key: str) -> pd.Series:
    """Numbers of a column, nan where the record has none or is older than the column."""
    return pd.to_numeric(trace[key]) if key in trace else pd.Series(np.nan, index=trace.index)


def _cycling(trace: pd.DataFrame) -> list[tuple[int, Kappa]]:
    """The last step of a run's trace with every kappa that was still changing at its end."""
    if trace.empty:
        return []
    last = trace[trace["step"] == trace["step"].max()].tail(UNSETTLED_ITERATIONS)
    if len(last) < UNSETTLED_ITERATIONS:
        return []
    step = int(last["step"].iloc[0])
    return [(step, kappa) for kappa in KAPPAS if (_column(last, kappa.change) > SETTLED).all()]


@dataclass(frozen=True)
class Cycle:
    """A kappa that does not settle, and which step of every run is drawn beside it: that of the same
    simulated time.
    """

    kappa: Kappa
    run: str
    steps: dict[str, int]

    def step(self) -> int:
        return self.steps[self.run]


def _same_time(records: Records, run: str, step: int, runs: pd.DataFrame) -> dict[str, int]:
    """Run -> its step in the middle of that step's time; the step of the same number where the record has no
    times.
    """
    spans = step_spans(records, run)
    if step not in spans.index:
        return {other: step for other in runs["run"]}
    middle, found = spans["start"][step] + spans["length"][step] / 2, {}
    for other in runs["run"]:
        of_other = step_spans(records, other)
        over = of_other[(of_other["start"] <= middle) & (middle < of_other["start"] + of_other["length"])]
        if len(over) > 0:
            found[other] = int(over.index[0])
    return found


def _time(records: Records, run: str, step: int) -> str:
    spans = step_spans(records, run)
    if step not in spans.index:
        return f"number {step}"
    return f"{spans['start'][step]:.3g} to {spans['start'][step] + spans['length'][step]:.3g} s"


def _found(
    records: Records, runs: pd.DataFrame, traces: dict[str, pd.DataFrame]
) -> tuple[list[Cycle], list[str]]:
    """The first step of every kappa that does not settle, and the series in which one does not."""
    stopped = [row["run"] for _, row in runs.iterrows() if row["outcome"] != "ok"]
    found = [
        (step, run, kappa) for run in stopped for step, kappa in _cycling(traces.get(run, pd.DataFrame()))
    ]
    cycles = []
    for kappa in KAPPAS:
        of_kappa = [(step, run) for step, run, other in found if other == kappa]
        if of_kappa:
            step, run = min(of_kappa, key=lambda pair: pair[0])
            cycles.append(Cycle(kappa, run, _same_time(records, run, step, runs)))
    cycling = {run for _, run, _ in found}
    return cycles, [row["series"] for _, row in runs.iterrows() if row["run"] in cycling]


def _finish(axes: np.ndarray, kappa: Kappa) -> None:
    """Scales, names, and the two bounds that a gap and a change are read against."""
    for axis in axes:
        if any(len(line.get_ydata()) for line in axis.lines):
            axis.set_yscale("log")
        else:
            style.not_measured(axis, "no kappa that changes")
        axis.set(xscale="log", xlabel="Newton iteration of the step, counted from 1")
        style.keep_span(axis)
    ends = [line.get_ydata()[-1] for line in axes[0].lines if len(line.get_ydata())]
    words, below = r"half of it: below, $\kappa = m/$gap$^2$ amplifies errors", max(ends, default=0) > EDGE
    style.reference_line(axes[0], EDGE, words, below=below)
    style.reference_line(axes[1], SETTLED, "1%: settled below", ":")
    axes[0].set_ylabel(kappa.gap_label)
    axes[1].set_ylabel(rf"relative change of a $\kappa$, {kappa.whose}")


def _draw(
    axes: np.ndarray, cycle: Cycle, runs: pd.DataFrame, traces: dict[str, pd.DataFrame]
) -> tuple[pd.DataFrame, list[tuple[str, swings.Band]]]:
    """One row of panels: the gap that this kappa is computed from, and how much the kappa changes. Returns
    the numbers, and what swings.
    """
    numbers, bands, kappa = [], [], cycle.kappa
    for _, row in runs[runs["run"].isin(cycle.steps)].iterrows():
        part, step = traces[row["run"]], cycle.steps[row["run"]]
        part = part[part["step"] == step]
        gap, change = (_column(part, key).to_numpy(dtype=float) for key in (kappa.gap, kappa.change))
        iteration = part["iteration"].to_numpy()
        moved = change > 0
        for axis, what, at, values in (
            (axes[0], "gap", iteration, gap),
            (axes[1], "change", iteration[moved], change[moved]),
        ):
            drawn = swings.draw(axis, 1 + at, values, row)
            bands += [(f"{what}, {kappa.whose}", band) for band in drawn]
        about = {"series": row["series"], "kappa": kappa.whose, "step": step, "iteration": iteration}
        numbers.append(pd.DataFrame(about | {"gap_min_iterates_rel": gap, "kappa_change_rel": change}))
    _finish(axes, kappa)
    return pd.concat(numbers), bands


def _other_lengths(records: Records, cycle: Cycle, some: pd.DataFrame) -> list[str]:
    """Series whose drawn step is not as long as that of the cycle."""
    spans = step_spans(records, cycle.run)
    if cycle.step() not in spans.index:
        return []
    found = []
    for _, row in some[some["run"].isin(cycle.steps)].iterrows():
        length = step_spans(records, row["run"])["length"][cycle.steps[row["run"]]]
        if abs(length / spans["length"][cycle.step()] - 1) > 0.01:
            found.append(f"{row['series']} {length:.2g} s")
    return found


def _caption(records: Records, group: str, cycles: list[Cycle], some: pd.DataFrame, bands: list) -> str:
    """bands: what swings, by name."""
    words = []
    for left, right, c in zip("ac", "bd", cycles):
        time = _time(records, c.run, c.step())
        words.append(SHOWN.format(group=group, time=time, whose=c.kappa.whose, left=left, right=right))
    others = dict.fromkeys(name for cycle in cycles for name in _other_lengths(records, cycle, some))
    words += [
        swings.sentence(bands, "iteration {:g}"),
        OTHER.format(names=", ".join(others)) if others else "",
    ]
    return " ".join(filter(None, words))


def figure(records: Records, group: str, out: Path) -> list[Path]:
    """One row of panels for each kappa, of the contacts or of the strain limit, that does not settle; nothing
    where both do.
    """
    runs = style.runs_of(records.runs, group)
    trace = records.trace
    traces = {} if trace.empty else {run: trace[trace["run"] == run] for run in runs["run"]}
    cycles, cycling = _found(records, runs, traces)
    paths, name = [], f"kappa_cycle_{group}"
    for part, some in series.parts_of_runs(runs, name, cycling) if cycles else []:
        size = (style.WIDE_IN, 2.6 * len(cycles) + 0.8)
        fig, axes = plt.subplots(len(cycles), 2, figsize=size, layout="constrained", squeeze=False)
        drawn = [_draw(of_kappa, cycle, some, traces) for of_kappa, cycle in zip(axes, cycles)]
        style.letter_panels(axes.flatten())
        whose = " and ".join(cycle.kappa.whose for cycle in cycles)
        fig.suptitle(
            f"{group}: kappa of the {whose}, refreshed in every iteration, does not settle", fontsize=8
        )
        style.legend_below(fig, axes[0, 0], runs)
        text = _caption(records, group, cycles, some, [band for _, bands in drawn for band in bands])
        table = pd.concat([numbers for numbers, _ in drawn]).assign(group=group)
        words = " ".join(filter(None, [text, part.says, style.marker_sentence(runs)]))
        paths += style.save(fig, out / f"{name}{part.suffix}", table, words, some)
    return paths

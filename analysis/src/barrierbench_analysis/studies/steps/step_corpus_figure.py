"""docs/steps.png: iterations of each state by cause, and by Hessian rule."""

from pathlib import Path

from barrierbench_analysis.figures.style import WIDE_IN, plt
from barrierbench_analysis.io.whole_file import write_figure

from .step_corpus_page import OWN, hessians, taken_states, trial_of

COLOURS = {
    "full": "#0072b2",
    "indefinite": "#d55e00",
    "contact": "#009e73",
    "limit": "#e69f00",
    "armijo": "#a03060",
    "noise": "#999999",
    "failed": "#000000",
}
MARKS = "osD^vP<>Xh*"


def _key(axis, handles: list, labels: list[str]) -> None:
    axis.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=3, frameon=False)


def _by_cause(axis, states: list[dict]) -> None:
    for place, state in enumerate(states):
        left = 0
        for cause, count in trial_of(state, OWN)["causes"].items():
            axis.barh(place, count, left=left, color=COLOURS[cause], height=0.7)
            left += count
    used = [c for c in COLOURS if any(trial_of(s, OWN)["causes"][c] for s in states)]
    handles = [plt.Rectangle((0, 0), 1, 1, color=COLOURS[cause]) for cause in used]
    _key(axis, handles, ["Armijo" if cause == "armijo" else cause for cause in used])
    axis.set(xlabel=f"iterations of line_search, {OWN}, by cause")


def _by_rule(axis, states: list[dict], rules: list[str]) -> None:
    """Hollow where the trial did not converge."""
    for k, rule in enumerate(rules):
        colour, label = f"C{k}", rule
        for place, state in enumerate(states):
            trial = trial_of(state, rule)
            if "refused" in trial:
                continue
            face = colour if trial["status"] == "converged" else "none"
            axis.plot(
                trial["iterations"], place, MARKS[k % len(MARKS)], color=colour, mfc=face, ms=4, label=label
            )
            label = None
    axis.set(xscale="log", xlabel="iterations by Hessian rule (hollow: not converged)")
    _key(axis, *axis.get_legend_handles_labels())


def paint(record: dict, path: Path) -> None:
    states = taken_states(record)
    figure, axes = plt.subplots(
        1, 2, figsize=(WIDE_IN, 1.5 + 0.18 * len(states)), layout="constrained", sharey=True, squeeze=False
    )
    _by_cause(axes[0, 0], states)
    _by_rule(axes[0, 1], states, hessians({"states": states}))
    axes[0, 0].set_yticks(range(len(states)), [state["name"] for state in states])
    axes[0, 0].set(ylim=(len(states) - 0.5, -0.5))
    axes[0, 0].set_axisbelow(True)
    write_figure(figure, path, dpi=160)
    plt.close(figure)

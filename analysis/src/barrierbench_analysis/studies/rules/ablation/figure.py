"""The figure of an ablation: main effects on four numbers, and the interactions of every pair of factors."""

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from barrierbench_analysis.figures import style
from barrierbench_analysis.io.whole_file import write_figure, write_whole

from .effects import SHARES, Effect
from .factors import Factorial
from .report import by_construction, name_of

TITLES = {
    "ok": "share ok and valid",
    "newton": "Newton iterations",
    "bj_p95": "cond, block Jacobi",
    "gap": "smallest gap",
}
DECIDED, MADE, OPEN = "#0072B2", "#111111", "#999999"
CAPTION = (
    "Ablation, {runs} runs in {scenes} scenes {where}. Left four panels: effect of each level against the"
    " first of its factor, mean and 95% interval over scenes; filled and blue: decided (sign-flip test over"
    " scenes, p < 0.05 after Holm, and in agreement without any one or two levels of other factors); filled"
    " and black: by construction; hollow: not decided, or taken back. Right: largest mean of an"
    " interaction of two levels of each pair of factors on Newton iterations, as a factor up or down, of"
    " those that at least {least_scenes} scenes have; a dot where one is decided; white where they have none."
    "{left_out_panel}\n"
)
LEFT_OUT = " Here so many scenes have no interaction on Newton iterations, so the right panel is left out."


def _both_ways(limits, least: float) -> tuple[float, float]:
    """As far below nothing as above, and at least so far."""
    far = max(least, *np.abs(limits))
    return -far, far


def _panel(axis, factorial: Factorial, metric: str, effects: list[Effect]) -> None:
    for k, effect in enumerate(effects):
        if effect.mean is None:
            continue
        value = (lambda v: v) if metric in SHARES else math.exp
        made = effect.decided and by_construction(factorial, effect)
        color = MADE if made else DECIDED if effect.decided else OPEN
        if effect.low is not None:
            axis.plot([value(effect.low), value(effect.high)], [k, k], color=color, linewidth=0.9)
        face = color if effect.decided else "white"
        axis.plot(value(effect.mean), k, "o", color=color, markerfacecolor=face)
    if metric in SHARES:
        axis.set_xlim(*_both_ways(axis.get_xlim(), 0.3))
        axis.axvline(0, color="black", linewidth=0.5)
    else:
        axis.set_xscale("log")
        low, high = _both_ways(np.log(axis.get_xlim()), math.log(1.5))
        axis.set_xlim(math.exp(max(low, -4)), math.exp(min(high, 4)))
        axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 2 else (1,)))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.xaxis.set_minor_locator(NullLocator())
        axis.axvline(1, color="black", linewidth=0.5)
    axis.set_title(TITLES[metric])
    axis.set_ylim(len(effects) - 0.5, -0.5)


def _matrix(axis, factorial: Factorial, effects: list[Effect]) -> None:
    n = len(factorial.factors)
    size, decided = np.full((n, n), np.nan), np.zeros((n, n), bool)
    for effect in effects:
        (a, _), (b, _) = effect.term.parts
        if effect.p is not None:
            size[b, a] = np.fmax(size[b, a], abs(effect.mean))
            decided[b, a] |= effect.decided
    top = max([1.2, *np.exp(size[~np.isnan(size)])])
    image = axis.imshow(np.exp(size)[1:, :-1], cmap="cividis", vmin=1, vmax=top, aspect="auto")
    for b, a in zip(*np.nonzero(decided)):
        axis.plot(a, b - 1, "o", color="white", markersize=3)
    names = [factor.name.replace("_", " ") for factor in factorial.factors]
    axis.set_xticks(range(n - 1), names[:-1], rotation=90)
    axis.set_yticks(range(n - 1), names[1:])
    axis.grid(False)
    axis.set_title("interactions, Newton iterations")
    plt.colorbar(image, ax=axis, shrink=0.7, label="factor")


def draw(factorial: Factorial, numbers: dict, path: Path) -> list[Path]:
    """The PNG, and its caption beside it. numbers: of the rule."""
    mains, pairs = numbers["main_effects"], numbers["pair_effects"]["newton"]
    tested = any(effect.p is not None for effect in pairs)
    widths = [1] * len(TITLES) + [1.5] * tested
    size, grid = (0.33 * style.WIDE_IN * sum(widths), 4.2), {"width_ratios": widths}
    fig, axes = plt.subplots(1, len(widths), figsize=size, gridspec_kw=grid, layout="constrained")
    for axis, metric in zip(axes, TITLES):
        _panel(axis, factorial, metric, mains[metric])
    labels = [name_of(factorial, effect.term) for effect in mains["ok"]]
    axes[0].set_yticks(range(len(labels)), labels)
    for axis in axes[1 : len(TITLES)]:
        axis.set_yticks(range(len(labels)), [""] * len(labels))
    if tested:
        _matrix(axes[-1], factorial, pairs)
    write_figure(fig, path, metadata={"Software": None})
    plt.close(fig)
    caption = path.with_suffix(".txt")
    write_whole(caption, CAPTION.format(**numbers, left_out_panel="" if tested else LEFT_OUT))
    return [path, caption]

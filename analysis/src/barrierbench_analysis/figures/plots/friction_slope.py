"""A patch on a slope: acceleration and creep over the coefficient of friction, beside the closed form."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.tables.run import Run

from .drawing import Drawing, SweepRecords, common, each, outcomes
from .resolution import weight

SHOWN = (
    "A patch that is let go on a slope of {angle:.4g} degrees. Left: its mean acceleration over the"
    " second half of the run (from its kinetic energy), since the first friction force is of the gaps at"
    " the start; line: g (sin - mu cos), and 0 from tan on. Right: the speed at the end of those that"
    " should stick, which creep because friction is smoothed below eps_v (grey line). Dotted: tan of the"
    " slope. Crosses at the upper edge: runs that failed. Largest distance from the line on the left:"
    " {worst}."
)


@dataclass(frozen=True)
class Slope:
    """gravity (m/s^2), tan of the slope, eps_v (m/s) of the smoothing."""

    gravity: float
    tan: float
    eps_v: float

    def acceleration(self, mu) -> np.ndarray:
        """Closed form of a rigid block (m/s^2)."""
        cos = 1 / math.hypot(1, self.tan)
        return np.maximum(0.0, self.gravity * cos * (self.tan - np.asarray(mu, float)))


def slope_of(config: dict) -> Slope:
    """Of a scene with one plane. Errors: KeyError, IndexError for another."""
    axis = config["scene"]["obstacles"][0]["axis"]
    gravity = float(np.linalg.norm(config["scene"]["gravity_m_per_s2"]))
    return Slope(gravity, math.hypot(axis[0], axis[1]) / axis[2], config["friction"]["eps_v_m_per_s"])


def table(runs: list[tuple[pd.Series, Run]]) -> pd.DataFrame:
    """A row a run: mu, speed at the end, acceleration (nan where it failed), closed form."""
    rows = []
    for row, run in runs:
        slope, mu = slope_of(run.config), float(run.config["friction"]["mu"])
        speed = acceleration = np.nan
        if row["outcome"] == "ok" and len(run.steps) >= 2:
            middle, last = run.steps.iloc[len(run.steps) // 2 - 1], run.steps.iloc[-1]
            mass = weight(run.config) / slope.gravity
            before, speed = (math.sqrt(2 * step["kinetic_J"] / mass) for step in (middle, last))
            acceleration = (speed - before) / (last["t_s"] - middle["t_s"])
        rows.append(
            {"formulation": row["formulation"], "outcome": row["outcome"], "mu": mu, "tan": slope.tan}
            | {"speed_m_per_s": speed, "acceleration_m_per_s2": acceleration}
            | {"closed_form_m_per_s2": float(slope.acceleration(mu)), "eps_v_m_per_s": slope.eps_v}
        )
    return pd.DataFrame(rows)


def _draw_each(axis, found: pd.DataFrame, column: str, **how) -> None:
    """Hollow markers, larger for each formulation, so that equal numbers are seen round one another."""
    for k, name, mine, look in each(found, "mu"):
        good = mine.dropna(subset=column)
        line = look.line(markersize=2.5 + 2.2 * k, markerfacecolor="none", label=name) | how
        axis.plot(good["mu"], good[column], **line)
        style.failures_above(axis, mine.loc[mine["outcome"] != "ok", "mu"], look.color, k)


def figure(subject: SweepRecords, drawing: Drawing) -> list[Path]:
    runs, pairs = subject.records.runs, subject.each_run()
    found = table(pairs)
    if found["acceleration_m_per_s2"].isna().all():
        raise drawing.nothing(f"no run ended ok ({outcomes(runs)})")
    slope = slope_of(pairs[0][1].config)
    fig, axes = drawing.panels(2, 2.8)
    grey = {"color": "#666666", "linewidth": 0.8, "gid": style.REFERENCE}
    across = np.linspace(found["mu"].min(), found["mu"].max(), 200)
    axes[0].plot(across, slope.acceleration(across), **grey)
    axes[0].axvline(slope.tan, linestyle=":", **grey)
    _draw_each(axes[0], found, "acceleration_m_per_s2", linestyle="none")
    axes[0].set(ylabel="acceleration (m/s$^2$)", title="sliding")
    if (found["mu"] > slope.tan).any():
        axes[1].set_yscale("log")
        sticking = found[(found["mu"] > slope.tan) & ~(found["speed_m_per_s"] <= 0)]
        _draw_each(axes[1], sticking, "speed_m_per_s")
        axes[1].axhline(slope.eps_v, **grey)
    axes[1].set(ylabel="speed at the end (m/s)", title="creep")
    for axis in axes:
        axis.set_xlabel(r"coefficient of friction $\mu$")
    off = (found["acceleration_m_per_s2"] - found["closed_form_m_per_s2"]).abs()
    worst = found.loc[off.idxmax()]
    words = f"{off.max():.2g} m/s^2, {worst['formulation']} at mu {worst['mu']:g}"
    facts = Facts(
        f"{outcomes(runs)}; {found['mu'].nunique()} coefficients",
        "of one run each; acceleration: change of speed over the second half of the run over its time",
        "closed form of a rigid block",
        common(runs, "scene steps dt_s d_hat_m matching_rule matching_theta")
        + f", eps_v {slope.eps_v:g} m/s",
    )
    shown = SHOWN.format(angle=math.degrees(math.atan(slope.tan)), worst=words)
    return drawing.finish(fig, axes, found, shown, facts, runs=runs)

"""The shapes themselves: b, -b', b'' and rho(u), asked from the program, so that no formula is written twice."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from .. import style

# Formulation whose look it takes -> shape, argument.
SHAPES = {
    "log": ("log", "gap"),
    "quadratic": ("quadratic", "gap"),
    "cubic": ("cubic", "gap"),
    "two_stage": ("two_stage", "gap"),
    "log_squared": ("log_squared", "gap"),
    "ipc2020": ("log", "squared_gap"),
}
PANELS = (("b", r"$b/\hat d^2$"), ("minus_db", r"$-b'/\hat d$"), ("d2b", r"$b''$"), ("rho", r"$\rho=\hat d\,b''/|b'|$"))
SHOWN = (
    "The barrier shapes over the gap d in units of d_hat, the gap at which contact begins, for stiffness 1: (a) the energy b, (b) the force -b', (c) the "
    "curvature b'', (d) rho = d_hat b''/|b'|, curvature for the same force. ipc2020 is the log shape applied to the squared gap. "
    "The numbers are the program's own (bench eval)."
)


def program() -> str:
    """The program to ask: BARRIERBENCH_PROGRAM, or the release build."""
    return os.environ.get("BARRIERBENCH_PROGRAM", "build/release/experiments/barrierbench")


def ask(queries: list[dict]) -> list[dict]:
    """Answers of `eval`, in order. Raises RuntimeError with the first error."""
    lines = "".join(json.dumps(q) + "\n" for q in queries)
    done = subprocess.run([program(), "eval", "-"], input=lines, capture_output=True, text=True, check=False)
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    errors = [a["error"] for a in answers if "error" in a]
    if errors or len(answers) != len(queries):
        raise RuntimeError(f"eval: {errors[0] if errors else done.stderr}")
    return answers


def values(u: np.ndarray) -> pd.DataFrame:
    """b, -b', b'' and rho at d = u, d_hat = 1, kappa = 1: one row a shape and u."""
    tables = []
    for name, (shape, argument) in SHAPES.items():
        base = {"shape": shape, "argument": argument}
        terms = ask([{"kind": "shape", **base, "d": float(v), "d_hat": 1.0} for v in u])
        rho = ask([{"kind": "rho", **base, "u": float(v)} for v in u])
        tables.append(
            pd.DataFrame(
                {
                    "formulation": name,
                    **base,
                    "u": u,
                    "b": [t["b"] for t in terms],
                    "minus_db": [-t["db"] for t in terms],
                    "d2b": [t["d2b"] for t in terms],
                    "rho": [r["rho"] for r in rho],
                }
            )
        )
    return pd.concat(tables, ignore_index=True)


def figure(out: Path) -> list[Path]:
    u = np.concatenate([np.geomspace(1e-3, 0.05, 25, endpoint=False), np.linspace(0.05, 0.99, 60)])
    table = values(u)
    fig, axes = plt.subplots(1, 4, figsize=(style.WIDE_IN, 2.3), layout="constrained")
    for name, rows in table.groupby("formulation", sort=False):
        look = style.look(str(name))
        for axis, (field, _) in zip(axes, PANELS):
            axis.plot(
                rows["u"], rows[field], color=look.color, linestyle=look.dash, marker=look.marker,
                markevery=style.marks(len(rows), 6), label=name,
            )
    for axis, (_, title) in zip(axes, PANELS):
        axis.set(xlabel=r"$u=d/\hat d$", title=title, yscale="log")
    axes[3].set_xscale("log")
    style.letter_panels(axes)
    style.legend_below(fig, axes[0])
    return style.save(fig, out / "barrier_shapes", table, SHOWN)

"""The shapes themselves: b, -b', b'' and rho(u), asked from the program, so that no formula is written
twice."""

import os
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.io.record_file import sha256_of
from barrierbench_analysis.program.start import evaluated, shape_names

from .drawing import Drawing

OF_NO_RUN = {
    "log": ("log", "gap"),
    "quadratic": ("quadratic", "gap"),
    "cubic": ("cubic", "gap"),
}  # drawn where there are no runs
PANELS = (
    ("b", r"$b/\hat d^2$"),
    ("minus_db", r"$-b'/\hat d$"),
    ("d2b", r"$b''$"),
    ("rho", r"$\rho=\hat d\,b''/|b'|$"),
)
SHOWN = (
    "The barrier shapes over the gap d in units of d_hat, the gap at which contact begins, for stiffness 1:"
    " (a) the energy b, (b) the force -b', (c) the curvature b'', (d) rho = d_hat b''/|b'|, curvature for the"
    " same force. Drawn are the shapes of the runs, each on the argument that they apply it to. The numbers"
    " are the program's own (bench eval)."
)


def program() -> str:
    """The program to ask: BARRIERBENCH_PROGRAM, or the release build."""
    return os.environ.get("BARRIERBENCH_PROGRAM", "build/release/experiments/barrierbench")


def shapes_of(runs: pd.DataFrame | None) -> dict[str, tuple[str, str]]:
    """Name -> shape, argument, of all runs of contact and limit, in the order of the runs. A shape on the gap
    is called by itself.
    """
    if runs is None or runs.empty:
        return OF_NO_RUN
    pairs = zip(runs["shape"], runs["argument"])
    return {
        shape if argument == "gap" else f"{shape} on {argument}": (shape, argument)
        for shape, argument in pairs
        if isinstance(shape, str)
    }


def plugins_of(runs: pd.DataFrame | None) -> list[str]:
    """Plugin files of the runs that are there still with the content that the records name; others are said
    and left out.
    """
    found: dict[str, str] = {}
    for plugins in runs["plugin_files"] if runs is not None and "plugin_files" in runs else []:
        for file, sha256 in plugins:
            if not Path(file).is_file() or sha256_of(Path(file)) != sha256:
                print(
                    f"figures: {file}: the plugin of a run is not there with the content that its record"
                    " names; its shapes are not drawn",
                    file=sys.stderr,
                )
            elif sha256 not in found:
                found[sha256] = file
    return list(found.values())


def values(u: np.ndarray, shapes: dict[str, tuple[str, str]], plugins: list[str]) -> pd.DataFrame:
    """b, -b', b'' and rho at d = u, d_hat = 1, kappa = 1: one row a shape and u."""
    tables = []
    for name, (shape, argument) in shapes.items():
        base = {"shape": shape, "argument": argument}
        terms = evaluated([{"kind": "shape", **base, "d": float(v), "d_hat": 1.0} for v in u], plugins)
        rho = evaluated([{"kind": "rho", **base, "u": float(v)} for v in u], plugins)
        columns = {
            "b": [t["b"] for t in terms],
            "minus_db": [-t["db"] for t in terms],
            "d2b": [t["d2b"] for t in terms],
            "rho": [r["rho"] for r in rho],
        }
        tables.append(pd.DataFrame({"name": name, **base, "u": u, **columns}))
    return pd.concat(tables, ignore_index=True)


def figure(out: Path, runs: pd.DataFrame | None = None) -> list[Path]:
    """runs: Records.runs, whose shapes are drawn. A shape of a plugin that is gone is left out and said."""
    plugins = plugins_of(runs)
    known, asked = shape_names(plugins), shapes_of(runs)
    shapes = {
        name: pair for name, pair in asked.items() if pair[0] in known or pair[0].startswith("formula:")
    }
    for name in asked.keys() - shapes.keys():
        print(
            f"figures: the shape {name} of a run is not known to {program()} with its plugins; it is not"
            " drawn",
            file=sys.stderr,
        )
    fig, table = draw(shapes, plugins, style.WIDE_IN)
    return style.save(fig, out / "barrier_shapes", table, SHOWN)


def draw(shapes: dict[str, tuple[str, str]], plugins: list[str], width_in: float):
    """The figure, and the numbers that are drawn. Errors: UserError for a shape that is not known."""
    u = np.concatenate([np.geomspace(1e-3, 0.05, 25, endpoint=False), np.linspace(0.05, 0.99, 60)])
    table = values(u, shapes, plugins)
    fig, axes = plt.subplots(1, len(PANELS), figsize=(width_in, 2.3), layout="constrained")
    for name, rows in table.groupby("name", sort=False):
        look = style.look(str(name))
        for axis, (field, _) in zip(axes, PANELS):
            axis.plot(rows["u"], rows[field], **look.line(markevery=style.marks(len(rows), 6), label=name))
    for axis, (_, title) in zip(axes, PANELS):
        axis.set(xlabel=r"$u=d/\hat d$", title=title, yscale="log")
    axes[3].set_xscale("log")
    style.letter_panels(axes)
    style.legend_below(fig, axes[0])
    return fig, table


def of_shapes(names: tuple[str, ...], drawing: Drawing) -> list[Path]:
    """The figure of these shapes on the gap."""
    fig, table = draw({name: (name, "gap") for name in names}, [], drawing.width_in)
    facts = Facts(
        f"{len(names)} shapes at {table['u'].nunique()} gaps",
        "none: closed forms",
        "none; the Newton step of a lone contact is d_hat/rho",
        "stiffness 1, d_hat 1, on the gap",
    )
    return drawing.save(fig, table, SHOWN, facts)

"""Barrier shapes with 20 parameters, and the plugin that the program loads them from.

With u = d/d_hat, b'' is linear between knots, 0 at u = 1 and beyond. Parameter k is the logarithm of how much
b'' grows from the knot above to knot k, so that b'' falls with the gap, and b is convex, falls with the gap
and has two continuous derivatives. b' and b are its integrals. Below the lowest knot the force is A + B/u,
with the force and slope of that knot: it is unbounded, so that every load is carried. The scale of b means
nothing, since every shape gets the stiffness with which it carries the same load.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from barrierbench_analysis.io import input_file
from barrierbench_analysis.program.formula.cache import command, compile_there
from barrierbench_analysis.program.start import evaluated

PARAMETERS = 20
LOWEST, HIGHEST = 0.005, 0.95  # knots: equally far apart in ln(u/(1 - u)), close together at both ends
DIGITS = 6  # behind the point, of a parameter
TEMPLATE = Path(__file__).with_name("plugin.cpp.txt")
COMPILER = "a compiler of C++20"
TABLE = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)  # gaps at which pages write rho


def _between(low: float, high: float, count: int) -> np.ndarray:
    """Gaps that are equally far apart in ln(u/(1 - u))."""
    return 1 / (1 + np.exp(-np.linspace(*(math.log(u / (1 - u)) for u in (low, high)), count)))


KNOTS = _between(LOWEST, HIGHEST, PARAMETERS)
CURVE = sorted({*TABLE, *(float(f"{u:.4g}") for u in _between(0.003, 0.97, 80))})  # of figures


def pieces(parameters: Sequence[float]) -> np.ndarray:
    """[PARAMETERS, 5] for d_hat = 1: of each knot, ascending, with t the way down from the end of its piece:
    that end, and there b, the force -b' and b'', and by how much b'' grows with t.
    """
    ends = np.append(KNOTS[1:], 1.0)
    grown = np.exp(np.asarray(parameters, float))
    found, b, force, curvature = np.empty((PARAMETERS, 5)), 0.0, 0.0, 0.0
    for k in reversed(range(PARAMETERS)):
        width = ends[k] - KNOTS[k]
        slope = grown[k] / width
        found[k] = ends[k], b, force, curvature, slope
        b += width * (force + width * (curvature / 2 + width * slope / 6))
        force += width * (curvature + width * slope / 2)
        curvature += grown[k]
    return found


def relative_stiffness(parameters: Sequence[float], gaps: Sequence[float]) -> list[float]:
    """rho = d_hat b''/|b'| at gaps in d_hat, below d_hat."""
    table = pieces(parameters)
    found = []
    for u in gaps:
        k = max(int(np.searchsorted(KNOTS, u, side="right")) - 1, 0)
        end, _, force, curvature, slope = table[k]
        t = end - max(u, KNOTS[0])
        force, curvature = force + t * (curvature + t * slope / 2), curvature + t * slope
        if u < KNOTS[0]:
            force += curvature * KNOTS[0] * (KNOTS[0] / u - 1)
            curvature *= (KNOTS[0] / u) ** 2
        found.append(float(curvature / force))
    return found


def parameters_of(curvature: Sequence[float]) -> list[float]:
    """Those with which b'' has these values, which fall, at the knots."""
    return [float(x) for x in np.log(np.asarray(curvature, float) - np.append(curvature[1:], 0.0))]


def plugin_source(shapes: Mapping[str, Sequence[float]]) -> str:
    """C++ of a plugin with these shapes: name -> parameters."""
    tables, entries = [], []
    for place, (name, parameters) in enumerate(shapes.items()):
        rows = ", ".join("{" + ", ".join(map(repr, map(float, row))) + "}" for row in pieces(parameters))
        tables.append(f"constexpr Table table_{place} = {{{{{rows}}}}};")
        entries.append(f'SEARCHED("{name}", table_{place})')
    text = input_file.read_text(TEMPLATE)
    known = {
        "@PIECES@": str(PARAMETERS),
        "@KNOTS@": ", ".join(map(repr, map(float, KNOTS))),
        "@TABLES@": "\n".join(tables),
        "@SHAPES@": ",\n".join(entries),
        "@COUNT@": str(len(shapes)),
    }
    for word, value in known.items():
        text = text.replace(word, value)
    return text


def make_plugin(shapes: Mapping[str, Sequence[float]], folder: Path) -> Path:
    """Compiled as formulas are. Errors: FormulaError with what the compiler says."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "shapes.cpp").write_text(plugin_source(shapes))
    compile_there([*command(), "-o", "shapes.so", "shapes.cpp"], folder, COMPILER)
    return folder / "shapes.so"


def terms_of(name: str, gaps: Sequence[float], plugins: Sequence[str] = ()) -> dict[str, list[float]]:
    """Of a shape of the program at gaps, for d_hat = 1: force -b', curvature b'' and their ratio rho."""
    queries = [{"kind": "shape", "shape": name, "d": float(u), "d_hat": 1.0} for u in gaps]
    found = evaluated(queries, list(plugins))
    force, curvature = [-one["db"] for one in found], [one["d2b"] for one in found]
    return {"force": force, "curvature": curvature, "rho": [b / a for a, b in zip(force, curvature)]}

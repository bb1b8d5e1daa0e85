"""Material matching: three tensile tests, one of bending, one of drape, each run by this program and by an
engine. Stretch and bending factors of the engine are fitted; what is left is printed beside every comparison.

The tests are configs on meshes that are written here, so that both sides run what `bench export-scene`
exports. Loads are weights. A strip of length L that hangs under its own weight in its own plane gets longer
by g rho L^2/(2 Y) (Y: Young's modulus times thickness, rho: mass per area), its slowest oscillation has the
period 4 L sqrt(rho/Y); a cantilever of plate rigidity D drops by g rho L^4/(8 D) with the period 2 pi
L^2/(3.516 sqrt(D/rho)). Gravity is chosen for a strain of 2 % and a drop of L/5, and what is measured is the
mean over the second of two periods, which is the static answer with and without damping.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables.statistics import geometric

from .judged import width_of
from .launch import positions
from .ours import Config
from .ours import run as run_ours
from .scene import exported

STRAIN, DROP = 0.02, 0.2
PERIOD_STEPS = 40
TENSILE = ("warp", "weft", "bias")
DRAPE_TRIES = (0.8, 1.0, 1.25)  # times the bending factor that the bending test gave
Simulate = Callable[[dict[str, dict], dict], dict[str, np.ndarray]]  # scenes, settings -> frames of each


@dataclass(frozen=True)
class Material:
    """Of a sheet, SI."""

    youngs: float  # N/m, times thickness
    poisson: float
    density: float  # kg/m^2
    hinge: float  # J


def lattice(length: float, width: float, cell: float, turned: bool) -> tuple[np.ndarray, np.ndarray]:
    """[n, 2] m with x from 0 to length, [m, 3]. turned: the lattice is turned by 45 degrees, and the strip is
    what lies within, with a ragged edge.
    """
    if not turned:
        nx, ny = round(length / cell) + 1, round(width / cell) + 1
        i, j = (k.ravel() for k in np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij"))
        x, at = np.stack([i * cell, j * cell], 1), (i * ny + j).reshape(nx, ny)
    else:
        n = int(np.ceil(2 * (length + width) / cell))
        i, j = (k.ravel() for k in np.meshgrid(np.arange(-n, n), np.arange(-n, n), indexing="ij"))
        x, at = np.stack([i - j, i + j], 1) * cell / 2**0.5, np.arange(len(i)).reshape(2 * n, 2 * n)
    squares = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], -1).reshape(-1, 4)
    triangles = np.concatenate([squares[:, [0, 1, 2]], squares[:, [0, 2, 3]]])
    slack = 1e-9
    inside = (x >= -slack).all(axis=1) & (x[:, 0] <= length + slack) & (x[:, 1] <= width + slack)
    triangles = triangles[inside[triangles].all(axis=1)]
    used = np.unique(triangles)
    number = np.full(len(x), -1)
    number[used] = np.arange(len(used))
    return x[used], number[triangles]


def write_obj(path: Path, x: np.ndarray, triangles: np.ndarray) -> None:
    lines = [f"v {p[0]:.17g} {p[1]:.17g} 0" for p in x]
    lines += [f"f {t[0]} {t[1]} {t[2]}" for t in (triangles + 1).tolist()]
    write_whole(path, "\n".join(lines) + "\n")


def config_of(
    folder: Path, name: str, mesh: tuple, material: Material, pins: list, gravity, dt, steps
) -> Config:
    """Writes mesh and config of a test; contact is far away."""
    write_obj(folder / f"{name}.obj", *mesh)
    body = {
        "name": "sheet",
        "mesh": {"file": f"{name}.obj"},
        "material": {
            "youngs_N_per_m": material.youngs,
            "poisson": material.poisson,
            "density_kg_per_m2": material.density,
            "bending_J": material.hinge,
        },
        "pins": [{"indices": pins}],
    }
    data = {
        "schema": "barrierbench.config/1",
        "name": name,
        "scene": {"name": "bodies", "gravity_m_per_s2": list(gravity), "bodies": [body]},
        "formulation": {"name": "log", "d_hat_m": 1e-4},
        "time": {"dt_s": dt, "steps": steps},
    }
    write_whole(folder / f"{name}.json", json.dumps(data, indent=1) + "\n")
    return Config(folder / f"{name}.json")


def tests_of(material: Material, folder: Path) -> dict[str, Config]:
    """The five tests; without hinges no bending test and no drape."""
    length, width, cell = 0.2, 0.1, 0.025
    g = STRAIN * 2 * material.youngs / (material.density * length)
    dt = 4 * length * (material.density / material.youngs) ** 0.5 / PERIOD_STEPS
    found = {}
    for name in TENSILE:
        x, triangles = lattice(length, width, cell, name == "bias")
        if name == "weft":  # the same lattice, clamped at the side and pulled across
            x = np.stack([x[:, 1], x[:, 0]], 1)
            triangles = triangles[:, ::-1]
            x, length_axis = x, 1
        else:
            length_axis = 0
        held = np.flatnonzero(x[:, length_axis] <= cell / 2 + 1e-9).tolist()
        gravity = np.zeros(3)
        gravity[length_axis] = g
        found[name] = config_of(
            folder, name, (x, triangles), material, held, gravity.tolist(), dt, 2 * PERIOD_STEPS
        )
    if material.hinge <= 0:
        return found
    length, width, cell = 0.06, 0.04, 0.01
    x, triangles = lattice(length + cell, width, cell, False)
    g = DROP * length * 8 * material.hinge / (material.density * length**4)
    period = 2 * np.pi * length**2 / 3.516 * (material.density / material.hinge) ** 0.5
    held = np.flatnonzero(x[:, 0] <= cell + 1e-9).tolist()  # two columns: the slope is held too
    found["bend"] = config_of(
        folder, "bend", (x, triangles), material, held, [0, 0, -g], period / PERIOD_STEPS, 2 * PERIOD_STEPS
    )
    x, triangles = lattice(0.3, 0.3, 0.05, False)
    held = np.flatnonzero((np.abs(x - 0.15) < 0.06).all(axis=1)).tolist()
    found["drape"] = config_of(folder, "drape", (x, triangles), material, held, [0, 0, -9.81], 0.01, 60)
    return found


def measured(name: str, x: np.ndarray) -> float:
    """m, over the second period: how far the far end has gone in the direction of gravity."""
    axis = {"weft": 1, "bend": 2}.get(name, 0)
    along = 1 if name == "weft" else 0
    end = x[0, :, along].max()
    far = x[0, :, along] >= end - 1e-6 - (0.01 if name == "bias" else 0)
    gone = x[PERIOD_STEPS:, far, axis].mean() - x[0, far, axis].mean()
    return float(abs(gone))


def narrowed(x: np.ndarray) -> float:
    """Relative change of the mean width of the middle third in the test `warp`."""
    start = x[0]
    middle = np.abs(start[:, 0] - 0.1) < 0.04
    sides = [middle & (start[:, 1] >= start[:, 1].max() - 1e-9), middle & (start[:, 1] <= 1e-9)]
    width = x[PERIOD_STEPS:, sides[0], 1].mean() - x[PERIOD_STEPS:, sides[1], 1].mean()
    return float(width / 0.1 - 1)


class Tests:
    """The tests of one material: this program's answers, made once, and those of engines beside them."""

    def __init__(self, material: Material, folder: Path):
        self.scenes: dict[str, dict] = {}
        self.ours: dict[str, np.ndarray] = {}
        folder.mkdir(parents=True, exist_ok=True)
        for name, config in tests_of(material, folder).items():
            self.scenes[name] = exported(config.file)
            done = run_ours(config, self.scenes[name], folder / "ours" / name)
            if done["outcome"] != "ok":
                raise UserError(f"test {name}: {done['outcome']}: {done['detail']} (log: {done['log']})")
            self.ours[name] = positions(folder / "ours" / name)

    def ratio(self, name: str, x: np.ndarray) -> float:
        """How far the engine goes over how far ours goes."""
        return measured(name, x) / measured(name, self.ours[name])

    def apart(self, x: np.ndarray) -> float:
        """Between mean shapes of the drape test's second half, root mean square, in widths of a sheet."""
        half = len(x) // 2
        apart = np.linalg.norm(x[half:].mean(axis=0) - self.ours["drape"][half:].mean(axis=0), axis=1)
        return float(np.sqrt((apart**2).mean()) / width_of(self.scenes["drape"]))

    def fit(self, simulate: Simulate, fit: dict) -> dict:
        """Factors of an engine and what is left. What goes is in inverse proportion to a stiffness, so one
        round finds a factor. simulate: raises UserError where the engine fails.
        """
        static = {name: scene for name, scene in self.scenes.items() if name != "drape"}
        bends = "bending" in fit and "bend" in static
        states = simulate(static, {})
        factors = {fit["stretch"]: geometric(self.ratio(n, states[n]) for n in TENSILE)}
        if bends:
            factors[fit["bending"]] = self.ratio("bend", states["bend"])
        best = None
        for times in DRAPE_TRIES if bends and "drape" in self.scenes else (1.0,):
            tried = {**factors, **({fit["bending"]: times * factors[fit["bending"]]} if bends else {})}
            if "drape" not in self.scenes:
                best = (None, tried)
                break
            apart = self.apart(simulate({"drape": self.scenes["drape"]}, tried)["drape"])
            best = (apart, tried) if best is None or apart < best[0] else best
        states = simulate(static, best[1])
        left = {n: self.ratio(n, x) - 1 for n, x in states.items() if n != "bend" or bends}
        left["narrowing"] = narrowed(states["warp"]) - narrowed(self.ours["warp"])
        if best[0] is not None:
            left["drape"] = best[0]
        return {"factors": best[1], "left": left}

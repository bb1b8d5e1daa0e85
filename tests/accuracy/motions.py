"""Two smooth motions that the program runs, and their exact solutions by an integrator of its own (DOP853, relative tolerance 1e-13)."""

import json
import subprocess
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from barrierbench_analysis.tables.accuracy.shapes import barrier
from barrierbench_analysis.tables.accuracy.state import Motion, read_motion

ROOT = Path(__file__).resolve().parents[2]
G = 9.81
SEGMENTS, LENGTH, STIFFNESS, DENSITY = 2, 0.5, 200.0, 0.5  # a chain of two springs, let go from the horizontal
CHAIN_S = 0.2
KAPPA, D_HAT, MASS, START = 400.0, 0.01, 0.3, 0.0075  # a triangle that swings on its barrier round its place of rest
BARRIER_S = 0.05
FIXED = {"passes": {"time": False, "diagnose": False, "audit": True}, "threads": 1}


def chain_config() -> dict:
    body = {"name": "chain", "mesh": {"generator": "rod", "n_segments": SEGMENTS, "length_m": LENGTH}, "pins": [{"indices": [0]}],
            "material": {"springs_N_per_m": STIFFNESS, "line_density_kg_per_m": DENSITY}}
    return {"schema": "barrierbench.config/1", "scene": {"name": "bodies", "gravity_m_per_s2": [0, 0, -G], "bodies": [body]}, "formulation": {"name": "log", "d_hat_m": 0.005}, **FIXED}


def barrier_config() -> dict:
    return {"schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d", "mass_kg": MASS, "start_gap_d_hat": START / D_HAT}, **FIXED,
            "formulation": {"name": "log", "d_hat_m": D_HAT, "stiffness_policy": {"kappa_N_per_m": KAPPA}}}


def run(program: str, config: dict, integrator: str, duration: float, steps: int, folder: Path, tolerance: float = 1e-8, every: int = 1) -> Motion:
    """Run and frames. The folder must not be there."""
    folder.mkdir(parents=True)
    file = folder / "config.json"
    file.write_text(json.dumps({**config, "integrator": {"name": integrator}, "time": {"dt_s": duration / steps, "steps": steps},
                                "step_solver": {"tol_velocity_m_per_s": tolerance}, "output": {"frames_every": every}}))
    done = subprocess.run([program, "run", str(file), "--out", str(folder / "run"), "--progress", "none"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    motion = read_motion(folder / "run")
    assert motion.record["status"]["outcome"] == "ok", motion.record["status"]
    return motion


def _solved(force_over_mass, x0: np.ndarray, v0: np.ndarray, times: np.ndarray) -> np.ndarray:
    n = len(x0)
    found = solve_ivp(lambda t, y: np.concatenate([y[n:], force_over_mass(y[:n])]), (0.0, times[-1]), np.concatenate([x0, v0]), method="DOP853", t_eval=times,
                      rtol=1e-13, atol=1e-15)
    return found.y[:n].T


def chain_exact(times: np.ndarray) -> np.ndarray:
    """[times, nodes, 3] m."""
    rest = LENGTH / SEGMENTS
    start = np.stack([np.linspace(-LENGTH / 2, LENGTH / 2, SEGMENTS + 1), np.zeros(SEGMENTS + 1), np.zeros(SEGMENTS + 1)], axis=1)
    mass = np.full(SEGMENTS + 1, DENSITY * rest)
    mass[[0, -1]] /= 2

    def acceleration(flat: np.ndarray) -> np.ndarray:
        x = flat.reshape(-1, 3)
        legs = np.diff(x, axis=0)
        length = np.linalg.norm(legs, axis=1)[:, None]
        pull = STIFFNESS * (length - rest) * legs / length
        force = np.zeros_like(x)
        force[:-1] += pull
        force[1:] -= pull
        out = force / mass[:, None] - np.array([0.0, 0.0, G])
        out[0] = 0
        return out.ravel()

    return _solved(acceleration, start.ravel(), np.zeros(start.size), times).reshape(len(times), -1, 3)


def barrier_exact(times: np.ndarray) -> np.ndarray:
    """[times] gap in m; three contacts carry the block."""
    return _solved(lambda gap: 3 * KAPPA * -np.array([barrier("log", "gap", gap[0], D_HAT)[1]]) / MASS - G, np.array([START]), np.zeros(1), times)[:, 0]

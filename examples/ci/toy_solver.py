"""Stands for your solver: a chain of masses falls onto a floor, with implicit Euler, Newton's method and a logarithmic contact barrier.

    python3 toy_solver.py --matrices dumps --record dumps/run.json

--matrices writes every Newton matrix as Matrix Market, --record a record of the run with the few fields that a gate reads. Either is enough.
"""

import argparse
import json
from pathlib import Path

import numpy as np

MASSES, SPACING, MASS, STIFFNESS = 30, 0.05, 0.01, 200.0  # 1, m, kg, N/m
GRAVITY, DT, STEPS, D_HAT = -9.81, 0.01, 25, 0.02  # m/s^2, s, 1, m
TOLERANCE = 1e-7  # m


def barrier(gap, kappa):
    """Energy, slope and curvature of -kappa (d - d_hat)^2 ln(d/d_hat) where d < d_hat."""
    near = gap < D_HAT
    d, log = np.where(near, gap, D_HAT), np.log(np.where(near, gap, D_HAT) / D_HAT)
    away = d - D_HAT
    return -kappa * away**2 * log, -kappa * (2 * away * log + away**2 / d), -kappa * (2 * log + 4 * away / d - (away / d) ** 2)


def spring_matrix():
    matrix = np.diag(np.full(MASSES, 2 * STIFFNESS)) - np.diag(np.full(MASSES - 1, STIFFNESS), 1) - np.diag(np.full(MASSES - 1, STIFFNESS), -1)
    matrix[0, 0] = matrix[-1, -1] = STIFFNESS
    return matrix


def energy(x, prediction, rest, springs, kappa):
    away = x - rest
    return MASS / (2 * DT**2) * np.sum((x - prediction) ** 2) + 0.5 * away @ springs @ away + np.sum(barrier(x, kappa)[0])


def step(x, v, rest, springs, kappa, matrices):
    """One time step; returns the new heights. Every Newton matrix is kept."""
    prediction = x + DT * v + DT**2 * GRAVITY
    for _ in range(100):
        _, slope, curvature = barrier(x, kappa)
        gradient = MASS / DT**2 * (x - prediction) + springs @ (x - rest) + slope
        matrix = MASS / DT**2 * np.eye(MASSES) + springs + np.diag(curvature)
        matrices.append(matrix)
        dx = -np.linalg.solve(matrix, gradient)
        if np.abs(dx).max() < TOLERANCE:
            return x
        alpha = min(1.0, 0.8 * np.min(np.where(dx < 0, x / -np.minimum(dx, -1e-300), np.inf)))
        while energy(x + alpha * dx, prediction, rest, springs, kappa) > energy(x, prediction, rest, springs, kappa) and alpha > 1e-10:
            alpha /= 2
        x = x + alpha * dx
    raise RuntimeError("Newton did not converge")


def write_matrix(path, matrix):
    lines = [f"{i + 1} {j + 1} {matrix[i, j]:.17g}" for j in range(MASSES) for i in range(j, MASSES) if matrix[i, j] != 0]
    path.write_text(f"%%MatrixMarket matrix coordinate real symmetric\n{MASSES} {MASSES} {len(lines)}\n" + "\n".join(lines) + "\n")


def record(matrices, gaps, kappa):
    """The fields that a gate reads. Names and units: ./bench help record."""
    cond = np.log10([np.linalg.cond(matrix) for matrix in matrices])
    return {
        "schema": {"name": "barrierbench.run", "version": "3.2.0"},
        "status": {"outcome": "ok", "detail": ""},
        "labels": {"scene": "chain", "formulation": "log"},
        "config": {"masses": MASSES, "dt_s": DT, "steps": STEPS, "d_hat_m": D_HAT, "kappa_N_per_m": kappa},
        "scene": {"free_dofs": MASSES},
        "summary": {
            "newton_iterations": len(matrices),
            "gap_min_rel": {"min": min(gaps), "median": float(np.median(gaps))},
            "cond": {"full/none": {"log10_cond": {"median": float(np.median(cond)), "max": float(cond.max())}, "statuses": {"ok": len(cond)}}},
        },
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--matrices", type=Path)
    parser.add_argument("--record", type=Path)
    parser.add_argument("--kappa", type=float, default=100.0, help="N/m")
    parser.add_argument("--defect", type=float, default=1.0, help="multiplies kappa behind the back of the record")
    args = parser.parse_args()
    rest = SPACING * np.arange(MASSES) + 0.03
    x, v, springs, matrices, gaps = rest, np.zeros(MASSES), spring_matrix(), [], []
    for _ in range(STEPS):
        new = step(x, v, rest, springs, args.defect * args.kappa, matrices)
        x, v = new, (new - x) / DT
        gaps.append(float(x.min() / D_HAT))
    if args.matrices:
        args.matrices.mkdir(parents=True, exist_ok=True)
        for k, matrix in enumerate(matrices[::10]):
            write_matrix(args.matrices / f"newton_{k:03}.mtx", matrix)
    if args.record:
        args.record.parent.mkdir(parents=True, exist_ok=True)
        args.record.write_text(json.dumps(record(matrices, [gap for gap in gaps if gap < 1], args.kappa)))
    print(f"{STEPS} steps, {len(matrices)} Newton iterations, smallest gap {min(gaps):.3f} d_hat")


if __name__ == "__main__":
    main()

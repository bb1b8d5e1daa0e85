"""The example "Cloth draping" of jaxls, solved by jaxls itself from starts that differ a little: how far its
end depends on them. README.md says what has to be installed.
"""

import argparse
import json
from pathlib import Path

import jax
import jax.numpy as jnp
import jaxls
import numpy as np

SIDE, SPACING = 15, 0.10  # points along a side; m
MASS, GRAVITY, DT, STEPS = 0.01, 9.81, 1 / 30, 150  # kg, m/s^2, s
CENTRE, RADIUS, NEAR = np.array([0.7, 0.7, 0.35]), 0.35, 0.01  # m
KEPT, KEPT_NEAR = 0.95, 0.7  # of a velocity, after a step
STATES = (19, 31, 41, STEPS)  # numbers of steps after which heights are kept


class Point(jaxls.Var[jax.Array], default_factory=lambda: jnp.zeros(3)):
    """A point of the net, m."""


@jaxls.Cost.factory
def spring(values, a, b, rest, stiffness):
    way = values[a] - values[b]
    length = jnp.sqrt(way @ way + 1e-6)
    return jnp.sqrt(stiffness) * (1 - rest / length) * way


@jaxls.Cost.factory
def inertia(values, point, predicted):
    return np.sqrt(MASS) / DT * (values[point] - predicted)


@jaxls.Cost.factory(kind="constraint_geq_zero")
def over_table(values, point):
    return values[point][2]


@jaxls.Cost.factory(kind="constraint_geq_zero")
def out_of_ball(values, point):
    arm = values[point] - CENTRE
    return jnp.sqrt(arm @ arm + 1e-8) - RADIUS


def springs() -> list[tuple[np.ndarray, np.ndarray, float, float]]:
    """Ends, length at rest (m) and stiffness (N/m): along rows and columns, across, to every second point."""
    at = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    groups = [
        ([(at[:, :-1], at[:, 1:]), (at[:-1], at[1:])], SPACING, 50.0),
        ([(at[:-1, :-1], at[1:, 1:]), (at[:-1, 1:], at[1:, :-1])], SPACING * 2**0.5, 25.0),
        ([(at[:, :-2], at[:, 2:]), (at[:-2], at[2:])], 2 * SPACING, 10.0),
    ]
    return [
        (*(np.concatenate([pair[end].ravel() for pair in pairs]) for end in (0, 1)), rest, stiffness)
        for pairs, rest, stiffness in groups
    ]


def step(state, _):
    x, v = state
    predicted = x + DT * v + DT**2 / 2 * jnp.array([0.0, 0.0, -GRAVITY])
    points = Point(id=jnp.arange(SIDE * SIDE))
    costs = [inertia(points, predicted), over_table(points), out_of_ball(points)]
    costs += [spring(Point(id=jnp.array(a)), Point(id=jnp.array(b)), l0, k) for a, b, l0, k in springs()]
    rules = jaxls.AugmentedLagrangianConfig(
        inner_solve_tolerance=1e-3, tolerance_absolute=1e-6, tolerance_relative=1e-5
    )
    end = (
        jaxls.LeastSquaresProblem(costs, [points])
        .analyze()
        .solve(
            jaxls.VarValues.make([points.with_value(x)]),
            linear_solver="conjugate_gradient",
            verbose=False,
            augmented_lagrangian=rules,
        )[points]
    )
    near = (end[:, 2] < NEAR) | (jnp.linalg.norm(end - CENTRE, axis=1) < RADIUS + NEAR)
    return (end, (end - x) / DT * jnp.where(near, KEPT_NEAR, KEPT)[:, None]), end


@jax.jit
def run(x):
    return jax.lax.scan(step, (x, jnp.zeros_like(x)), None, length=STEPS)[1]


def start(seed: int, jitter: float) -> np.ndarray:
    """[n, 3] m: above the ball and beside it, moved by up to `jitter` (m) but for seed 0."""
    rows, columns = np.divmod(np.arange(SIDE * SIDE), SIDE)
    x = np.stack([SPACING * columns, SPACING * rows, np.full(SIDE * SIDE, 2.2)], axis=1) + [0.15, 0.05, 0.0]
    return x if seed == 0 else x + np.random.default_rng(seed).uniform(-jitter, jitter, x.shape)


def numbers(states: np.ndarray) -> dict:
    """Of the states [steps, n, 3] at the ends of steps, m."""
    out = {}
    for count in STATES:
        x = states[count - 1].astype(float)
        out[str(count)] = {
            "mean_m": x.mean(axis=0).round(6).tolist(),
            "lowest_m": round(x[:, 2].min(), 6),
            "highest_m": round(x[:, 2].max(), 6),
        }
    gaps = np.linalg.norm(states - CENTRE, axis=2) - RADIUS
    return {"after_steps": out, "deepest_m": float(-min(0.0, gaps.min(), states[:, :, 2].min()))}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, help="JSON file")
    parser.add_argument("--starts", type=int, default=11, help="the first is the example's own (default: 11)")
    parser.add_argument("--jitter-m", type=float, default=1e-4)
    parser.add_argument("--states", type=Path, help="NumPy file of all states at the ends of steps")
    parser.add_argument("--commit", required=True, help="of jaxls")
    given = parser.parse_args()
    runs, states = [], []
    for seed in range(given.starts):
        states.append(np.asarray(run(jnp.array(start(seed, given.jitter_m)))))
        runs.append({"seed": seed, **numbers(states[-1])})
        print(seed, runs[-1]["after_steps"][str(STEPS)], flush=True)
    if given.states:
        np.save(given.states, np.array(states))
    about = {"program": "jaxls", "commit": given.commit, "jax": jax.__version__, "jitter_m": given.jitter_m}
    given.out.write_text(json.dumps({**about, "runs": runs}, indent=1) + "\n")


if __name__ == "__main__":
    main()

"""A Python class as a stiffness policy: the run of the built-in one, what it sees, what it raises."""

import numpy as np
import pytest


class Inertia:
    name, needs_hessian = "python_inertia", True

    def kappa(self, rows):
        return rows.m / (rows.c * rows.h**2) + rows.k


def with_policy(config, **policy):
    return {**config, "formulation": {"name": "mine", "shape": "cubic", "argument": "gap", "stiffness_policy": policy}}


@pytest.mark.parametrize("refresh", ["per_iteration", "per_step"])
def test_a_run_is_that_of_the_built_in_one(bb, drape, refresh):
    bb.register_policy(Inertia())
    drape["integrator"] = {"name": "bdf2"}  # c = 4/9
    built = bb.Simulation(with_policy(drape, name="elasticity_inclusive", mass_term="inertia", refresh=refresh)).run()
    mine = bb.Simulation(with_policy(drape, name="python_inertia", refresh=refresh)).run()
    assert np.allclose(mine.positions, built.positions, rtol=0, atol=1e-9)
    record, wanted = mine.record(), built.record()
    assert record["steps"][-1]["contacts"]["total"] == wanted["steps"][-1]["contacts"]["total"] > 0
    assert record["labels"]["stiffness_policy"] == "python_inertia"
    (plugin,) = record["provenance"]["plugins"]
    assert plugin["name"] == "python_inertia" and plugin["file"].endswith("test_python_policy.py")


def test_it_sees_the_contacts(bb, drape):
    seen = []

    class Watching:
        name = "watching"

        def kappa(self, rows):
            seen.append((rows.n_free.copy(), rows.w_sq.copy(), rows.d / rows.d_hat, rows.m.copy(), rows.hessian, rows.h))
            return 1000.0

    bb.register_policy(Watching())
    seen.clear()
    fixed = bb.Simulation(drape).run()
    watched = bb.Simulation(with_policy(drape, name="watching")).run()
    assert watched.state_hash == fixed.state_hash and seen
    n_free, w_sq, u, m, hessian, h = (np.concatenate(x) if isinstance(x[0], np.ndarray) else x for x in zip(*seen))
    assert ((n_free >= 1) & (n_free <= 4)).all() and ((u > 0) & (u <= 1)).all()
    assert (w_sq > 0).all() and (m > 0).all() and np.isfinite(m).all() and set(hessian) == {None} and set(h) == {0.01}


def test_scale_and_name_again(bb, drape):
    class Number:
        name = "number"

        def __init__(self, value):
            self.value = value

        def kappa(self, rows):
            return np.full(rows.d.shape, self.value)

    bb.register_policy(Number(500.0))
    half = bb.Simulation(with_policy(drape, name="number", scale=2)).run()
    bb.register_policy(Number(1000.0))
    whole = bb.Simulation(with_policy(drape, name="number")).run()
    assert half.state_hash == whole.state_hash == bb.Simulation(drape).run().state_hash


def test_what_it_raises_ends_the_step_and_nothing_is_lost(bb, drape):
    class Faulty:
        name, broken = "faulty_policy", False

        def kappa(self, rows):
            if self.broken:
                raise ZeroDivisionError("in my policy")
            return 1000.0

    faulty = Faulty()
    bb.register_policy(faulty)
    sim = bb.Simulation(with_policy(drape, name="faulty_policy"))
    while not sim.record()["steps"] or sim.record()["steps"][-1]["contacts"]["total"] == 0:
        sim.step()
    before = sim.state_hash
    faulty.broken = True
    with pytest.raises(ZeroDivisionError, match="in my policy"):
        sim.step()
    assert sim.state_hash == before
    faulty.broken = False
    assert sim.run().state_hash == bb.Simulation(drape).run().state_hash


@pytest.mark.parametrize(
    "fault, reported",
    [
        ({"kappa": lambda self, rows: -rows.m}, r"kappa = -1.0 N/m at d = 0.004 m"),
        ({"kappa": lambda self, rows: rows.m * np.inf}, r"kappa = inf"),
        ({"kappa": lambda self, rows: [1.0, 2.0]}, r"kappa of shape \(2,\)"),
        ({"kappa": lambda self, rows: rows.k, "needs_hessian": False}, r"k without needs_hessian"),
        ({"kappa": 3}, r"an object with kappa"),
        ({"needs_hessian": 1}, r"True or False"),
        ({"name": "My Policy"}, r"snake_case"),
    ],
)
def test_a_declaration_that_does_not_hold_is_refused(bb, fault, reported):
    with pytest.raises(bb.ConfigError, match=reported):
        bb.register_policy(type("Bad", (Inertia,), {"name": "bad_policy", **fault})())
    with pytest.raises(bb.ConfigError, match="bad_policy"):
        bb.resolve({"scene": "hang", "formulation": {"shape": "cubic", "stiffness_policy": {"name": "bad_policy"}}})


def test_a_name_of_the_program_is_taken(bb):
    with pytest.raises(bb.ConfigError, match="not yet taken"):
        bb.register_policy(type("Mine", (Inertia,), {"name": "dart"})())

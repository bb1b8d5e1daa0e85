"""A Python class as a shape: the bits of the built-in one, what its declaration is held to, what it raises."""

import hashlib
from pathlib import Path

import numpy as np
import pytest


class Cubic:
    """The built-in cubic in numpy, its operations in the same order."""

    name, smoothness_at_d_hat, infinite_at_zero = "python_cubic", 2, False

    def terms(self, d, d_hat):
        s = d_hat - d
        return 2 / (3 * d_hat) * s**3, -2 / d_hat * s**2, 4 / d_hat * s


class Log:
    """In three functions."""

    name, smoothness_at_d_hat, infinite_at_zero = "python_log", 1, True

    def value(self, d, h):
        return -((d - h) ** 2) * np.log(d / h)

    def d1(self, d, h):
        return -2 * (d - h) * np.log(d / h) - (d - h) ** 2 / d

    def d2(self, d, h):
        return -2 * np.log(d / h) - 4 * (d - h) / d + (d - h) ** 2 / d**2


@pytest.mark.parametrize("own, name", [(Cubic, "cubic"), (Log, "log")])
def test_it_is_the_built_in_one(bb, own, name):
    shape, d = bb.register_shape(own()), np.linspace(1e-5, 0.012, 40)
    for a, b in zip(shape(d, 0.01), bb.Shape(name)(d, 0.01)):
        assert np.allclose(a, b, rtol=1e-9, atol=1e-15 * np.abs(b).max()) and np.abs(b).max() > 0
    assert shape(0.0, 0.01).b == pytest.approx(bb.Shape(name)(0.0, 0.01).b, rel=1e-14)


def test_it_runs_in_steps(bb, drape):
    bb.register_shape(Cubic())
    wanted = bb.Simulation(drape).run()
    drape["formulation"] |= {"name": "mine", "shape": "python_cubic", "argument": "gap"}
    sim = bb.Simulation(drape).run()
    assert sim.outcome == "ok" and np.allclose(sim.positions, wanted.positions, atol=1e-8)
    record = sim.record()
    assert record["steps"][-1]["contacts"]["total"] > 0 and record["labels"]["shape"] == "python_cubic"
    (plugin,) = record["provenance"]["plugins"]
    assert plugin["name"] == "python_cubic" and plugin["file"].endswith("test_python_shape.py")
    assert plugin["sha256"] == hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


def test_what_it_raises_ends_the_step_and_nothing_is_lost(bb, drape):
    class Faulty(Cubic):
        name, broken = "faulty", False

        def terms(self, d, d_hat):
            if self.broken:
                raise ZeroDivisionError("in my formula")
            return super().terms(d, d_hat)

    faulty = Faulty()
    bb.register_shape(faulty)
    drape["formulation"] |= {"name": "mine", "shape": "faulty", "argument": "gap"}
    drape["threads"] = 2
    whole = bb.Simulation(drape).run()
    sim = bb.Simulation(drape)
    for _ in range(5):
        sim.step()
    before, record = sim.state_hash, sim.record()["steps"]
    faulty.broken = True
    with pytest.raises(ZeroDivisionError, match="in my formula"):
        sim.step()
    assert sim.state_hash == before and sim.record()["steps"] == record
    faulty.broken = False
    assert sim.run().state_hash == whole.state_hash


@pytest.mark.parametrize(
    "fault, reported",
    [
        ({"terms": lambda self, d, h: ((h - d) ** 3, -3 * (h - d) ** 2, 6 * (h - d))}, r"b at d = 0.05 d_hat changes by 8"),
        ({"terms": lambda self, d, h: (s := h - d) is None or (s**2, -s, s * 0 + 2)}, r"b' = .* at d = 0.05 d_hat"),
        ({"terms": lambda self, d, h: (s := h - d) is None or (s**3 / h, -3 * s**2 / h, 3 * s / h)}, r"b'' = .*; allowed: the derivative"),
        ({"terms": lambda self, d, h: (-((h - d) ** 2), 2 * (h - d), 0 * d - 2)}, r"b' = .* > 0"),
        ({"terms": lambda self, d, h: ((h - d) ** 2, -2 * (h - d), 0 * d + 2)}, r"b'' = 2 just below d_hat"),
        ({"terms": lambda self, d, h: (d / 0, d, d)}, r"b = inf at d"),
        ({"terms": lambda self, d, h: d}, r"ndarray; allowed: a tuple"),
        ({"name": "My Shape"}, r"snake_case"),
        ({"smoothness_at_d_hat": "two"}, r"an integer"),
    ],
)
def test_a_declaration_that_does_not_hold_is_refused(bb, fault, reported):
    shape = type("Bad", (Cubic,), {"name": "bad", **fault})()
    with np.errstate(all="ignore"), pytest.raises(bb.ConfigError, match=reported):
        bb.register_shape(shape)
    assert "bad" not in bb.shapes()


def test_a_name_of_the_program_is_taken(bb):
    with pytest.raises(bb.ConfigError, match="not yet taken"):
        bb.register_shape(type("Mine", (Cubic,), {"name": "cubic"})())

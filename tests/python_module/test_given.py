"""Numbers, arrays, configs and paths that Python hands to the program: what is real is taken, what is not is refused with its place."""

import json

import numpy as np
import pytest

SHAPE = [0.001, 0.002]
CONFIG = {"scene": {"name": "hang"}}


def refused(bb, call):
    with pytest.raises(bb.ConfigError) as error:
        call()
    return str(error.value)


NO_NUMBERS = [(np.array([1e-3 + 1j]), "complex numbers"), ([1e-3 + 1j], "complex numbers"), (None, "None"), ([1e-3, None], "None"), ("text", "type"),
              (["a"], "type"), ([[1.0], [1.0, 2.0]], "lists of different lengths"), (np.array([True]), "type bool"), (object(), "type object")]


@pytest.mark.parametrize("value, found", NO_NUMBERS, ids=lambda x: str(x)[:20])
def test_every_function_of_arrays_refuses_what_is_no_real_number(bb, value, found):
    from barrierbench.geometry import distance_hessian

    points = [[0.0, 0, 0], [1, 0, 0]]
    cubic = bb.Shape("cubic")
    calls = {
        "d": lambda: cubic(value, 0.01),
        "d_hat": lambda: cubic(SHAPE, value),
        "points": lambda: bb.point_point(value, points[1]),
        "points ": lambda: bb.distance("point_point", value),
        "points  ": lambda: distance_hessian("point_point", value),
        "points_t0": lambda: bb.accd("point_point", value, [points]),
        "points_t1": lambda: bb.accd("point_point", [points], value),
        "matrix": lambda: bb.condition_number(value),
        "offset": lambda: bb.accd("point_point", points, points, offset=value),
        "park": lambda: bb.accd("point_point", points, points, park=value),
        "u": lambda: cubic.rho(value),
        "kappa": lambda: cubic.equilibrium(value, 0.01, 1.0),
        "load": lambda: cubic.equal_force(0.01, value),
        "curvature": lambda: cubic.equal_curvature(0.01, value),
        "theta": lambda: cubic.equal_force(0.01, 1.0, value),
    }
    for where, call in calls.items():
        text = refused(bb, call)
        assert text.startswith(f"{where.strip()}: found ") and found in text and "allowed: " in text, (where, text)


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan])
def test_every_function_refuses_what_is_not_finite(bb, value):
    cubic, points = bb.Shape("cubic"), np.zeros((2, 3))
    bad = points.copy()
    bad[1, 2] = value
    matrix = np.diag([1.0, 2.0, value])
    for where, call in {
        "d_hat[1]": lambda: cubic(SHAPE, [0.01, value]),
        "points[1][2]": lambda: bb.distance("point_point", bad),
        "points_t1[1][2]": lambda: bb.accd("point_point", points, bad),
        "offset": lambda: bb.accd("point_point", points, points, offset=value),
        "park": lambda: bb.accd("point_point", points, points, park=value),
        "matrix.data": lambda: bb.condition_number(matrix),
        "u": lambda: cubic.rho(value),
        "kappa": lambda: cubic.equilibrium(value, 0.01, 1.0),
        "d_hat": lambda: cubic.equal_force(value, 1.0),
        "theta": lambda: cubic.equal_curvature(0.01, 1.0, value),
    }.items():
        text = refused(bb, call)
        assert text.startswith(where) and "a finite number" in text, (where, text)
    assert bb.Shape("log")([np.inf], 0.01).b.tolist() == [0.0]  # a gap may be: nothing is there


def test_arrays_and_scalars_of_numpy_are_configs(bb):
    plain = {
        "scene": {
            "name": "bodies",
            "bodies": [{"name": "sheet", "mesh": {"generator": "grid", "n_x": 2}, "transform": {"translate_m": [0, 0, 0.5]}, "pins": [{"indices": [0, 1]}]}],
            "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}],
        },
        "formulation": {"d_hat_m": 0.01},
        "time": {"dt_s": 0.01, "steps": 3},
    }
    of_numpy = json.loads(json.dumps(plain))
    of_numpy["scene"]["bodies"][0]["mesh"]["n_x"] = np.int32(2)
    of_numpy["scene"]["bodies"][0]["transform"]["translate_m"] = np.array([0, 0, 0.5])
    of_numpy["scene"]["bodies"][0]["pins"][0]["indices"] = np.array([0, 1])
    of_numpy["scene"]["obstacles"] = tuple(of_numpy["scene"]["obstacles"])
    of_numpy["formulation"]["d_hat_m"] = np.float64(0.01)
    of_numpy["time"]["steps"] = np.uint8(3)
    assert bb.resolve(of_numpy) == bb.resolve(plain)
    assert bb.resolve(plain, {"/time/steps": np.int64(5), "/scene/bodies/0/pins/0/indices": np.arange(3)}) == bb.resolve(plain, {"/time/steps": 5, "/scene/bodies/0/pins/0/indices": [0, 1, 2]})
    assert bb.Shape("cubic").equal_force(np.float64(0.01), np.array(1.0), np.float32(0.5)) == pytest.approx(200)


def test_arrays_are_queries(bb):
    points = np.array([[0.5, 1, 0], [0, 0, 0], [1, 0, 0]])
    query = {"kind": "distance", "pair": "point_edge", "points": points.tolist()}
    schema = json.loads(bb._core.eval_schema())
    assert "distance" in json.dumps(schema)
    assert bb.evaluate({**query, "points": points}) == bb.evaluate(query)
    assert bb.evaluate({"kind": "rho", "shape": "cubic", "u": np.float64(0.5)}) == bb.evaluate({"kind": "rho", "shape": "cubic", "u": 0.5})


@pytest.mark.parametrize("value, found", [
    (float("nan"), "nan"), (np.inf, "inf"), (np.float32("nan"), "nan"), (1j, "1j of type complex"), (np.array([1j]), "1j of type complex"), (b"x", "b'x' of type bytes"),
    ({1, 2}, "{1, 2} of type set"), (object, "<class 'object'> of type type")])
def test_what_no_json_can_hold_is_refused_with_its_place(bb, value, found):
    for call, where in ((lambda: bb.resolve({**CONFIG, "time": {"dt_s": value}}), "config#/time/dt_s"), (lambda: bb.resolve(CONFIG, {"/time/dt_s": value}), "/time/dt_s#"),
                        (lambda: bb.evaluate({"kind": "rho", "u": value}), "query#/u")):
        text = refused(bb, call)
        assert text.startswith(where) and f"found {found}" in text, text
    assert "the key 1" in refused(bb, lambda: bb.resolve({**CONFIG, 1: 2}))


def test_an_empty_folder_is_none(bb, drape, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for call in (lambda: bb.Simulation(drape, out=""), lambda: bb.run(drape, out="")):
        assert "out: found an empty path" in refused(bb, call)
    assert not list(tmp_path.iterdir())


def make(**fields):
    class Given:
        name, smoothness_at_d_hat, infinite_at_zero = "given_of_test", 2, False

        def terms(self, d, d_hat):
            s = d_hat - d
            return s**3 / d_hat, -3 * s**2 / d_hat, 6 * s / d_hat

    for name, value in fields.items():
        setattr(Given, name, value)
    return Given()


def logarithm(self, d, d_hat):
    s, e = np.log(d / d_hat), d - d_hat
    return -(e**2) * s, -2 * e * s - e**2 / d, -2 * s - 4 * e / d + e**2 / d**2


def test_what_a_shape_does_at_zero_is_what_it_declares(bb):
    assert "infinite_at_zero True of a b that grows by" in refused(bb, lambda: bb.register_shape(make(infinite_at_zero=True)))
    assert "d = 0 m" in refused(bb, lambda: bb.register_shape(make(terms=logarithm)))
    assert bb.register_shape(make(name="log_of_test", terms=logarithm, infinite_at_zero=True)).infinite_at_zero
    root = lambda self, d, d_hat: tuple(x * np.ones_like(d) for x in ((d_hat - d) ** 3 / d_hat * (d / d_hat) ** 0.0, -3 * (d_hat - d) ** 2 / d_hat, 6 * (d_hat - d) / d_hat))  # noqa: E731
    assert "infinite_at_zero" in refused(bb, lambda: bb.register_shape(make(terms=root, infinite_at_zero=True)))
    assert not bb.register_shape(make()).infinite_at_zero


def of_three(b, db, d2b):
    return lambda self, d, d_hat: tuple(d_hat**n * x for n, x in zip((2, 1, 0), (b(d / d_hat), db(d / d_hat), d2b(d / d_hat))))


def bounded(power):
    """(1 - u)^3 (2 - u^p)."""
    p = power
    return of_three(lambda u: (1 - u) ** 3 * (2 - u**p), lambda u: -3 * (1 - u) ** 2 * (2 - u**p) - (1 - u) ** 3 * p * u ** (p - 1),
                    lambda u: 6 * (1 - u) * (2 - u**p) + 6 * (1 - u) ** 2 * p * u ** (p - 1) - (1 - u) ** 3 * p * (p - 1) * u ** (p - 2))


def exponential():
    """(1 - u)^3 exp(1/u), which is beyond the largest double at u = 0.0014."""
    e = lambda u: np.exp(1 / u)  # noqa: E731
    return of_three(lambda u: (1 - u) ** 3 * e(u), lambda u: -((1 - u) ** 2) * e(u) * (3 + (1 - u) / u**2),
                    lambda u: (1 - u) * e(u) * (6 + 6 * (1 - u) / u**2 + (1 - u) ** 2 * (1 / u**4 + 2 / u**3)))


@pytest.mark.parametrize("power", [0.5, 0.05, 0.01, 0.004])
def test_a_bounded_power_is_not_infinite_however_slowly_it_ends(bb, power):
    assert "infinite_at_zero True of a b that grows by" in refused(bb, lambda: bb.register_shape(make(terms=bounded(power), infinite_at_zero=True)))


def test_what_grows_without_bound_is_infinite_however_slowly_or_fast(bb):
    """The logarithm of a logarithm, and what overflows doubles, whose values there are those at d = 0."""
    w = lambda u: 1 - np.log(u)  # noqa: E731
    slow = of_three(lambda u: (1 - u) ** 3 * (1 + np.log(w(u))), lambda u: -3 * (1 - u) ** 2 * (1 + np.log(w(u))) - (1 - u) ** 3 / (u * w(u)),
                    lambda u: 6 * (1 - u) * (1 + np.log(w(u))) + 6 * (1 - u) ** 2 / (u * w(u)) + (1 - u) ** 3 * (w(u) - 1) / (u * w(u)) ** 2)
    assert bb.register_shape(make(name="slow_of_test", terms=slow, infinite_at_zero=True)).infinite_at_zero
    with np.errstate(all="ignore"):
        fast = bb.register_shape(make(name="fast_of_test", terms=exponential(), infinite_at_zero=True))
        assert tuple(fast(1e-8, 0.01)) == tuple(fast(0.0, 0.01)) == (np.inf, -np.inf, np.inf)
        assert np.isfinite(tuple(fast(1e-4, 0.01))).all()


def test_not_a_number_near_zero_is_refused(bb):
    wrong = lambda self, d, d_hat: tuple(np.where(d < 1e-7, np.nan, x) for x in logarithm(self, d, d_hat))  # noqa: E731
    assert "no number b at d = 1e-9 d_hat; allowed: numbers, or +inf" in refused(bb, lambda: bb.register_shape(make(terms=wrong, infinite_at_zero=True)))


def test_numbers_of_python_shapes_and_policies_are_real(bb):
    imaginary = lambda self, d, d_hat: tuple(x + 0j for x in (d, d, d))  # noqa: E731
    assert "complex numbers" in refused(bb, lambda: bb.register_shape(make(terms=imaginary)))
    assert "None" in refused(bb, lambda: bb.register_shape(make(terms=lambda self, d, d_hat: (None, None, None))))

    class Policy:
        name = "policy_of_test"

        def kappa(self, rows):
            return rows.d + 1j

    assert "kappa: found complex numbers" in refused(bb, lambda: bb.register_policy(Policy()))

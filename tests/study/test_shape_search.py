"""The study shape_search: its shapes, their stiffness, and searches that are replayed from kept rows."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.start import evaluated
from barrierbench_analysis.studies.kit.study import collect, store
from barrierbench_analysis.studies.kit.study.spec import Study, read_study
from barrierbench_analysis.studies.rules.shape_search import measured, report, search, shape, states
from barrierbench_analysis.studies.rules.shape_search.evolution import Evolution

PARAMETERS = [round(float(x), 6) for x in np.random.default_rng(4).normal(0.0, 1.5, shape.PARAMETERS)]
GAPS = [0.0007, 0.004, 0.006, 0.03, 0.1, 0.25, 0.5, 0.7, 0.88, 0.96, 0.9999]
pytestmark = pytest.mark.usefixtures("built")


@pytest.fixture(scope="module")
def plugin(tmp_path_factory):
    return str(shape.make_plugin({"searched_one": PARAMETERS}, tmp_path_factory.mktemp("plugin")))


@pytest.fixture
def study(tmp_path):
    """Of two small states each, without a row."""
    found = read_study("shape_search", tmp_path)
    few = {"tune": ["springs_quadratic", "noodle_pile"], "report": ["twist_cloth", "cards_impact"]}
    about = {**found.about, "states": few, "searches": {"from-log": "log"}, "generation": 4, "generations": 3}
    return Study(found.file, {**found.data, "about": about}, tmp_path)


def terms(plugin, gaps, name="searched_one", d_hat=1.0) -> np.ndarray:
    """[gaps, 3]: b, b', b''."""
    queries = [{"kind": "shape", "shape": name, "d": u * d_hat, "d_hat": d_hat} for u in gaps]
    return np.array([[one["b"], one["db"], one["d2b"]] for one in evaluated(queries, [plugin])])


# ---- shapes


def test_derivatives_of_a_generated_shape_are_those_of_its_energy(plugin):
    for u in GAPS[:-1]:
        h = 1e-4 * min(u, 1 - u)
        low, here, high = terms(plugin, [u - h, u, u + h])
        for k in (0, 1):
            slope = (high[k] - low[k]) / (2 * h)
            assert here[k + 1] != 0 and slope == pytest.approx(here[k + 1], rel=2e-4), (u, k)


def test_a_generated_shape_is_the_integral_of_its_curvature(plugin):
    """By the trapezoidal rule between knots, where b'' is linear, from a list of its values alone."""
    heights = np.cumsum(np.exp(PARAMETERS[::-1]))[::-1]
    knots = np.append(shape.KNOTS, 1.0)
    d2b = np.append(heights, 0.0)
    for u in GAPS[2:]:
        grid = np.append(u, knots[knots > u])
        force = float(np.trapz(np.interp(grid, knots, d2b), grid))
        b, db, curvature = terms(plugin, [u])[0]
        assert b > 0 and -db == pytest.approx(force, rel=1e-9) and curvature == pytest.approx(np.interp(u, knots, d2b), rel=1e-9)
        (rho,) = shape.relative_stiffness(PARAMETERS, [u])
        assert rho == pytest.approx(curvature / force, rel=1e-9)
    tail = terms(plugin, [1e-9, 1e-8, shape.LOWEST])  # is unbounded
    assert tail[0, 1] == pytest.approx(10 * tail[1, 1], rel=1e-3) and tail[1, 1] < 10 * tail[2, 1]
    assert tail[1, 2] == pytest.approx((shape.LOWEST / 1e-8) ** 2 * tail[2, 2], rel=1e-9)
    assert shape.relative_stiffness(PARAMETERS, [1e-9])[0] == pytest.approx(1e9, rel=1e-3)


def test_a_generated_shape_joins_at_its_knots_and_scales(plugin):
    for knot in (*shape.KNOTS, 1.0):
        above, below = terms(plugin, [knot * (1 + 1e-12), knot * (1 - 1e-12)])
        assert above == pytest.approx(below, rel=1e-8, abs=1e-7), knot
    assert not terms(plugin, [1.0, 1.2]).any()
    assert np.array_equal(terms(plugin, GAPS, d_hat=0.25) * [16, 4, 1], terms(plugin, GAPS))


def test_every_shape_falls_and_is_convex_and_its_curvature_falls(plugin):
    b, db, d2b = terms(plugin, np.linspace(0.0005, 0.9995, 400)).T
    assert (b > 0).all() and (db < 0).all() and (d2b > 0).all()
    assert all((np.diff(column) < 0).all() for column in (b, -db, d2b))


def test_the_program_finds_nothing_wrong_with_a_generated_shape(plugin):
    assert [one["rho"] for one in evaluated([{"kind": "rho", "shape": "searched_one", "u": u} for u in GAPS], [plugin])] == pytest.approx(
        shape.relative_stiffness(PARAMETERS, GAPS), rel=1e-6
    )


def test_parameters_of_a_known_shape_are_close_to_it():
    known = shape.terms_of("log", shape.KNOTS)
    found = shape.relative_stiffness(shape.parameters_of(known["curvature"]), shape.KNOTS)
    assert found == pytest.approx(known["rho"], rel=0.1)


# ---- stiffness


@pytest.mark.parametrize("name", ["springs_quadratic", "twist_cloth", "noodle_pile"])
def test_a_state_with_another_shape_carries_the_same_load_at_theta(name):
    half = "report" if name == "twist_cloth" else "tune"
    kept = states.of_half({half: [name]}, half)[name]
    force = shape.terms_of("cubic", [0.1])["force"][0]
    made = states.with_shape(kept, "cubic", force, 0.1)
    own = shape.terms_of(kept["config"]["formulation"]["shape"], [0.1])["force"][0]
    assert made["config"]["formulation"]["shape"] == "cubic" and kept["config"]["formulation"]["shape"] != "cubic"
    assert states.stiffness_of(made) * force == pytest.approx(states.stiffness_of(kept) * own, rel=1e-12)
    assert states.stiffness_of(made) != states.stiffness_of(kept)


@pytest.mark.parametrize(
    ("name", "text"), [("twist_cloth", "found half report"), ("stack_pressed", "strain limit True")]
)
def test_a_state_that_a_search_must_not_see_or_has_more_than_contact_is_refused(name, text):
    with pytest.raises(UserError, match=text):
        states.of_half({"tune": [name]}, "tune")


# ---- searches


def row_of(study, cell, iterations=(10, 10), **values) -> store.Row:
    """A row as `run` makes it."""
    found = dict.fromkeys(measured.MEASURED) | {
        **{"iterations": list(iterations), "ends": ["converged"] * 2, "processor_s": 1.0, "products": [5, 5]},
        **{name: [0.05, 0.1] for name in ("gap_min", "gap_p05", "gap_median")},
        **{"gap_p95": [0.6, 0.8], "parameters": cell.settings.get(search.PARAMETERS), "name": cell.settings.get("/shape")},
    }
    if found["name"]:
        known = shape.terms_of(found["name"], shape.KNOTS)
        found |= {"curvature": known["curvature"], "load_ratio": [10.0, 20.0], "rho": shape.terms_of(found["name"], shape.CURVE)["rho"]}
    origin = {"date": "2026-01-01", "machine": "m", "commit": "c", "build": "b"}
    return store.Row(cell.key, cell.place, "ok", found | values, collect.sources_of(study), 0, 1.0, "", origin)


def keep(study, *, many=99, work=None) -> list:
    """Rows of the next cells without one, and those cells. work: of parameters; without it some number."""
    file = store.file_of(study)
    rows = store.read_rows(file)
    new = [cell for cell in replace(study).cells if cell.key not in rows][:many]
    for cell in new:
        point = cell.settings.get(search.PARAMETERS)
        n = 2 + (work(point) if work and point else len(cell.key) + sum(map(ord, cell.key)) % 50)
        rows[cell.key] = row_of(study, cell, (n, n))
    store.write_rows(file, rows)
    return new


def points(cells) -> list:
    return [cell for cell in cells if search.LABEL.fullmatch(cell.place["shape"])]


def test_a_search_begins_once_its_shape_was_measured_and_goes_on_by_generations(study):
    assert {cell.place["search"] for cell in study.cells} == {search.KNOWN}
    keep(study)
    first = keep(study)
    assert [cell.place["shape"] for cell in points(first)] == ["g0.00", "g0.01", "g0.02", "g0.03"]
    assert [cell.place["shape"] for cell in first if cell not in points(first)] == ["minimax", "minimax"]
    assert [cell.place["shape"] for cell in keep(study)] == ["g1.00", "g1.01", "g1.02", "g1.03"]
    assert search.planned(study, search.rows_of_today(study)) == ["from-log: 2 of 3 generations"]
    assert len(points(keep(study))) == 4
    ends = keep(study)
    assert [(cell.place["half"], cell.place["shape"]) for cell in ends] == [
        ("tune", "centre"), ("report", "centre"), ("report", "best")
    ]
    assert keep(study) == []


def test_a_replayed_search_draws_the_same_points_wherever_it_was_stopped(study, tmp_path):
    other = replace(study, out=tmp_path / "other")
    other.out.mkdir()
    whole = [cell.key for _ in range(5) for cell in points(keep(study))]
    broken = [cell.key for _ in range(40) for cell in points(keep(other, many=3))]
    assert len(whole) == 12 and [*dict.fromkeys(broken)] == whole
    seeded = replace(study, data={**study.data, "about": {**study.about, "seed": 1}})
    assert not {cell.key for cell in points(seeded.cells)} & set(whole)


def test_what_was_measured_on_report_changes_no_point_of_a_search(study, tmp_path):
    other = replace(study, out=tmp_path / "other")
    other.out.mkdir()
    for _ in range(5):
        keep(study), keep(other)
    rows = store.read_rows(store.file_of(other))
    changed = {
        key: replace(row, values={**row.values, "iterations": [2, 2]}) if row.place["half"] == "report" else row
        for key, row in rows.items()
    }
    assert changed != rows
    store.write_rows(store.file_of(other), changed)
    assert [cell.key for cell in replace(other).cells] == [cell.key for cell in replace(study).cells]
    point = next(row for row in rows.values() if row.place["shape"] == "g0.01")
    stolen = replace(point, key="0", place={**point.place, "half": "report"}, values={**point.values, "iterations": [2, 2]})
    found = search.replayed(study, "from-log", {**rows, "0": stolen})
    assert all(row.place["half"] == "tune" for row in found.rows) and stolen not in found.rows


def test_the_states_of_the_halves_are_those_of_the_corpus():
    about = read_study("shape_search").about
    for half in ("tune", "report"):
        assert len(states.of_half(about["states"], half)) >= 4
    assert not {*about["states"]["tune"]} & {*about["states"]["report"]}


def test_a_shape_that_fails_counts_as_the_limit(study):
    keep(study)
    cell = points(replace(study).cells)[0]
    crashed = measured._record(study, cell, [], study.out)  # no plugin has its shape
    assert crashed["status"]["outcome"] == "crash"
    found = collect.row_of(study, cell, crashed)
    assert found.values["iterations"] == [200, 200] and found.values["ends"] == ["crash", "crash"]
    assert search.work(found) == pytest.approx(math.log(200))
    trial = {"status": "iteration_cap", "iterations": 7, "factorizations": 1,
             "linear_iterations": 2, **dict.fromkeys(measured.GAPS.values())}
    taken = [{"name": "springs_quadratic", "seconds": 1.0, "trials": [trial | {"status": "converged"}]},
             {"name": "noodle_pile", "seconds": 1.0, "trials": [trial]}]
    stopped = collect.row_of(study, cell, crashed | {"corpus": {"states": taken}})
    assert stopped.values["iterations"] == [7, 200] and search.work(stopped) == pytest.approx(math.log(7 * 200) / 2)


def test_a_shape_is_measured_on_the_kept_steps(study):
    keep(study)
    cell = points(replace(study).cells)[0]
    (row,) = measured.run(study, [cell], study.out / "runs", 1)
    assert row.values["ends"] == ["converged", "converged"] and row.outcome == "ok"
    assert all(2 < n < 200 for n in row.values["iterations"]) and all(0 < gap < 1 for gap in row.values["gap_min"])
    assert row.values["parameters"] == cell.settings[search.PARAMETERS]
    log = study.cell(search.known_case(study, "tune", "log", "log"))
    (known,) = measured.run(study, [log], study.out / "runs", 1)
    assert known.values["iterations"] != row.values["iterations"]
    assert all(one > 1 for one in known.values["load_ratio"])
    # the state of a run with the log is taken with the stiffness of that run: 23 iterations, as in results/steps.json
    assert known.values["iterations"][1] == 23


# ---- the strategy, and the page


def test_the_strategy_finds_the_least_value_of_an_ill_conditioned_function():
    evolution = Evolution(np.full(8, 3.0), 1.0, 10, 5)
    scale = 10.0 ** np.linspace(0, 2, 8)
    for _ in range(300):
        found = evolution.ask()
        assert np.array_equal(found, evolution.ask())
        evolution.tell(found, [float(np.sum((scale * (x - 1)) ** 2)) for x in found])
    assert evolution.mean == pytest.approx(np.ones(8), abs=1e-4)


def test_the_strategy_goes_on_from_kept_points_as_without_a_break():
    unbroken, kept = Evolution(np.zeros(5), 0.5, 8, 3), []
    for _ in range(12):
        points = np.round(unbroken.ask(), 3)
        kept.append((points, [float(np.sum((x - 2) ** 2)) for x in points]))
        unbroken.tell(*kept[-1])
    later = Evolution(np.zeros(5), 0.5, 8, 3)
    for one in kept:
        later.tell(*one)
    assert later.generation == 12 and np.array_equal(later.ask(), unbroken.ask())
    assert not np.array_equal(later.ask(), np.round(kept[-1][0], 3)) and np.ptp(later.ask()) > 0


def test_the_page_says_whether_what_was_found_is_the_law(study):
    for _ in range(6):
        keep(study)
    rows = list(search.rows_of_today(study).values())
    found = report.rule(study, rows)
    assert found["ended"] and len(found["same"]) == 2 and all("has not settled" in line for line in found["same"])
    assert len(found["best"]) == 2 and all("of the shapes of the program." in line for line in found["best"])
    assert len(found["rest"].split(", ")) > 1
    law = next(one for one in found["curves"]["known"] if one.label.startswith("minimax ("))
    assert law.label == f"minimax (law 1: {2.5 + math.log(math.sqrt(200)):.3g})"  # its loads have the ratio sqrt(10 20)
    same = report.Found("x", {"tune": SimpleNamespace(values={"gap_p05": [0.1], "gap_p95": [0.5]})}, [1.4 * x for x in law.rho])
    assert report.apart(same, law) == pytest.approx((1.4, 1.4))
    assert "is the same shape" in report._same(study, [same], law, {"x": 0.1})[0]
    assert "has not settled" in report._same(study, [same], law, {"x": 0.3})[0]
    other = report.Found("x, best", same.rows, [1.6 * x for x in law.rho])
    assert "is another shape" in report._same(study, [other], law, {"x": 0.1})[0]
    less = replace(same, rho=[0.6 * x for x in law.rho])
    assert "another shape" in report._same(study, [less], law, {"x": 0.2})[0]
    beyond = replace(same, rho=[x * (9 if u > 0.5 or u < 0.1 else 1) for u, x in zip(shape.CURVE, law.rho)])
    assert report.apart(beyond, law) == pytest.approx((1, 1))  # no contact rests there
    pair = [replace(same, label=f"{name}, best", rows={"tune": row}) for name, row in (("a", rows[0]), ("b", rows[0]))]
    assert "a, best, and b, best, are the same shape" in report._agreement(study, pair)[0]
    assert "are two shapes" in report._agreement(study, [pair[0], replace(pair[1], rho=law.rho[::-1])])[0]

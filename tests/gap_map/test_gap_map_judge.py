"""What the rows of a gap map say, on made-up rows and traces whose answers are known by hand."""

import math
import re

import pytest
from barrierbench_analysis.studies.rules.gap_map import compare, law, measured, page, size, size_tables
from barrierbench_analysis.studies.rules.gap_map.table import COLUMNS, Map


METRICS = ("newton", "pcg", "pcg_max", *(f"{name}_{k}" for name in measured.STAGES for k in measured.CONDS))


def made(shape="log", theta=0.1, gap=0.1, scene="s", resolution="1", limit="off", **more):
    found = dict.fromkeys(COLUMNS) | {"scene": scene, "resolution": resolution, "shape": shape, "limit": limit, "theta": theta, "outcome": "ok", "gap": gap, "gap_p05": gap,
                                           "rho": 10.0, "rho_p05": 10.0, "load": 1.0, "unknowns": 100, "seconds": 1.0}
    return found | {m: 100.0 for m in METRICS} | {"nc_end": 1.0, "nc_bj_end": 1.0} | more


def sample(cond, stage="full", scaling="none", status=None):
    return {"matrix": "clamped", "stage": stage, "scaling": scaling, "cond": cond, "status": status or ("singular" if cond is None else "ok")}


def test_the_reached_gap_is_the_load_weighted_median():
    one = [(1.0, [0.01, 0.1, 0.5])]
    assert measured.quantile_of_mixture(one, 0.5) == pytest.approx(0.1) and measured.quantile_of_mixture(one, 0.05) == pytest.approx(0.01)
    # nine parts of ten of the load rest at 0.2, whatever a light pair does
    assert measured.quantile_of_mixture([(0.9, [0.19, 0.2, 0.21]), (0.1, [0.001, 0.0011, 0.0012])], 0.5) == pytest.approx(0.2, rel=0.02)
    # half of the load in each of two pairs that share no gap; between 5% and 50% of a pair linear in the logarithm
    two = [(0.5, [0.01, 0.04, 0.1]), (0.5, [0.2, 0.3, 0.4])]
    assert measured.quantile_of_mixture(two, 0.25) == pytest.approx(0.04) and measured.quantile_of_mixture(two, 0.1375) == pytest.approx(0.02)
    assert measured.quantile_of_mixture([], 0.5) is None and measured.quantile_of_mixture([(0.0, [0.1, 0.2, 0.3])], 0.5) is None


def test_conditions_are_of_iterations_in_contact_and_of_the_last_ones_of_steps():
    def line(step, iteration, contacts, cond):
        return {"step": step, "iteration": iteration, "contacts": {"obstacle": contacts}, "cond": [sample(cond), sample(2.0, "without_contact")], "probe_pcg_iterations": cond / 10}

    found = measured.conditions([line(0, 0, 0, 9e9), line(1, 0, 3, 1000.0), line(1, 1, 3, 10.0), line(2, 0, 3, 30.0), line(3, 0, 4, 5e5), line(3, 1, 0, 1.0)])
    assert found["cond_end"] == 20.0 and found["cond_end_max"] == 30.0  # of steps 1 and 2: step 3 ends without contact
    assert found["cond_median"] == 515.0 and found["nc_end"] == 2.0 and found["bj_p95"] is None
    assert found["pcg"] == 51.5 and found["pcg_max"] == 5e4
    infinite = measured.conditions([{"step": 0, "iteration": 0, "contacts": {"obstacle": 1}, "cond": [sample(None)]}])
    assert infinite["cond_p95"] == measured.LARGEST and infinite["pcg"] is None and infinite["unknown"] == 0


@pytest.mark.parametrize("status, largest, unknown", [("singular", measured.LARGEST, 0), ("not_pd", measured.LARGEST, 0), ("not_converged", 10.0, 1), ("lower_bound", 10.0, 1)])
def test_an_estimate_without_a_number_is_no_condition_number(status, largest, unknown):
    """As the summary of the program counts."""
    line = {"step": 0, "iteration": 0, "contacts": {"obstacle": 1}, "cond": [sample(10.0), sample(None, status=status)]}
    found = measured.conditions([line])
    assert found["cond_end_max"] == largest and found["unknown"] == unknown
    alone = measured.conditions([line | {"cond": [sample(None, status="not_converged")]}])
    assert alone["cond_p95"] is None and alone["cond_end"] is None and alone["unknown"] == 1


def page_of(rows_of, shapes=("log", "cubic"), gaps=(0.5, 0.01)) -> Map:
    return Map({"shapes": [{"label": s, "shape": s, "argument": "gap"} for s in shapes], "main": list(shapes), "gaps": list(gaps), "limits": ["off"]}, rows_of)


def in_places(shape, places, theta=0.1, **more):
    return [made(shape, theta, 0.1, scene, resolution, **more) for scene, resolution in places]


def test_series_are_cut_to_the_places_that_all_share():
    """b has 1 and 2, c has 2 and 3: 2 alone is compared."""
    cut = compare.common({"b": {"1": 1.0, "2": 2.0, "3": None}, "c": {"1": None, "2": 4.0, "3": 5.0}})
    assert cut.places == ("2",) and cut.of == {"b": {"2": 2.0}, "c": {"2": 4.0}} and cut.left_out == {}


def test_a_series_with_half_of_its_places_is_named_and_leaves_the_others_theirs():
    cut = compare.common({"b": dict.fromkeys("1234", 1.0), "c": {"1": 1.0, "2": 1.0, "3": None, "4": None}, "d": {"1": None}})
    assert cut.places == tuple("1234") and list(cut.of) == ["b"] and cut.left_out == {"c": (2, 4), "d": (0, 1)}
    alone = compare.common({"c": {"1": 1.0, "2": None}})
    assert alone.places == ("1",) and alone.left_out == {}  # there is no other to leave a place to
    none = compare.common({})
    assert none.of == {} and none.places == () and compare.common({"b": {"1": 1.0}, "c": {"2": 1.0}}).of == {}


def test_shapes_are_ranked_on_places_that_all_of_them_have():
    """In place b, where the exponential fails, every shape is ten times as good: on its own places the cubic would
    stand before the exponential, which is better wherever both got through."""
    a, b, c = ("a", "1"), ("b", "1"), ("c", "1")
    every = in_places("log", (a, b, c), cond_p95=100.0) + in_places("cubic", (a, c), cond_p95=50.0) + in_places("cubic", (b,), cond_p95=0.5)
    every += in_places("exponential", (a, c), cond_p95=40.0) + in_places("exponential", (b,), outcome="stall_overload")
    here = compare.at_theta(every, "off", 0.1, ["cubic", "exponential"])
    assert here.cut.places == (a, c) and here.cut.words == "2 places of 2 scenes"
    assert {s: r["cond_p95"].value for s, r in here.ratios.items()} == {"cubic": pytest.approx(0.5), "exponential": pytest.approx(0.4)}
    alone = compare.at_theta(every, "off", 0.1, ["cubic"]).ratios["cubic"]["cond_p95"]
    assert alone.value < 0.2 and alone.scenes == 3
    said = page.sentences(page_of(every, ("log", "cubic", "exponential"), (0.1,)))[0]
    assert "(the 2 places of 2 scenes in which all of these got through) `exponential` 0.4 [0.4, 0.4], `cubic` 0.5 [0.5, 0.5]" in said


def test_rows_of_a_table_that_stand_together_are_of_the_same_places():
    every = in_places("log", [("a", "1"), ("b", "1"), ("c", "1")]) + in_places("cubic", [("a", "1"), ("b", "1"), ("c", "1")])
    every += in_places("quadratic", [("a", "1"), ("b", "1")]) + in_places("quadratic", [("c", "1")], outcome="newton_stall")
    every += in_places("two_stage", [("a", "1")]) + in_places("two_stage", [("b", "1"), ("c", "1")], outcome="newton_stall")
    lines = page.beside_table(page_of(every, ("log", "cubic", "quadratic", "two_stage"), (0.1,)), "off", "theta", compare.at_theta)
    rows_of = [line for line in lines if line.startswith("| 0.1 ")]
    assert [row.split(" | ")[-1] for row in rows_of[:2]] == ["2 places of 2 scenes |"] * 2
    assert rows_of[2].startswith("| 0.1 | not compared: `two_stage` (1 of 3)") and len(rows_of) == 3


def test_where_contact_rests_is_said_of_one_target_and_of_shared_places():
    """cubic reached more at 0.01 in a place that the log did not, and its softest gap is at another target."""
    every = [made("log", 0.01, 0.02, "a"), made("log", 0.01, 0.02, "c"), made("log", 0.01, None, "b", outcome="newton_stall"), made("log", 0.5, 0.001, "a"),
             made("cubic", 0.01, 0.3, "a"), made("cubic", 0.01, 0.3, "c"), made("cubic", 0.01, 0.1, "b"), made("two_stage", 0.01, None, "a", outcome="newton_stall"), made("two_stage", 0.5, 0.2, "a")]
    cut = compare.deepest(every, "off", ["log", "cubic", "two_stage"], 0.01)
    assert compare.middles(cut) == {"log": 0.02, "cubic": 0.3} and cut.places == (("a", "1"), ("c", "1")) and cut.left_out == {"two_stage": (0, 1)}
    said = page.sentences(page_of(every, ("log", "cubic", "two_stage")))[1]
    assert said.endswith("rests at 0.02 (`log`), 0.3 (`cubic`) (median of the 2 places of 2 scenes that all of these reached); without a gap in half of the places or more: `two_stage`.")


def test_where_nothing_rests_is_said():
    for rows_of in ([made("log", 0.5, 0.4), made("cubic", 0.5, 0.4)], [made("log", 0.01, 0.02, "a"), made("cubic", 0.01, 0.02, "b")]):
        assert page.sentences(page_of(rows_of))[1].endswith("there is no place where every shape that reached a gap has one.")


def test_a_ratio_averages_resolutions_before_scenes():
    all_rows = []
    for scene, resolutions, factor in (("a", ("1", "2", "3"), 2.0), ("b", ("1",), 8.0)):
        for resolution in resolutions:
            for shape in ("log", "cubic"):
                all_rows += [made(shape, theta, gap, scene, resolution, cond_p95=100.0 * (factor if shape == "cubic" else 1.0)) for theta, gap in ((0.5, 0.5), (0.1, 0.1))]
    for here in (compare.at_gap(all_rows, "off", 0.3, ["cubic"]), compare.at_theta(all_rows, "off", 0.1, ["cubic"])):
        found = here.ratios["cubic"]["cond_p95"]
        assert found.value == pytest.approx(4.0) and found.scenes == 2
        # Student's t with one degree of freedom: 12.706 times the standard error ln 2 of the mean of ln 2 and ln 8
        assert (math.log(found.upper / 4), math.log(4 / found.lower)) == pytest.approx([12.7062 * math.log(2)] * 2, rel=1e-4)
    with pytest.raises(ValueError, match="one scene"):
        compare.over_scenes({})


def test_nothing_is_filled_in_where_a_gap_was_not_reached():
    all_rows = [made("log", 0.5, 0.5), made("log", 0.01, 0.01), made("cubic", 0.5, 0.6), made("cubic", 0.01, 0.3)]

    def at(rows_of, gap):
        return compare.at_gap(rows_of, "off", gap, ["cubic"]).ratios

    assert at(all_rows, 0.4) and not at(all_rows, 0.1) and not at(all_rows, 0.55)
    assert law.unreached(all_rows, [0.5, 0.1, 0.01]) == {("off", "cubic"): [0.1, 0.01]}
    assert compare.deepest(all_rows, "off", ["cubic"]).of == {"cubic": {("s", "1"): 0.3}}
    broken = all_rows[:2] + [made("cubic", 0.5, 0.6), made("cubic", 0.1, 0.5, outcome="stall_overload"), made("cubic", 0.01, 0.3)]
    assert not at(broken, 0.4)  # not across a run that failed
    assert not compare.at_theta(broken, "off", 0.1, ["cubic"]).ratios
    assert law.failures(broken) == {("cubic", "off", 0.1): {"stall_overload": 1}}
    assert law.failures([*broken, made("log", 0.25, None, "s", outcome="not run")]) == law.failures(broken)  # no failure


def test_every_step_of_every_line_is_of_the_same_places():
    """Place c is lost at the second target: with it the first step would be of other places than the second. At the
    third only one of three is left, so lines end; what a shape cannot reach ends its own line alone."""
    all_rows = [made("log", theta, theta, scene, pcg=p) for theta in (0.5, 0.1, 0.01) for scene, p in (("a", 20.0), ("b", 80.0), ("c", 40.0))]
    all_rows += [made("cubic", 0.5, 0.6, scene, pcg=10.0) for scene in "abc"] + [made("cubic", 0.1, 0.3, scene, pcg=10.0) for scene in "ab"]
    all_rows += [made("cubic", 0.1, None, "c", outcome="newton_stall"), made("cubic", 0.01, 0.2, "a", pcg=10.0)]
    all_rows += [made("cubic", 0.01, None, scene, outcome="newton_stall") for scene in "bc"]
    all_rows += [made("cubic_of_square", 0.5, 0.7, scene, pcg=10.0) for scene in "abc"] + [made("cubic_of_square", theta, None, s, outcome="cannot reach") for theta in (0.1, 0.01) for s in "abc"]
    found = compare.lines(all_rows, "off", ["log", "cubic", "cubic_of_square"], "pcg", lambda r: 1.0)
    assert [p[0] for p in found.whole] == ["a", "b"] and [p[0] for p in found.run] == ["a", "b", "c"]
    assert [(s.theta, s.value) for s in found.of["log"]] == [(0.5, pytest.approx(40.0)), (0.1, pytest.approx(40.0))]
    assert [s.theta for s in found.of["cubic"]] == [0.5, 0.1] and [s.theta for s in found.of["cubic_of_square"]] == [0.5]
    assert len(found.thin["cubic"]["a", "1"]) == 3 and len(found.thin["cubic"]["c", "1"]) == 1


def test_a_line_is_of_places_whose_whole_path_was_run():
    whole = [made("log", theta, theta, "a", pcg=20.0) for theta in (0.5, 0.1)]
    part = [made("log", 0.5, 0.5, "b", pcg=80.0), made("log", 0.1, None, "b", outcome="not run")]
    assert [p[0] for p in compare.lines([*whole, *part], "off", ["log"], "pcg", lambda r: 1.0).whole] == ["a"]
    assert [p[0] for p in compare.lines([*whole, part[0], made("log", 0.1, 0.1, "b", pcg=80.0)], "off", ["log"], "pcg", lambda r: 1.0).whole] == ["a", "b"]


def by_sizes():
    """The log's cond is 8 times the cubic's at 100 unknowns and twice at 2000, in a; b was run coarse alone; c fails."""
    found = []
    for scene, resolution, unknowns, ratio in (("a", "1", 100, 8.0), ("a", "2", 2000, 2.0), ("b", "1", 100, 32.0)):
        found += [made(shape, 0.01, 0.1, scene, resolution, unknowns=unknowns, cond_p95=100.0 * (ratio if shape == "log" else 1.0)) for shape in ("log", "cubic")]
    return found + [made("log", 0.01, 0.1, "c"), made("cubic", 0.01, None, "c", outcome="stall_overload", unknowns=100)]


def test_sizes_are_compared_in_the_same_scenes():
    sizes = size.by_size(by_sizes())
    assert [(s.scene, s.unknowns, s.ratios and s.ratios["cond_p95"]) for s in sizes] == [("a", 100, 8.0), ("a", 2000, 2.0), ("b", 100, 32.0), ("c", 100, None)]
    both = size.halves(sizes, 0.01)
    assert both.scenes == ("a",) and [r.value for r in both.ratios["cond_p95"]] == pytest.approx([8.0, 2.0])
    assert both.unknowns == ((100, 100), (2000, 2000)) and size.halves(sizes, 0.1) is None
    assert sizes[-1].failed == "cubic: stall_overload"
    [said] = size_tables.sentences(page_of(by_sizes()))
    assert "with 100 to 100 unknowns and with 2000 to 2000 unknowns of the same scenes, at theta 0.01 (1 scenes) raw cond 8 and 2" in said
    assert size_tables.sentences(page_of(by_sizes()[:2])) == [] and "c 1 at theta 0.01 (cubic: stall_overload)" in size_tables.failed(page_of(by_sizes()))


POWERS = {"cond_p95": 1.0, "bj_p95": 0.5, "pcg": -0.25, "newton": -2.0}  # metric -> its slope over that of cond


def with_slopes(slopes_of_scenes, theta=0.01, shift=0.0):
    """Rows in which the log's number over the cubic's is n^((slope of the scene + shift) times the power of the metric)."""
    found = []
    for scene, resolution, unknowns, power in slopes_of_scenes:
        for shape in ("log", "cubic"):
            ratio = {m: 100.0 * (unknowns ** ((power + shift) * of) if shape == "log" else 1.0) for m, of in POWERS.items()}
            found.append(made(shape, theta, 0.1, scene, resolution, unknowns=unknowns, **ratio))
    return found


SLOPES = (("a", "1", 100, -1.0), ("a", "2", 400, -1.0), ("b", "1", 100, -0.5), ("b", "2", 900, -0.5), ("b", "3", 2500, -0.5), ("c", "1", 100, 3.0))


def test_every_column_of_slopes_has_the_metric_of_its_head_and_every_row_its_target():
    rows_of = with_slopes(SLOPES) + with_slopes(SLOPES, 0.5, shift=0.125)
    first, second = [line.strip("| ").split(" | ") for line in size_tables.slope_table(page_of(rows_of)) if line.startswith("| 0.")]
    [heads] = [line.strip("| ").split(" | ") for line in size_tables.slope_table(page_of(rows_of)) if line.startswith("| theta")]
    assert [head.partition(",")[0] for head in heads[3:]] == [size_tables.NAMES[metric] for metric in POWERS]
    for row, theta, middle in ((first, "0.5", -0.625), (second, "0.01", -0.75)):
        assert row[:3] == [theta, "2", "100 to 2500"]
        for cell, power in zip(row[3:], POWERS.values()):
            half = abs(power) * 0.25 * 12.7062047
            value, low, high = map(float, re.findall(r"[-.\d]+", cell))
            assert (value, low, high) == pytest.approx((middle * power, middle * power - half, middle * power + half), rel=5e-3)
    assert len({*first[3:], *second[3:]}) == 8


def test_slopes_are_of_what_the_figure_draws_and_their_interval_is_over_scenes():
    """Scene a has the ratio n^-1, b n^-0.5 with a mesh more; c has one size and no slope. By hand: -0.75 and 0.25 t(0.975, 1)."""
    found = with_slopes(SLOPES)
    of = size.slope(size.drawn_sizes(found), "cond_p95")
    assert of.by_scene == pytest.approx({"a": -1.0, "b": -0.5}) and of.value == pytest.approx(-0.75)
    assert (of.lower, of.upper) == pytest.approx((-0.75 - 0.25 * 12.7062047, -0.75 + 0.25 * 12.7062047))
    assert size.slope([s for s in size.by_size(found) if s.scene == "c"], "cond_p95") is None
    [alone] = [size.slope([s for s in size.by_size(found) if s.scene == "a"], "cond_p95")]
    assert str(alone) == "-1" and alone.lower is None


def test_one_sheet_over_a_sphere_of_two_kinds_is_one_sample():
    """a has -1, cloth and cloth_mesh -0.5 and 0: two samples of -1 and -0.25, by hand -0.625 and 0.375 t(0.975, 1)."""
    scenes = [(scene, mesh, n, power) for scene, power in (("a", -1.0), ("cloth", -0.5), ("cloth_mesh", 0.0)) for mesh, n in (("1", 100), ("2", 2000))]
    found = with_slopes(scenes)
    of = size.slope(size.drawn_sizes(found), "cond_p95")
    assert of.value == pytest.approx(-0.625) and (of.lower, of.upper) == pytest.approx((-0.625 - 0.375 * 12.7062047, -0.625 + 0.375 * 12.7062047))
    assert len(of.by_scene) == 3 and "| 0.01 | 2 | 100 to 2000 |" in "\n".join(size_tables.slope_table(page_of(found)))
    ratio = compare.at_theta(found, "off", 0.01, ["cubic"])
    logs = [power * (math.log(100) + math.log(2000)) / 2 for power in (-1.0, -0.25)]
    assert ratio.ratios["cubic"]["cond_p95"].turned().value == pytest.approx(math.exp(sum(logs) / 2)) and ratio.ratios["cubic"]["cond_p95"].scenes == 2
    assert ratio.cut.words == "6 places of 2 scenes"
    alone = size.slope([s for s in size.drawn_sizes(found) if s.scene != "a"], "cond_p95")
    assert alone.lower is None and alone.value == pytest.approx(-0.25)  # one sample has no interval


def test_the_sentence_decides_what_the_intervals_of_the_slopes_decide():
    """-1 in two scenes and -0.9 in a third: cond falls, Newton (times -2) grows. With -1, 0 and 1 nothing is decided."""
    def said(powers):
        scenes = [(scene, mesh, n, power) for scene, power in zip("abc", powers) for mesh, n in (("1", 100), ("2", 2000))]
        [sentence] = size_tables.sentences(page_of(with_slopes(scenes)))
        return sentence

    assert "leaves 0 out: raw cond falls at theta 0.01; block Jacobi falls at theta 0.01; PCG grows at theta 0.01; Newton grows at theta 0.01; elsewhere" in said((-1.0, -1.0, -0.9))
    assert "raw cond is decided at none; block Jacobi is decided at none; PCG is decided at none; Newton is decided at none" in said((-1.0, 0.0, 1.0))


def test_how_often_contact_makes_the_largest_eigenvalue_counts_each_run_once():
    every = [made("log", cond_end=10.0, nc_end=1.0), made("log", 0.5, cond_end=1.5, nc_end=1.0), made("cubic"), made("quadratic")]
    assert law.made_by_contact(every, "off") == (1, 2)


def test_the_law_is_the_ratio_of_rho_and_its_floor_what_is_left_without_contact():
    log = made("log", rho=100.0, cond_end=1000.0, nc_end=10.0)
    [both] = law.pairs([log, made("cubic", rho=5.0, cond_end=60.0, nc_end=10.0)])
    assert both.predicted == pytest.approx(0.05) and both.measured == pytest.approx(0.06) and both.by_contact and both.error == pytest.approx(math.log(1.2))
    assert both.floored == pytest.approx(0.05)
    [soft] = law.pairs([log, made("cubic", rho=0.1, cond_end=10.5, nc_end=10.0)])
    assert soft.by_log and not soft.by_contact and soft.floored == pytest.approx(0.01) and soft.floor_error == pytest.approx(math.log(1.05))
    [none] = law.pairs([made("log", cond_end=20.0, nc_end=10.0), made("cubic", cond_end=60.0, nc_end=10.0)])
    assert not none.by_log and not none.by_contact
    assert law.pairs([log, made("cubic", theta=0.01)]) == []  # other loads
    assert law.pairs([log, made("cubic", outcome="stall_overload")]) == [] and law.pairs([log, made("cubic", rho=-3.0)]) == []


def test_exceptions_are_those_of_the_log_by_contact_and_have_reasons():
    log = made("log", rho=100.0, rho_p05=100.0, cond_end=1000.0, nc_end=1.0)
    fine = made("cubic", rho=10.0, cond_end=150.0)
    loads = made("quadratic", rho=10.0, cond_end=1000.0, load=10.0)
    deep = made("two_stage", rho=10.0, rho_p05=50.0, cond_end=500.0)
    odd = made("log_squared", rho=10.0, rho_p05=10.0, cond_end=900.0)
    of = law.pairs([log, fine, loads, deep, odd])
    assert {p.row["shape"] for p in law.exceptions(of)} == {"quadratic", "two_stage", "log_squared"}
    text = {p.row["shape"]: law.reason(p) for p in of}
    assert "10.00 times the log's" in text["quadratic"] and "deepest 5%" in text["two_stage"] and text["log_squared"].startswith("not explained")
    [light] = law.pairs([log, made("quadratic", rho=10.0, rho_p05=10.0, cond_end=900.0)])
    [below] = law.pairs([log, made("quadratic", rho=10.0, rho_p05=10.0, cond_end=5.0)])
    assert "as stiff when it bears nothing" in law.reason(light) and law.reason(below).startswith("not explained")
    masked = law.pairs([made("log", cond_end=1.5, nc_end=1.0), made("cubic")])[0]
    assert "does not make the log's" in law.reason(masked) and law.exceptions([masked]) == []
    assert law.scatter([p.error for p in of if p.row["shape"] == "cubic"]) is None
    mean, sd = law.scatter([0.0, 2.0])
    assert (mean, sd) == (1.0, pytest.approx(math.sqrt(2)))


def test_a_step_that_ends_without_contact_has_no_end_in_contact():
    """Its iterations count among those in contact, but none of them is an end."""

    def line(step, iteration, contacts, cond):
        sample = {"matrix": "clamped", "stage": "full", "scaling": "none", "status": "ok", "cond": cond}
        return {"step": step, "iteration": iteration, "contacts": {"obstacle": contacts}, "cond": [sample]}

    lines = [line(0, 0, 2, 10.0), line(0, 1, 2, 30.0), line(1, 0, 3, 500.0), line(1, 1, 0, 7.0)]
    found = measured.conditions(lines)
    assert found["cond_end"] == found["cond_end_max"] == 30.0 and found["cond_median"] == 30.0
    assert measured.conditions(lines[2:])["cond_end"] is None

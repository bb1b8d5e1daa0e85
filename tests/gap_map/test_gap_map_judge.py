"""What the rows of a gap map say, on made-up rows and traces whose answers are known by hand."""

import math

import pytest
from barrierbench_analysis.gap_map import judge, plan, report, rows
from barrierbench_analysis.gap_map.spec import Cell
from barrierbench_analysis.gap_map.table import Map


def made(shape="log", theta=0.1, gap=0.1, scene="s", resolution="1", limit="off", **more):
    found = dict.fromkeys(rows.COLUMNS) | {"scene": scene, "resolution": resolution, "shape": shape, "limit": limit, "theta": theta, "outcome": "ok", "gap": gap, "gap_p05": gap,
                                           "rho": 10.0, "rho_p05": 10.0, "load": 1.0, "unknowns": 100, "seconds": 1.0}
    return found | {m: 100.0 for m in rows.METRICS} | {"nc_end": 1.0, "nc_bj_end": 1.0} | more


def sample(cond, stage="full", scaling="none", status=None):
    return {"matrix": "clamped", "stage": stage, "scaling": scaling, "cond": cond, "status": status or ("singular" if cond is None else "ok")}


def test_the_reached_gap_is_the_load_weighted_median():
    one = [(1.0, [0.01, 0.1, 0.5])]
    assert rows.quantile_of_mixture(one, 0.5) == pytest.approx(0.1) and rows.quantile_of_mixture(one, 0.05) == pytest.approx(0.01)
    # nine parts of ten of the load rest at 0.2, whatever a light pair does
    assert rows.quantile_of_mixture([(0.9, [0.19, 0.2, 0.21]), (0.1, [0.001, 0.0011, 0.0012])], 0.5) == pytest.approx(0.2, rel=0.02)
    # half of the load in each of two pairs that share no gap; between 5% and 50% of a pair linear in the logarithm
    two = [(0.5, [0.01, 0.04, 0.1]), (0.5, [0.2, 0.3, 0.4])]
    assert rows.quantile_of_mixture(two, 0.25) == pytest.approx(0.04) and rows.quantile_of_mixture(two, 0.1375) == pytest.approx(0.02)
    assert rows.quantile_of_mixture([], 0.5) is None and rows.quantile_of_mixture([(0.0, [0.1, 0.2, 0.3])], 0.5) is None


def test_conditions_are_of_iterations_in_contact_and_of_the_last_ones_of_steps():
    def line(step, iteration, contacts, cond):
        return {"step": step, "iteration": iteration, "contacts": {"obstacle": contacts}, "cond": [sample(cond), sample(2.0, "without_contact")], "probe_pcg_iterations": cond / 10}

    found = rows.conditions([line(0, 0, 0, 9e9), line(1, 0, 3, 1000.0), line(1, 1, 3, 10.0), line(2, 0, 3, 30.0), line(3, 0, 4, 5e5), line(3, 1, 0, 1.0)])
    assert found["cond_end"] == 20.0 and found["cond_end_max"] == 30.0  # of steps 1 and 2: step 3 ends without contact
    assert found["cond_median"] == 515.0 and found["nc_end"] == 2.0 and found["bj_p95"] is None
    assert found["pcg"] == 51.5 and found["pcg_max"] == 5e4
    infinite = rows.conditions([{"step": 0, "iteration": 0, "contacts": {"obstacle": 1}, "cond": [sample(None)]}])
    assert infinite["cond_p95"] == rows.LARGEST and infinite["pcg"] is None and infinite["unknown"] == 0


@pytest.mark.parametrize("status, largest, unknown", [("singular", rows.LARGEST, 0), ("not_pd", rows.LARGEST, 0), ("not_converged", 10.0, 1), ("lower_bound", 10.0, 1)])
def test_an_estimate_without_a_number_is_no_condition_number(status, largest, unknown):
    """As the summary of the program counts."""
    line = {"step": 0, "iteration": 0, "contacts": {"obstacle": 1}, "cond": [sample(10.0), sample(None, status=status)]}
    found = rows.conditions([line])
    assert found["cond_end_max"] == largest and found["unknown"] == unknown
    alone = rows.conditions([line | {"cond": [sample(None, status="not_converged")]}])
    assert alone["cond_p95"] is None and alone["cond_end"] is None and alone["unknown"] == 1


def test_where_contact_rests_is_said_of_one_target_and_of_shared_places():
    """cubic reached more at 0.01 in a place that the log did not, and its softest gap is at another target."""
    every = [made("log", 0.01, 0.02, "a"), made("log", 0.01, None, "b", outcome="newton_stall"), made("log", 0.5, 0.001, "a"),
             made("cubic", 0.01, 0.3, "a"), made("cubic", 0.01, 0.1, "b"), made("two_stage", 0.01, None, "a", outcome="newton_stall"), made("two_stage", 0.5, 0.2, "a")]
    gaps, shared, without = judge.at_target(every, "off", 0.01, ["log", "cubic", "two_stage"])
    assert gaps == {"log": 0.02, "cubic": 0.3} and shared == [("a", "1")] and without == ["two_stage"]
    page = Map({"shapes": {s: [s, "gap"] for s in ("log", "cubic", "two_stage")}, "gaps": [0.5, 0.01], "limits": ["off"]}, every)
    said = report.sentences(page)[1]
    assert said.endswith("rests at 0.02 (`log`), 0.3 (`cubic`) (median of the 1 scenes and resolutions that all of these reached); without a gap there: `two_stage`.")


def test_where_nothing_rests_is_said():
    about = {"shapes": {s: [s, "gap"] for s in ("log", "cubic")}, "gaps": [0.5, 0.01], "limits": ["off"]}
    for rows_of in ([made("log", 0.5, 0.4), made("cubic", 0.5, 0.4)], [made("log", 0.01, 0.02, "a"), made("cubic", 0.01, 0.02, "b")]):
        assert report.sentences(Map(about, rows_of))[1].endswith("there is no place where every shape that reached a gap has one.")


def test_a_ratio_averages_resolutions_before_scenes():
    all_rows = []
    for scene, resolutions, factor in (("a", ("1", "2", "3"), 2.0), ("b", ("1",), 8.0)):
        for resolution in resolutions:
            for shape in ("log", "cubic"):
                all_rows += [made(shape, theta, gap, scene, resolution, cond_p95=100.0 * (factor if shape == "cubic" else 1.0)) for theta, gap in ((0.5, 0.5), (0.1, 0.1))]
    for found in (judge.ratio_at(all_rows, "off", "cubic", "cond_p95", 0.3), judge.at_theta(all_rows, "off", "cubic", "cond_p95", 0.1)):
        assert found.value == pytest.approx(4.0) and (found.low, found.high) == (pytest.approx(2.0), pytest.approx(8.0)) and (found.n, found.of) == (2, 2)


def test_nothing_is_filled_in_where_a_gap_was_not_reached():
    all_rows = [made("log", 0.5, 0.5), made("log", 0.01, 0.01), made("cubic", 0.5, 0.6), made("cubic", 0.01, 0.3)]
    assert judge.ratio_at(all_rows, "off", "cubic", "cond_p95", 0.4) is not None
    assert judge.ratio_at(all_rows, "off", "cubic", "cond_p95", 0.1) is None and judge.ratio_at(all_rows, "off", "cubic", "cond_p95", 0.55) is None
    assert judge.unreached(all_rows, [0.5, 0.1, 0.01]) == [("off", "cubic", 0.1), ("off", "cubic", 0.01)]
    assert judge.deepest(all_rows, "off", "cubic") == {("s", "1"): 0.3}
    broken = all_rows[:2] + [made("cubic", 0.5, 0.6), made("cubic", 0.1, 0.5, outcome="stall_overload"), made("cubic", 0.01, 0.3)]
    assert judge.ratio_at(broken, "off", "cubic", "cond_p95", 0.4) is None  # not across a run that failed
    assert judge.at_theta(broken, "off", "cubic", "cond_p95", 0.1) is None
    assert judge.failures(broken) == {("cubic", "off", 0.1): {"stall_overload": 1}}
    assert judge.failures([*broken, made("log", 0.25, None, "s", outcome="not run")]) == judge.failures(broken)  # no failure


def test_the_steps_of_a_line_leave_failed_scenes_out_and_say_so():
    all_rows = [made("log", 0.5, 0.4, scene, pcg=p) for scene, p in (("a", 20.0), ("b", 80.0))] + [made("log", 0.1, 0.1, "a", pcg=40.0), made("log", 0.1, None, "b", outcome="newton_stall")]
    first = {"a": 20.0, "b": 80.0}
    shallow, deep = judge.steps(all_rows, "off", "log", "pcg", lambda r: first[r["scene"]])
    assert (shallow.theta, shallow.gap, shallow.value, len(shallow.scenes)) == (0.5, pytest.approx(0.4), pytest.approx(1.0), 2)
    assert (deep.gap, deep.value, list(deep.scenes), deep.whole) == (pytest.approx(0.1), pytest.approx(2.0), ["a"], False)
    assert shallow.whole


def test_a_line_is_of_places_whose_whole_path_was_run():
    whole = [made("log", theta, theta, "a", pcg=20.0) for theta in (0.5, 0.1)]
    part = [made("log", 0.5, 0.5, "b", pcg=80.0), made("log", 0.1, None, "b", outcome="not run")]
    assert [list(s.scenes) for s in judge.steps([*whole, *part], "off", "log", "pcg", lambda r: 1.0)] == [["a"], ["a"]]
    assert [list(s.scenes) for s in judge.steps([*whole, part[0], made("log", 0.1, 0.1, "b", pcg=80.0)], "off", "log", "pcg", lambda r: 1.0)] == [["a", "b"], ["a", "b"]]


def test_the_law_is_the_ratio_of_rho_and_its_floor_what_is_left_without_contact():
    log = made("log", rho=100.0, cond_end=1000.0, nc_end=10.0)
    [both] = judge.pairs([log, made("cubic", rho=5.0, cond_end=60.0, nc_end=10.0)])
    assert both.predicted == pytest.approx(0.05) and both.measured == pytest.approx(0.06) and both.by_contact and both.error == pytest.approx(math.log(1.2))
    assert both.floored == pytest.approx(0.05)
    [soft] = judge.pairs([log, made("cubic", rho=0.1, cond_end=10.5, nc_end=10.0)])
    assert soft.by_log and not soft.by_contact and soft.floored == pytest.approx(0.01) and soft.floor_error == pytest.approx(math.log(1.05))
    [none] = judge.pairs([made("log", cond_end=20.0, nc_end=10.0), made("cubic", cond_end=60.0, nc_end=10.0)])
    assert not none.by_log and not none.by_contact
    assert judge.pairs([log, made("cubic", theta=0.01)]) == []  # other loads
    assert judge.pairs([log, made("cubic", outcome="stall_overload")]) == [] and judge.pairs([log, made("cubic", rho=-3.0)]) == []


def test_exceptions_are_those_of_the_log_by_contact_and_have_reasons():
    log = made("log", rho=100.0, rho_p05=100.0, cond_end=1000.0, nc_end=1.0)
    fine = made("cubic", rho=10.0, cond_end=150.0)
    loads = made("quadratic", rho=10.0, cond_end=1000.0, load=10.0)
    deep = made("two_stage", rho=10.0, rho_p05=50.0, cond_end=500.0)
    odd = made("log_squared", rho=10.0, rho_p05=10.0, cond_end=900.0)
    of = judge.pairs([log, fine, loads, deep, odd])
    assert {p.row["shape"] for p in judge.exceptions(of)} == {"quadratic", "two_stage", "log_squared"}
    text = {p.row["shape"]: judge.reason(p) for p in of}
    assert "10.00 times the log's" in text["quadratic"] and "deepest 5%" in text["two_stage"] and text["log_squared"].startswith("not explained")
    [light] = judge.pairs([log, made("quadratic", rho=10.0, rho_p05=10.0, cond_end=900.0)])
    [below] = judge.pairs([log, made("quadratic", rho=10.0, rho_p05=10.0, cond_end=5.0)])
    assert "as stiff when it bears nothing" in judge.reason(light) and judge.reason(below).startswith("not explained")
    masked = judge.pairs([made("log", cond_end=1.5, nc_end=1.0), made("cubic")])[0]
    assert "does not make the log's" in judge.reason(masked) and judge.exceptions([masked]) == []
    assert judge.scatter([p.error for p in of if p.row["shape"] == "cubic"]) is None
    mean, sd = judge.scatter([0.0, 2.0])
    assert (mean, sd) == (1.0, pytest.approx(math.sqrt(2)))


def test_a_plan_grows_with_the_unknowns_and_counts_what_is_there():
    cells = [Cell("a", r, "log", "off", t) for r in ("1", "2") for t in (0.5, 0.1)]
    timed = [made("log", 0.5, scene="a", resolution="1", unknowns=100, seconds=2.0), made("cubic", 0.5, scene="b", resolution="1", unknowns=1000, seconds=200.0)]
    found = plan.estimate(cells, timed, {("a", "1"): 100, ("a", "2"): 1000})
    assert found["a", "1"] == (2, 1, pytest.approx(2.0)) and found["a", "2"] == (2, 0, pytest.approx(400.0, rel=1e-6))  # seconds grow as the square here
    assert plan.growth([(100, 1.0), (200, 5.0)]) == plan.GROWTH
    assert plan.estimate(cells, [], {("a", "1"): 100, ("a", "2"): 1000})["a", "1"] == (2, 0, None)
    assert "nothing measured" in plan.lines(plan.estimate(cells, [], {}))[0]

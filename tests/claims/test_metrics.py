"""Every metric reads the number that it names: a record in which no two numbers are alike."""

import pytest

from barrierbench_analysis.studies.kit.metrics import FOLDER, METRICS

MATRICES = ("full/none", "full/block_jacobi", "without_contact/none", "without_contact_and_limit/none", "without_limit/none")


def record() -> dict:
    cond = {matrix: {"log10_cond": {"median": 1.0 + k, "p95": 5.0 + 0.125 * k, "max": 9.0 + 0.25 * k}} for k, matrix in enumerate(MATRICES)}
    return {"status": {"outcome": "ok", "valid": True},
            "config": {"strain_limit": {"onset": 0.06, "width": 0.02}, "time": {"dt_s": 0.5, "steps": 6}},
            "steps": [{"gap_min_rel": 0.31, "contact_load_sum_N": 61.0, "kinetic_J": 64.0}, {"gap_min_rel": 0.17, "contact_load_sum_N": 59.0, "kinetic_J": 46.0}],
            "summary": {"cond": cond, "probe_pcg": {"median": 37.0, "p95": 41.0}, "linear_per_solve": {"median": 43.0}, "newton_iterations": 20, "factorizations": 23,
                        "wall_s": 29.0, "time": {"contact_terms_s": 7.0}, "gap_min_rel": {"min": 0.11, "median": 0.13, "max": 0.19}, "max_stretch": 0.04}}


WANTED = {"cond_max": 1e9, "cond_p95": 1e5, "cond_median": 10.0, "cond_bj_p95": 10**5.125, "cond_bj_max": 10**9.25, "cond_bj_median": 100.0, "cond_no_contact_p95": 10**5.25,
          "cond_no_contact_no_limit_p95": 10**5.375, "pcg_probe": 37.0, "pcg_solve": 43.0, "newton": 20.0, "factorizations": 23.0, "seconds": 29.0, "contact_seconds": 0.35,
          "gap_min": 0.11, "gap_median": 0.13, "gap_end": 0.17, "load_end": 59.0, "slide_loss": 0.28125, "front_rate": None, "stretch": 0.04, "stretch_of_limit": 0.5, "climb_of_limit": None, "kappa_cycles": None, "bound_share": None, "stopped": 0.0,
          "unsettled": 0.0, "time_asked": 3.0, "residual_max": None, "short_of_time": 1.0, "without_residual": 1.0, "close_gap": 0.0, "failed_audit": 1.0, "not_valid": 0.0}


def test_every_metric_has_its_number():
    assert set(WANTED) == set(METRICS)
    found = {name: metric[3](record()) for name, metric in METRICS.items()}
    assert found == {name: None if value is None else pytest.approx(value) for name, value in WANTED.items()}


def row_of_blocks(touches: dict[str, int], n: int = 5) -> dict:
    out = record()
    out["config"]["scene"] = {"bodies": [{"name": name} for name in ["starter", *(f"block{k}" for k in range(n))]]}
    out["steps"] = [{"t_s": 0.25 * (k + 1)} for k in range(20)]
    out["summary"]["first_contact"] = touches
    return out


def test_a_front_is_as_fast_as_neighbours_touch():
    read = METRICS["front_rate"][3]
    whole = {"block0|block1": 3, "block1|block2": 5, "block2|block3": 7, "block3|block4": 11, "block0|block2": 1, "block4|floor": 0}
    assert read(row_of_blocks(whole)) == 3 / 2.0
    stopped = {name: step for name, step in whole.items() if name != "block3|block4"}
    assert read(row_of_blocks(stopped)) == 2 / 4.0  # until the end of the run, 5 s
    assert read(row_of_blocks({"block0|block1": 3})) is None
    failed = row_of_blocks(whole)
    failed["status"]["outcome"] = "newton_stall"
    assert read(failed) is None


def test_a_bound_counts_where_contact_stops_an_iteration(monkeypatch):
    lines = [{"alpha_ccd": 1.0}, {"alpha_ccd": 0.25}, {"alpha_ccd": 1e-6}, {"alpha_ccd": 1.0}, {"alpha_ccd": None}]
    monkeypatch.setattr("barrierbench_analysis.studies.kit.locking.read_trace", lambda record, folder: iter(lines))
    read = METRICS["bound_share"][3]
    assert read(record()) is None  # no folder, no trace
    assert read(record() | {FOLDER: "somewhere"}) == 0.5
    lines[1:3] = []
    assert read(record() | {FOLDER: "somewhere"}) == 0.0
    lines.clear()
    assert read(record() | {FOLDER: "somewhere"}) is None


@pytest.mark.parametrize("missing", ["onset", "width", "max_stretch"])
def test_a_share_of_the_limit_needs_all_three_numbers(missing):
    less = record()
    (less["summary"] if missing == "max_stretch" else less["config"]["strain_limit"]).pop(missing)
    assert METRICS["stretch_of_limit"][3](less) is None


def test_a_climb_has_shares_from_half_a_decade_on():
    share, base = METRICS["climb_of_limit"][3], record()
    for full, wanted in ((5.874, None), (5.876, pytest.approx(((5.25 - 5.375) + (5.876 - 5.5)) / 2 / (5.876 - 5.375)))):
        base["summary"]["cond"]["full/none"]["log10_cond"]["p95"] = full
        assert share(base) == wanted


@pytest.mark.parametrize("stage", ["full/none", "without_contact/none", "without_limit/none", "without_contact_and_limit/none"])
def test_one_order_alone_is_no_share(stage):
    base = record()
    base["summary"]["cond"]["full/none"]["log10_cond"]["p95"] = 7.0
    assert METRICS["climb_of_limit"][3](base) is not None
    del base["summary"]["cond"][stage]
    assert METRICS["climb_of_limit"][3](base) is None

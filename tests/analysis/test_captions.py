"""Captions say which series a setting is of."""

from barrierbench_analysis.figures.captions import caption

ROWS = [{"series": name, "dt_s": 0.01, "steps": 12, "d_hat_m": d_hat, "step_solver": "line_search"} for name, d_hat in (("log", 0.1), ("cubic", 0.2), ("quadratic", 0.3))]


def said(*rows) -> str:
    return " ".join(caption("shown", list(rows)).split())


def test_a_run_that_is_set_otherwise_is_named():
    text = said(*ROWS, ROWS[0] | {"series": "published", "steps": 13, "dt_min_s": 0.0076251234, "step_solver": "accumulated_toi"})
    assert "step_solver line_search, accumulated_toi (published)" in text and "steps 12, 13 (published)" in text and "dt_s 0.01;" in text


def test_settings_of_many_kinds_name_nobody():
    assert "d_hat_m 0.1, 0.2, 0.3;" in said(*ROWS)


def test_what_a_record_lacks_is_no_setting():
    assert "dt_min_s" not in said(*(row | {"dt_min_s": float("nan")} for row in ROWS)) and "nan" not in said(*(row | {"dt_min_s": float("nan")} for row in ROWS))

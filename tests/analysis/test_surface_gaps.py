"""The table of surface gaps: what is counted, and that a run that is called ok with a surface in an obstacle is reported."""

import json

import pytest

from barrierbench_analysis.tables import surface_gaps
from synthetic import bind, write_run


def _audit(obstacles=None, between=None, enabled=True):
    audit = {"enabled": enabled, "surface_gaps": 3, "obstacle_triangles": 6, "obstacle_edges": 0, "obstacle_vertices": 0}
    for name, value in (("surface_gap_obstacles_m", obstacles), ("surface_gap_between_m", between)):
        audit |= {name: value} if value is not None else {name: None, f"{name}_status": "none_within_d_hat"}
    return audit


def _write(folder, **runs):
    """Records that are whole, each with an outcome and an audit of its own."""
    for name, (outcome, audit) in runs.items():
        record = write_run(folder, "log", 1.0, 0.1, outcome=outcome, folder=name)
        record["audit"] |= audit
        (folder / name / "run.json").write_text(json.dumps(record))
        bind(folder / name)


def test_every_run_has_a_row_and_the_smallest_gap_is_that_of_the_ok_ones(tmp_path, capsys):
    _write(tmp_path, a=("ok", _audit(0.004, 0.001)), b=("penetration", _audit(-0.02)), c=("ok", _audit(enabled=False)))
    assert surface_gaps.main([str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert len(out.splitlines()) == 5
    assert "-20" in out and "not_audited" in out and "none_within_d_hat" in out
    assert "3 runs, 2 ok; 1 of the ok ones with a gap, 1 without" in out and "smallest is 1 mm; 0 below 0" in out


@pytest.mark.parametrize("gaps", [(-1e-6, None), (0.1, -1e-6), (None, -1e-6), (-1e-6, 0.1)])
def test_an_ok_run_in_an_obstacle_or_another_surface_is_told(tmp_path, capsys, gaps):
    _write(tmp_path, a=("ok", _audit(*gaps)), b=("ok", _audit(0.0, 0.0)))
    assert surface_gaps.main([str(tmp_path)]) == 1
    told = capsys.readouterr()
    assert "1 below 0" in told.out and str(tmp_path / "a") in told.err and str(tmp_path / "b") not in told.err


@pytest.mark.parametrize("runs", [{"a": ("ok", _audit(enabled=False))}, {"a": ("ok", _audit())}, {"a": ("newton_stall", _audit(0.1, 0.1))}])
def test_runs_of_which_none_was_judged_are_no_good_answer(tmp_path, capsys, runs):
    _write(tmp_path, **runs)
    assert surface_gaps.main([str(tmp_path)]) == 1
    assert "surface-gaps: no run that is ok has a measured gap: nothing was judged" in capsys.readouterr().err


def test_without_a_record_there_is_nothing_to_say(tmp_path, capsys):
    assert surface_gaps.main([str(tmp_path)]) == 2
    (tmp_path / "run.json").write_text("{")
    assert surface_gaps.main([str(tmp_path)]) == 2
    assert "not JSON" in capsys.readouterr().err

"""Further axes of a sweep, and the conditions that a part names."""

import json
import re

import pytest
from made import record, row

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims import judge as judging
from barrierbench_analysis.studies.claims.entry import ROOT, read_claim, read_sweep
from barrierbench_analysis.studies.claims.merged import WITHOUT_LIMIT, limit_of, theta_of
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.studies.claims.slices import rows_of, slice_of
from barrierbench_analysis.studies.claims.table import Runs, Table, collect, read, write

THETA, LIMIT, SEEDS = ({"pointer": "/matching/theta", "values": [0.1, 0.01]}, {"pointer": "/strain_limit/enabled", "values": [True, False]}, {"pointer": "/seeds/main", "values": [1, 2]})


def sweep(tmp_path, *axes, second=None, **top):
    (tmp_path / "sweeps").mkdir(exist_ok=True)
    (tmp_path / "base.json").write_text('{"schema": "barrierbench.config/1", "scene": {"name": "hang"}, "formulation": "log"}')
    cases = second or [{"label": "log", "set": {"/formulation/name": "log"}}, {"label": "cubic", "set": {"/formulation/name": "cubic"}}]
    data = {"name": "s", "base": "../base.json", "set": {"/matching/rule": "equal_force", **top},
            "axes": [{"cases": [{"label": "strip 4", "set": {"/scene": {"name": "drape2d", "n": 4}}}]}, {"cases": cases}, *axes]}
    (tmp_path / "sweeps/s.json").write_text(json.dumps(data))
    return read_sweep.__wrapped__("s", tmp_path)


PART = {"says": "x", "rule": "ratio", "sweep": "s", "metric": "newton", "case": "log", "over": "cubic", "above": 1}


def test_a_further_axis_is_part_of_the_place(tmp_path, program):
    import subprocess

    made = sweep(tmp_path, THETA, SEEDS)
    assert made.cases["s: strip 4 log theta=0.01 main=2"] == ("strip", "4", "log", 2) and made.more["s: strip 4 log theta=0.01 main=2"] == {"theta": 0.01}
    assert made.axes == {"theta": [0.1, 0.01]} and len(made.cases) == 8
    turned = sweep(tmp_path, SEEDS, LIMIT)
    assert turned.more["s: strip 4 cubic main=1 enabled=false"] == {"enabled": False}
    data = json.loads((tmp_path / "sweeps/s.json").read_text()) | {"schema": "barrierbench.sweep/1"}
    data["axes"].append(THETA)
    data["axes"][1]["cases"][0]["reference"] = True
    (tmp_path / "sweeps/s.json").write_text(json.dumps(data))
    done = subprocess.run([program, "sweep", str(tmp_path / "sweeps/s.json"), "--dry-run"], capture_output=True, text=True, check=False)
    assert "strip_4_log_main=1_enabled=true_theta=0.1-" in done.stdout, done.stderr  # the program's labels are these


def test_records_of_a_further_axis_become_rows(tmp_path):
    made = sweep(tmp_path, THETA, SEEDS)
    for k, (note, theta) in enumerate((("s: strip 4 log theta=0.1 main=1", 0.1), ("s: strip 4 log theta=0.01 main=1", 0.01))):
        record(tmp_path / "runs", made, note, str(k), started_utc=f"2026-12-0{3 - k}T00:00:00Z", ended_utc="2026-12-04T00:00:00Z")
    found = collect(made, tmp_path / "runs", ["newton"])
    assert [(r["scene"], r["theta"], r["newton"]) for r in found.rows] == [("strip", 0.01, 6), ("strip", 0.1, 6)] and found.about["first_started_utc"] == "2026-12-02T00:00:00Z"
    write(Table({"s": found}), tmp_path / "claims.jsonl")
    assert read(tmp_path / "claims.jsonl").sweeps["s"].rows == found.rows


@pytest.mark.parametrize("axes", [(THETA,), (SEEDS, SEEDS), (SEEDS, {"cases": [{"label": "a", "set": {}}]}), (SEEDS, {"pointer": "/x"})])
def test_axes_that_are_none(tmp_path, axes):
    with pytest.raises(UserError, match="axes: scenes with levels, cases, /seeds/main|an axis has cases, or a pointer and values"):
        sweep(tmp_path, *axes)


def test_a_name_is_of_one_folder(tmp_path):
    sweep(tmp_path, SEEDS)
    (tmp_path / "confirmation").mkdir()
    (tmp_path / "confirmation/s.json").write_text((tmp_path / "sweeps/s.json").read_text())
    with pytest.raises(UserError, match="confirmation/s.json: a sweep of this name is in claims/sweeps as well"):
        read_sweep.__wrapped__("s", tmp_path)


def rows(made):
    return Runs({}, [row(*place) | more for place, more in zip(made.cases.values(), made.more.values())])


def test_a_part_has_the_runs_of_its_slice(tmp_path):
    made = sweep(tmp_path, THETA, LIMIT, SEEDS)
    part = {**PART, "theta": 0.01, "limit": "off"}
    found = rows_of(part, rows(made), made).rows
    assert len(found) == 4 and {(r["theta"], r["enabled"]) for r in found} == {(0.01, False)}
    assert slice_of(part, made) == "theta 0.01, limit off"
    with pytest.raises(UserError, match="limit: found 'log'; the runs of cubic in .* have strip: 'cubic'"):  # of `over`, whose limit follows its contact
        slice_of({**part, "limit": "log", "theta": 0.1}, made)
    for bad, said in (({"limit": "off"}, "theta: found None; .* has 0.1, 0.01, and a part names one"), ({"theta": 0.5, "limit": "off"}, "theta: found 0.5"), ({"theta": 0.1}, "enabled: found None")):
        with pytest.raises(UserError, match=said):
            rows_of({**PART, **bad}, rows(made), made)


def test_a_verdict_is_of_its_slice(tmp_path, monkeypatch):
    made = sweep(tmp_path, THETA, SEEDS)
    monkeypatch.setattr(judging, "read_sweep", lambda name: made)
    found = Runs({}, [row(scene, level, case, seed, newton=(30.0 if case == "log" else 10.0) if theta == 0.01 else 10.0, theta=theta)
                      for scene in "abc" for level in "124" for case in ("log", "cubic") for theta in (0.1, 0.01) for seed in (1, 2)])
    for theta, verdict, value in ((0.01, "holds", 3), (0.1, "does not hold", 1)):
        judged = judging.judge_part({**PART, "theta": theta}, Table({"s": found}), Eval(None))
        assert (judged.verdict, judged.value) == (verdict, pytest.approx(value)) and judged.slice.startswith(f"theta {theta:g}; ")


def test_true_is_not_one(tmp_path):
    made = sweep(tmp_path, {"pointer": "/x/count", "values": [1, 2]}, SEEDS)
    with pytest.raises(UserError, match="count: found True"):
        rows_of({**PART, "count": True}, rows(made), made)


def test_a_slice_is_that_of_the_sweep_file(tmp_path):
    made = sweep(tmp_path, SEEDS, **{"/matching/theta": 0.3, "/strain_limit/shape": "log"})
    assert slice_of(PART, made) == "theta 0.3, limit log" and slice_of({**PART, "theta": 0.3, "limit": "log"}, made) == "theta 0.3, limit log"
    for bad, said in (({"theta": 0.1}, "theta: found 0.1; the runs of log .* have strip: 0.3"), ({"limit": "off"}, "limit: found 'off'; the runs of log .* have strip: 'log'")):
        with pytest.raises(UserError, match=said):
            slice_of({**PART, **bad}, made)
    dynamic = [{"label": "log", "set": {}}, {"label": "cubic", "set": {"/formulation": "cubic_dynamic", "/matching/rule": "as_given", "/strain_limit/enabled": False}}]
    assert slice_of(PART, sweep(tmp_path, SEEDS, second=dynamic)) == "log: theta 0.1, limit log; cubic: stiffness as given, limit off"
    paths = [{"label": f"{name} x{k}", "set": {"/formulation": name, "/strain_limit/enabled": False}} for name in ("log", "cubic") for k in (1, 10)]
    assert slice_of(PART, sweep(tmp_path, SEEDS, second=paths)) == "theta 0.1, limit off"


def test_bodies_without_a_limit_have_none():
    assert limit_of({"scene": {"name": "bodies"}, "formulation": "log"}) == "off" and limit_of({"scene": {"name": "bodies"}, "strain_limit": {"limit": 0.1}, "formulation": "cubic_dynamic"}) == "cubic"
    assert limit_of({"scene": {"name": "drape"}, "formulation": {"shape": "quadratic"}}) == "quadratic" and theta_of({"matching": {"rule": "as_given"}}) is None


def scenes_without_a_limit() -> set[str]:
    """As the program has them: `defaults` of a scene end with its limit or with nullopt."""
    texts = {path.stem: path.read_text() for path in (ROOT / "experiments/scenes").glob("*.cpp") if "scene.defaults = {" in path.read_text()}
    assert len(texts) >= 5
    return {name for name, text in texts.items() if re.search(r"scene\.defaults = \{[^}]*nullopt\}", text)} | {"bodies"}


def test_scenes_without_a_limit_of_their_own_are_those_of_the_program():
    assert set(WITHOUT_LIMIT) == scenes_without_a_limit()
    assert limit_of({"scene": {"name": "resting_block_1d"}, "strain_limit": {"shape": "log"}}) == "off"
    assert limit_of({"scene": {"name": "resting_block_1d"}, "strain_limit": {"shape": "log", "limit": 0.05}}) == "log"


def test_a_slice_is_that_of_every_scene_that_counts(tmp_path):
    made = sweep(tmp_path, SEEDS, **{"/strain_limit/shape": "log"})
    data = json.loads(made.path.read_text())
    for label, set_of in (("strip 6", {"/scene": {"name": "drape2d", "n": 6}}), ("block 1", {"/scene": {"name": "resting_block_1d"}}), ("far 1", {"/scene": {"name": "hang"}, "/matching/theta": 0.5})):
        data["axes"][0]["cases"].append({"label": label, "set": set_of})
    made.path.write_text(json.dumps(data))
    made = read_sweep.__wrapped__("s", tmp_path)
    assert slice_of(PART, made) == "theta 0.1 (far: theta 0.5), limit log (block: off)"
    assert slice_of({**PART, "scenes": ["block"]}, made) == "theta 0.1, limit off"
    for more, said in (({"limit": "log"}, "limit: found 'log'; .* have block: 'off'"), ({"theta": 0.1}, "theta: found 0.1; .* have far: 0.5")):
        with pytest.raises(UserError, match=said):
            slice_of({**PART, **more}, made)
    assert slice_of({**PART, "limit": "log", "theta": 0.1, "scenes": ["strip"]}, made) == "theta 0.1, limit log"


def test_every_part_prints_its_slice():
    found = {(claim, part["sweep"]): slice_of(part, read_sweep(part["sweep"])) for claim in ("K3", "H3", "K12") for part in read_claim(claim).deciding}
    assert found["K3", "contact_shapes"] == "theta 0.1, limit log (block, pile: off)" and found["H3", "derivative"] == "dropped: stiffness as given; cubic: theta 0.5; limit off"

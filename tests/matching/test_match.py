"""The verb `match`: verdicts and refusals on made-up records, and one run of the real program."""

import json
import shutil
from pathlib import Path

import pytest

from barrierbench_analysis.io.places import ROOT
from made_records import install

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.kit import runs as make_runs
from barrierbench_analysis.studies.kit.formulations import settings
from barrierbench_analysis.studies.matching.match import main, make_sweep

BLOCK = Path(__file__).resolve().parents[2] / "configs" / "scenes" / "resting_block_1d.json"


@pytest.fixture
def match(tmp_path):
    """match(*arguments) -> exit code; records below tmp_path/out."""
    return lambda *arguments: main([str(BLOCK), *arguments, "--out", str(tmp_path / "out")])


def answer(tmp_path) -> dict:
    return json.loads((tmp_path / "out" / "match.json").read_text())


def test_all_comparable(match, monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {"cubic": 0.15})
    assert match("--formulations", "cubic", "quadratic") == 0
    said, kept = capsys.readouterr().out, answer(tmp_path)
    assert [row["formulation"] for row in kept["formulations"]] == ["log", "cubic", "quadratic"]
    assert all(row["verdict"] == "comparable" for row in kept["formulations"]) and kept["max_gap_ratio"] == 2
    assert "load of pilot: sheet[1] at the end of step 3" in said and "50 N/m" in said and "400 N/m" in said and "0.15 d_hat" in said
    assert "farthest from log" in said and "x 1.5, cloth|floor" in said
    assert (kept["formulations"][1]["pair"], kept["formulations"][1]["pair_quantile"]) == ("cloth|floor", "gap_rel_p05")


@pytest.mark.parametrize("edit, why", [
    ({}, "comparable"),
    ({"/comparability/verdict": "not_comparable", "/comparability/reason": "smallest gap 0.3 d_hat, 3 times that of the reference"}, "3 times that of the reference"),
    ({"/comparability/verdict": "not_valid", "/comparability/reason": "the run is not valid: outcome stall_overload", "/status/outcome": "stall_overload"}, "outcome stall_overload"),
    ({"/comparability/verdict": "not_valid", "/comparability/reason": "the run is not valid: outcome penetration", "/status/outcome": "penetration"}, "outcome penetration"),
    ({"/audit/judged": 0}, "audit judged nothing"), ({"/audit/enabled": False}, "audit judged nothing")])
def test_one_that_is_not_comparable(match, monkeypatch, tmp_path, capsys, edit, why):
    install(tmp_path, monkeypatch, {}, {"cubic": edit})
    assert match("--formulations", "cubic") == (1 if edit else 0)
    assert why in capsys.readouterr().out
    assert answer(tmp_path)["formulations"][1]["verdict"] == ("not_comparable" if edit else "comparable")


@pytest.mark.parametrize("arguments, said", [
    (["--formulations", "cubci"], "formulation 'cubci': one of article_cubic, cubic"), (["--formulations", "cubci"], "did you mean 'cubic'?"),
    (["--theta", "1"], "--theta: found 1; a number in (0, 1)"),
    (["--formulations", "log"], "--formulations: found log alone; a formulation to compare with it is needed"), (["--formulations", "log", "log"], "found log alone")])
def test_bad_arguments(match, tmp_path, capsys, arguments, said):
    assert match(*arguments) == 2 and said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_scene_without_contact(match, monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {"log": None, "cubic": None})
    assert match("--formulations", "cubic") == 2
    assert "scene 'drape2d': no contact at the end of any step with log" in capsys.readouterr().err
    assert not (tmp_path / "out" / "match.json").exists()


def test_a_limit_that_is_not_there(match, monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {}, {"log": {"/matching/limit_load_N_per_m": None}, "cubic": {"/matching/limit_load_N_per_m": None}})
    assert match("--formulations", "cubic", "--vary", "limit") == 2
    assert "no strain limit acts in scene 'drape2d', so that nothing varies" in capsys.readouterr().err


def test_records_of_different_configs(match, monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {}, {"cubic": {"/config/time/dt_s": 0.02}})
    assert match("--formulations", "cubic") == 2
    assert "'match: log' and 'match: cubic' are not runs of the same config: /time/dt_s: 0.01 and 0.02" in capsys.readouterr().err


def test_a_number_that_is_none(match, monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {}, {"cubic": {"/comparability/gap_rel": float("nan")}})
    assert match("--formulations", "cubic") == 2
    assert "case2/run.json#/comparability/gap_rel: found nan; allowed: a finite number" in capsys.readouterr().err


def test_a_folder_with_runs_of_other_settings(match, monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {})
    assert match("--formulations", "cubic") == 0
    for k in (1, 2):
        (tmp_path / "out" / f"case{k}").rename(tmp_path / "out" / f"older{k}")
    assert match("--formulations", "quadratic", "cubic") == 2
    assert "a second record of 'match: log'" in capsys.readouterr().err


def test_a_changed_base_has_a_folder_of_its_own(monkeypatch, tmp_path, capsys):
    """What the sweep is made of: the base config, a mesh it names, a preset."""
    from barrierbench_analysis.studies.kit import formulations
    from barrierbench_analysis.studies.matching import match
    install(tmp_path, monkeypatch, {})
    presets = tmp_path / "presets"
    shutil.copytree(formulations.PRESETS, presets)
    monkeypatch.setattr(formulations, "PRESETS", presets)
    monkeypatch.setattr(match, "ROOT", tmp_path)
    config, under, mesh = tmp_path / "a.json", tmp_path / "under.json", tmp_path / "m.obj"
    mesh.write_text("v 0 0 0")
    under.write_text('{"schema": "barrierbench.config/1"}')

    def folders(steps):
        config.write_text(json.dumps({"schema": "barrierbench.config/1", "base": "under.json", "scene": {"name": "x", "bodies": [{"mesh": {"file": "m.obj"}}]}, "time": {"steps": steps}}))
        for old in tmp_path.glob("results/runs/match/*/case*"):
            shutil.rmtree(old)  # the stand-in makes every record anew
        assert main([str(config), "--formulations", "cubic"]) == 0, capsys.readouterr()
        return len(list((tmp_path / "results" / "runs" / "match").iterdir()))

    assert [folders(3), folders(3), folders(4), folders(3)] == [1, 1, 2, 2]
    mesh.write_text("v 1 0 0")
    assert folders(3) == 3
    cubic = presets / "cubic.json"
    cubic.write_text(cubic.read_text().replace("{", "{\n", 1) + " ")
    assert folders(3) == 4
    under.write_text('{"schema": "barrierbench.config/1", "threads": 1}')
    assert folders(3) == 5


def test_what_is_varied():
    both, contact, limit = (settings("cubic_dynamic_lagged", vary, scale=10.0) for vary in ("both", "contact", "limit"))
    policy = {"name": "elasticity_inclusive", "mass_term": "paper", "elastic_term": True, "refresh": "per_step"}
    assert both["/formulation"] == contact["/formulation"] == "cubic_dynamic_lagged" and limit["/formulation"] == "log"
    assert both["/strain_limit/stiffness_policy"] == limit["/strain_limit/stiffness_policy"] == policy
    assert (contact["/strain_limit/shape"], contact["/strain_limit/stiffness_policy"]) == ("log", {"name": "fixed"}) and limit["/strain_limit/shape"] == "cubic"
    scaled = {vary: [key for key in found if key.endswith("/scale")] for vary, found in (("both", both), ("contact", contact), ("limit", limit))}
    assert scaled == {"both": ["/formulation/stiffness_policy/scale", "/strain_limit/stiffness_policy/scale"], "contact": ["/formulation/stiffness_policy/scale"],
                      "limit": ["/strain_limit/stiffness_policy/scale"]}
    assert settings("ipc2020", "both")["/strain_limit/stiffness_policy"] == {"name": "fixed"}


def test_the_sweep_that_is_made(tmp_path):
    config = tmp_path / "a.json"
    config.write_text('{"schema": "barrierbench.config/1", "formulation": {"name": "quadratic", "d_hat_m": 0.02}}')
    data = json.loads(make_sweep(config, ["cubic", "log", "cubic"], "equal_curvature", 0.3, "both").text)
    assert [case["label"] for case in data["axes"][0]["cases"]] == ["log", "cubic"] and data["axes"][0]["cases"][0]["reference"] is True
    assert all(case["set"]["/formulation/d_hat_m"] == 0.02 for case in data["axes"][0]["cases"])
    assert data["set"]["/matching/rule"] == "equal_curvature" and data["set"]["/matching/theta"] == 0.3 and data["set"]["/passes/audit"] is True
    with pytest.raises(UserError, match="none.json: No such file"):
        make_sweep(tmp_path / "none.json", ["cubic"], "equal_force", 0.1, "both")
    config.write_text("[1]")
    with pytest.raises(UserError, match="a.json: not a JSON object"):
        make_sweep(config, ["cubic"], "equal_force", 0.1, "both")


def test_a_formula_and_a_file_are_formulations(tmp_path, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_CACHE", str(tmp_path / "cache"))
    config = tmp_path / "a.json"
    config.write_text('{"schema": "barrierbench.config/1"}')
    formula, file = "formula:-(d-d_hat)^2*log(d/d_hat)", str(ROOT / "examples/plugins/inverse.json")
    _, *cases = json.loads(make_sweep(config, [formula, file], "equal_force", 0.1, "both").text)["axes"][0]["cases"]
    assert [case["set"]["/formulation"]["shape"] for case in cases] == [formula, "inverse"]
    assert cases[0]["label"].startswith("formula-") and "/" not in cases[0]["label"] and cases[1]["label"] == "inverse"
    assert all(case["set"]["/formulation"]["stiffness_policy"] == case["set"]["/strain_limit/stiffness_policy"] == {"name": "fixed"} for case in cases)
    with pytest.raises(UserError, match="formula:d_hat - d"):
        make_sweep(config, ["formula:d_hat - d"], "equal_force", 0.1, "both")


def test_the_real_program(match, program, monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    few = ["--formulations", "two_stage", "cubic", "quadratic", "--set", "/time/steps=20"]
    assert match(*few) == 1, capsys.readouterr()
    rows = answer(tmp_path)["formulations"]
    assert [row["verdict"] for row in rows] == ["comparable", "comparable", "not_comparable", "not_comparable"], rows
    cubic, quadratic = rows[2:]  # the smallest gap of the cubic is near the log's, its wide ones are not; the quadratic's is four times the log's
    assert cubic["gap_ratio"] < 2 < cubic["pair_ratio"] and cubic["pair_quantile"] == "gap_rel_p95"
    assert quadratic["gap_ratio"] > 2 and quadratic["pair_ratio"] > 2
    assert all(0.05 < row["gap_min_rel"] < 1 and row["newton_iterations"] > 20 for row in rows)
    assert cubic["matching"]["kappa_N_per_m"] > 5 * rows[0]["matching"]["kappa_N_per_m"] > 0  # equal force at 0.1 d_hat, not equal kappa
    assert match(*few, "--set", "/scene/nn=3") == 2 and "found the unknown key" in capsys.readouterr().err
    assert match(*few, "--theta", "0.9", "--set", "/time/steps=2") == 2  # another sweep in the same folder


def test_the_inputs_of_overrides_are_inputs(tmp_path):
    """Another mesh under the name that an override gives is another run: its records are not taken for those of before."""
    base, mesh = tmp_path / "base.json", tmp_path / "body.obj"
    base.write_text('{"schema": "barrierbench.config/1"}')
    made, override = make_runs.sweep("match", base, {}, [{"label": "a", "set": {}}]), "/scene/bodies/0/mesh/file=body.obj"
    digests = []
    for text in ("v 0 0 0\n", "v 1 0 0\n"):
        mesh.write_text(text)
        digests.append((make_runs.inputs_sha256(made), make_runs.inputs_sha256(made, [override])))
    (plain, before), (plain_again, after) = digests
    assert plain == plain_again and before != after and before != plain

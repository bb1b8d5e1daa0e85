"""Files beside a sweep file that its runs are made from: base, presets, meshes. Records and numbers of others are none of the sweep."""

import json
import shutil

import pytest
from made import record

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims import inputs
from barrierbench_analysis.studies.claims import judge as judging
from barrierbench_analysis.studies.claims.entry import FOLDER, ROOT, ids, read_claim, read_sweep
from barrierbench_analysis.studies.claims.judge import missing
from barrierbench_analysis.studies.claims.merged import base_of, merged, put
from barrierbench_analysis.studies.claims.table import Runs, Table, collect
from barrierbench_analysis.studies.gate.cases import read_set
from barrierbench_analysis.studies.kit import formulations
from barrierbench_analysis.studies.kit.runs import Sweep as Made
from barrierbench_analysis.studies.kit.runs import inputs_sha256

NOTES = [f"s: strip {level} {case} main=1" for level in (4, 6) for case in ("log", "cubic")]


@pytest.fixture
def sweep(tmp_path):
    """Of two levels and two cases, with a base of its own and one mesh."""
    (tmp_path / "sweeps").mkdir()
    (tmp_path / "flag.obj").write_text("v 0 0 0\n")
    (tmp_path / "base.json").write_text(json.dumps({"schema": "barrierbench.config/1", "formulation": "log", "time": {"dt_s": 0.01}, "matching": {"theta": 0.1},
                                                    "scene": {"name": "bodies", "bodies": [{"mesh": {"file": "flag.obj"}}]}}))
    axes = [{"cases": [{"label": f"strip {n}", "set": {"/time/steps": n}} for n in (4, 6)]},
            {"cases": [{"label": name, "set": {"/formulation/name": name}} for name in ("log", "cubic")]}, {"pointer": "/seeds/main", "values": [1]}]
    (tmp_path / "sweeps/s.json").write_text(json.dumps({"name": "s", "base": "../base.json", "axes": axes}))
    return read_sweep.__wrapped__("s", tmp_path)


def edit(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def run(sweep, root):
    """Records as the program writes them: whole configs, meshes by content."""
    made = dict(inputs.asked(sweep))
    for k, note in enumerate(NOTES):
        record(root, sweep, note, str(k))
        path = root / str(k) / "run.json"
        body = json.loads(path.read_text())
        formulation = {"name": made[note]["formulation"]["name"], "stiffness_policy": {"name": "fixed", "scale": 1.0}} | {k: v for k, v in inputs.formulation_of(made[note]).items() if k in ("shape", "argument")}
        body["config"] = {**made[note], "formulation": formulation, "threads": 3, "integrator": {"name": "implicit_euler"}}
        body["scene"] |= {"mesh_sha256": dict.fromkeys(["../flag.obj"], next(iter(inputs._meshes(made[note], root.parent))))}
        path.write_text(json.dumps(body))
    shutil.copyfile(sweep.path, root / "sweep.json")
    return collect(sweep, root, ["newton"])


def test_records_of_these_inputs_count(sweep, tmp_path):
    made = run(sweep, tmp_path / "runs")
    assert len(made.rows) == len(sweep.cases) and made.about["inputs_sha256"] == inputs.inputs_of(sweep)


@pytest.mark.parametrize("file, old, new, said", [
    ("base.json", '"dt_s": 0.01', '"dt_s": 0.02', "/time/dt_s is 0.01, asked for is 0.02"), ("base.json", '"theta": 0.1', '"theta": 0.5', "/matching/theta is 0.1, asked for is 0.5"),
    ("flag.obj", "v 0", "v 1", "flag.obj has another content"), ("presets/cubic.json", '"shape": "cubic"', '"shape": "quadratic"', '/formulation/shape is "cubic", asked for is "quadratic"')])
def test_inputs_that_changed_after_the_runs(sweep, tmp_path, monkeypatch, capsys, file, old, new, said):
    """The records are none of the sweep, and neither are the numbers that were kept of them."""
    shutil.copytree(formulations.PRESETS, tmp_path / "presets")
    monkeypatch.setattr(formulations, "PRESETS", tmp_path / "presets")
    monkeypatch.setattr("barrierbench_analysis.studies.claims.merged.PRESETS", tmp_path / "presets")
    monkeypatch.setattr(judging, "read_sweep", lambda name: sweep)
    made, claim = run(sweep, tmp_path / "runs"), read_claim("K12")
    claim = type(claim)(*[getattr(claim, name) for name in ("id", "source", "sentence", "dimension", "guarantee", "kind")], parts=({"sweep": "s"},))
    assert missing(claim, Table({"s": made})) == []
    edit(tmp_path / file, old, new)
    assert "another base config, preset or mesh than claims/sweeps/s.json names now" in missing(claim, Table({"s": made}))[0]
    found = collect(sweep, tmp_path / "runs", ["newton"])
    left = 2 if "presets" in file else 0  # the log's runs are none of the cubic's preset
    assert len(found.rows) == left and f"of other inputs than claims/sweeps/s.json has now: {said}" in capsys.readouterr().err.replace(str(tmp_path) + "/", "")
    assert f"{4 - left} of 4 records of s are missing" in missing(claim, Table({"s": found}))[0]


def test_numbers_that_do_not_say_of_which_inputs_they_are(sweep, monkeypatch):
    monkeypatch.setattr(judging, "read_sweep", lambda name: sweep)
    claim = next(c for c in map(read_claim, ids()) if c.sweeps)
    found = missing(claim, Table({name: Runs({"sha256": sweep.sha256}, []) for name in claim.sweeps}))
    assert "do not say of which base config, presets and meshes they are: ./bench sweep" in found[0]


def test_a_preset_is_an_input_however_it_is_named(tmp_path, monkeypatch):
    shutil.copytree(formulations.PRESETS, tmp_path / "presets")
    monkeypatch.setattr(formulations, "PRESETS", tmp_path / "presets")
    for set_of in ({"/formulation": "cubic"}, {"/formulation/name": "cubic"}, {"/formulation": {"name": "cubic"}}):
        found = []
        for text in ("v1", "v2"):
            (tmp_path / "presets/cubic.json").write_text(text)
            data = {"base": str(ROOT / "configs/scenes/hang.json"), "axes": [{"cases": [{"label": "x", "set": set_of}]}]}
            found.append(inputs.inputs_sha256(inputs.Made("s", json.dumps(data), ())))
        assert found[0] != found[1], set_of
    axis = [{"base": str(ROOT / "configs/scenes/hang.json"), "axes": [{"pointer": "/formulation/name", "values": [name]}]} for name in ("cubic", "barely")]
    first, second = (inputs.inputs_sha256(inputs.Made("s", json.dumps(data), ())) for data in axis)
    assert first != second


def test_records_of_two_versions_whose_fields_mean_different_things(sweep, tmp_path):
    run(sweep, tmp_path / "runs")
    edit(tmp_path / "runs/0/run.json", '"version": "3.99.0"', '"version": "3.4.0"')
    with pytest.raises(UserError, match=r"runs: records of version 3.4.0 beside those of 3.99.0, in which comparability.verdict, .* ./bench sweep claims/sweeps/s.json"):
        collect(sweep, tmp_path / "runs", ["newton"])


def test_every_case_of_every_sweep_has_its_config():
    for name in [path.stem for kind in ("sweeps", "confirmation") for path in sorted((FOLDER / kind).glob("*.json")) if path.stem != "registry"]:
        assert dict(inputs.asked(read_sweep(name))).keys() == read_sweep(name).cases.keys(), name


def test_what_the_program_fills_in_is_no_contradiction():
    """Resolved configs that the program wrote, of the baselines, beside the files that they were made from."""
    seen = 0
    for case in read_set("small"):
        kept = json.loads((ROOT / f"results/baselines/{case.name}.json").read_text())["config"]
        config = json.loads(case.config.read_text())
        for pointer, value in case.set.items():
            put(config, pointer, value)
        assert inputs.contradiction({"config": kept}, config, case.config.parent) == "", case.name
        config.setdefault("time", {})["dt_s"] = 0.003
        assert inputs.contradiction({"config": kept}, config, case.config.parent) == "/time/dt_s is 0.01, asked for is 0.003"
        seen += 1
    assert seen >= 12


def test_a_method_is_an_input_and_lies_under_what_the_sweep_sets(tmp_path, monkeypatch):
    methods = tmp_path / "methods"
    methods.mkdir()
    monkeypatch.setattr("barrierbench_analysis.io.places.METHODS", methods)
    (methods / "m.json").write_text(json.dumps({"set": {"/formulation": {"name": "cubic"}, "/precision": "float", "/step_solver/name": "accumulated_toi", "/time/dt_s": 0.001}}))
    (tmp_path / "sweeps").mkdir()
    (tmp_path / "base.json").write_text(json.dumps({"formulation": "log", "time": {"dt_s": 0.01, "steps": 9}, "scene": {"name": "hang"}}))
    axes = [{"cases": [{"label": "strip 1", "set": {"/time/duration_s": 0.4}}]},
            {"cases": [{"label": "whole", "set": {"/method": "m"}}, {"label": "changed", "set": {"/precision": "double", "/method": "m"}}, {"label": "none", "set": {}}]},
            {"pointer": "/seeds/main", "values": [1]}]
    (tmp_path / "sweeps/s.json").write_text(json.dumps({"name": "s", "base": "../base.json", "axes": axes}))
    made = read_sweep.__wrapped__("s", tmp_path)
    whole, changed, none = (config for _, config in inputs.asked(made))
    assert whole["time"] == changed["time"] == {"dt_s": 0.001, "duration_s": 0.4} and none["time"] == {"dt_s": 0.01, "duration_s": 0.4}
    assert (whole["precision"], changed["precision"], whole["formulation"], none["formulation"]) == ("float", "double", {"name": "cubic"}, "log")
    assert made.solvers == {"whole": "accumulated_toi", "changed": "accumulated_toi"}
    before = inputs.inputs_of(made)
    edit(methods / "m.json", "0.001", "0.002")
    assert inputs.inputs_of(made) != before


def test_steps_and_a_duration_replace_each_other():
    data, path = {"base": "../../configs/scenes/hang.json"}, FOLDER / "sweeps/x.json"
    assert merged(data, path, {"/time/steps": 3}, {"/time/duration_s": 0.2})["time"] == {"duration_s": 0.2}
    assert merged(data, path, {"/time/duration_s": 0.2}, {"/time/steps": 3})["time"] == {"steps": 3}
    assert merged(data, path, {"/time/steps": 3}, {"/time/dt_s": 0.1})["time"] == {"steps": 3, "dt_s": 0.1}


def test_a_base_that_extends_another_is_in_the_hash_and_refused_as_a_config(tmp_path):
    """What the base extends is an input of the runs; what it is laid over nobody here works out."""
    parent, base = tmp_path / "parent.json", tmp_path / "base.json"
    base.write_text(json.dumps({"extends": "parent.json"}))
    data, hashes = {"base": str(base), "axes": []}, []
    for dt in (0.01, 0.02):
        parent.write_text(json.dumps({"time": {"dt_s": dt}}))
        hashes.append(inputs_sha256(Made("s", json.dumps(data), ())))
    assert hashes[0] != hashes[1]
    with pytest.raises(UserError, match="base.json: /extends: a config that stands alone"):
        base_of({"base": "base.json"}, tmp_path / "s.json")

"""A claim that calls itself confirmed: its rule, its sweeps and what these name, registered and unchanged."""

import copy
import inspect
import json
import subprocess
from dataclasses import replace

import pytest
from registered import CLAIM, FILE, NAME

from barrierbench_analysis.io import module_code
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.pages.claims import verb
from barrierbench_analysis.studies.claims import registry
from barrierbench_analysis.pages.claims import parts_file, report
from barrierbench_analysis.studies.claims.entry import read_claim, read_sweep
from barrierbench_analysis.studies.claims.inputs import inputs_of
from barrierbench_analysis.studies.claims.judge import judge
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.studies.claims.table import Table


def test_the_code_of_the_common_success_is_in_the_rule(repository, monkeypatch):
    rule = registry.rule_of(read_claim("K4"))
    assert len(rule["success"]) == 16 and "success" not in registry.rule_of(CLAIM)
    source = inspect.getsource(registry.success)
    monkeypatch.setattr(module_code.inspect, "getsource", lambda module: source.replace('"""Largest', '"""The largest') + "\n# a comment\n")
    assert registry.code_of(registry.success) == rule["success"]
    monkeypatch.setattr(module_code.inspect, "getsource", lambda module: source.replace('== "converged"', '!= "failed"'))
    assert registry.code_of(registry.success) != rule["success"]


def test_registered_committed_and_run(repository):
    assert repository.state(Table()).word == "-" and "not registered: ./bench study claims --register K12" in repository.state(Table()).why
    entry = repository.register()
    assert repository.state(Table()).word == "registered, not run"
    repository.commit()
    state = repository.state(repository.run())
    assert state.verified and f"registered {entry['date']} in " in state.why and "before the first run" in state.why
    assert "an earlier run" not in state.why
    part = entry["rule"]["parts"][0]
    assert part["sweep"] == NAME and part["above"] == 1 and "confirm" not in part and entry["rule"]["statistics"]["scenes"] == 3


def test_the_confirmed_verdict_is_that_of_the_confirmation_scenes(repository, monkeypatch):
    from barrierbench_analysis.studies.claims.table import FILE as KEPT
    from barrierbench_analysis.studies.claims.table import read

    repository.register()
    repository.commit()
    table = read(KEPT)
    table.sweeps |= repository.run().sweeps
    table.sweeps["hessian_modes"].about["inputs_sha256"] = inputs_of(read_sweep("hessian_modes"))
    monkeypatch.setattr(registry, "ROOT", repository.root)
    original = registry.state
    monkeypatch.setattr(registry, "state", lambda claim, table, entries: original(claim, table, entries, repository.root))
    answer = judge(CLAIM, table, Eval(None), repository.entries())
    assert answer.verdict.verdict == "not decided" and answer.confirmed.verdict == "holds" and answer.confirmed_parts[0].scenes == 10
    row = next(line for line in report.verdict_table([answer], Table()) if line.startswith("| [K12]"))
    assert "| not decided |" in row and "| holds |" in row
    table.sweeps |= repository.run(factor=0.5).sweeps
    answer = judge(CLAIM, table, Eval(None), repository.entries())
    assert answer.confirmed.verdict == "does not hold" and "| not decided | does not hold |" in report.markdown([answer], Table())
    of = {row["evidence"]: row for row in parts_file.rows([answer], Table()) if row["kind"] == "deciding"}
    assert of["confirmed"]["verdict"] == "does not hold" and of["confirmed"]["basis"].startswith("registered ") and of["exploratory"]["basis"].startswith("exploratory: ")


@pytest.mark.parametrize("edit, said", [
    (lambda part: part.update(above=0.9), "/parts/0/above: registered 1, now 0.9"),
    (lambda part: part.update(metric="seconds"), '/parts/0/metric: registered "newton", now "seconds"'),
    (lambda part: part["confirm"].update(scenes=["bar"]), '/parts/0/scenes: registered null, now ["bar"]')])
def test_a_rule_that_was_changed_after_its_runs_is_refused(repository, edit, said):
    repository.register()
    repository.commit()
    parts = copy.deepcopy(list(CLAIM.parts))
    edit(parts[0])
    state = repository.state(repository.run(), replace(CLAIM, parts=tuple(parts)))
    assert state.refused and state.why.startswith("claims/K12.json: the rule is another") and said in state.why and not state.verified


def test_what_decides_nothing_may_change(repository):
    repository.register()
    repository.commit()
    assert repository.state(repository.run(), replace(CLAIM, parts=CLAIM.parts[:1], note="other")).verified


def test_another_way_to_compute_verdicts_is_another_rule(repository, monkeypatch):
    repository.register()
    repository.commit()
    monkeypatch.setattr(registry, "STATISTICS", {**registry.STATISTICS, "interval": "bootstrap"})
    assert "/statistics/interval: registered" in repository.state(repository.run()).why


def test_another_way_to_read_a_metric_is_another_rule(repository, monkeypatch):
    repository.register()
    repository.commit()
    assert repository.state(repository.run()).verified
    meaning, unit, machine, _ = METRICS["newton"]
    monkeypatch.setitem(METRICS, "newton", (meaning, unit, machine, METRICS["factorizations"][3]))
    assert "the rule is another" in repository.state(repository.run()).why and "/metrics/newton: registered" in repository.state(repository.run()).why
    hashes = {registry.read_as(name) for name in METRICS if name != "newton"}
    assert len(hashes) == len(METRICS) - 1


def test_a_docstring_is_no_rule(monkeypatch):
    def hashed(text):
        monkeypatch.setattr(module_code.inspect, "getsource", lambda reader: text)
        return registry.read_as("newton")

    bare = hashed('def f(r):\n    return r["x"]')
    assert hashed('    def f(r):\n        """Of a record."""\n        return r["x"]  # x') == bare != hashed('def f(r):\n    return 2 * r["x"]')


def test_a_sweep_that_was_changed_is_refused(repository):
    repository.register()
    repository.commit()
    table, path = repository.run(), repository.root / f"claims/confirmation/{NAME}.json"
    path.write_text(path.read_text().replace('"steps": 15', '"steps": 14'))
    assert repository.state(table).refused and f"claims/confirmation/{NAME}.json: sha256" in repository.state(table).why


def test_a_base_config_that_was_changed_is_refused(repository):
    repository.register()
    repository.commit()
    table, base = repository.run(), repository.root / "configs/scenes/hang.json"
    assert repository.state(table).verified
    base.write_text(base.read_text().replace('"formulation"', '"time": {"dt_s": 0.002},\n  "formulation"'))
    state = repository.state(table)
    assert state.refused and f"claims/confirmation/{NAME}.json: base config, presets and meshes have sha256" in state.why and "registered" in state.why


def test_records_of_another_base_config_are_refused(repository):
    """The base is as registered again, but the runs were made between."""
    repository.register()
    repository.commit()
    base = repository.root / "configs/scenes/hang.json"
    kept = base.read_text()
    base.write_text(kept.replace('"hang"', '"hang", "n": 7'))
    table = repository.run()
    base.write_text(kept)
    assert repository.state(table).refused and "the records of shells_modes are of base config, presets and meshes" in repository.state(table).why
    del table.sweeps[NAME].about["inputs_sha256"]
    assert repository.state(table).refused and "sha256 unknown" in repository.state(table).why


def test_an_entry_without_its_inputs_is_refused(repository):
    repository.register()
    data = json.loads((repository.root / FILE).read_text())
    del data["claims"]["K12"]["inputs"]
    (repository.root / FILE).write_text(json.dumps(data))
    repository.commit()
    assert repository.state(repository.run()).refused and "the entry has none" in repository.state(repository.run()).why


def test_records_of_another_sweep_are_refused(repository):
    repository.register()
    repository.commit()
    table = repository.run()
    table.sweeps[NAME].about["sha256"] = "ab" * 32
    assert repository.state(table).refused and f"results/runs/claims/{NAME}/sweep.json: the records are of a sweep with sha256 abababababab" in repository.state(table).why
    table = repository.run()
    del table.sweeps[NAME].rows[3:]
    assert repository.state(table).word == "registered, 3 of 90 runs" and not repository.state(table).verified


def test_the_verb_runs_what_is_registered_and_no_more(monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr(verb, "run_sweep", lambda file, out, **_: asked.append(str(file)) or subprocess.CompletedProcess([], 0))
    monkeypatch.setattr(registry, "ready", lambda claim, entries: None)
    monkeypatch.setattr(registry, "read", lambda: {})
    verb.run_sweeps([CLAIM], tmp_path, [])
    monkeypatch.setattr(registry, "read", lambda: {"K12": {}})
    verb.run_sweeps([CLAIM], tmp_path, [])
    assert [word.rpartition("/")[2] for word in asked] == ["hessian_modes.json", "hessian_modes.json", "shells_modes.json"]


def test_a_registry_that_was_edited_by_hand(repository):
    repository.register()
    data = json.loads((repository.root / FILE).read_text())
    data["claims"]["K12"]["rule"]["parts"][0]["above"] = 0.5
    (repository.root / FILE).write_text(json.dumps(data))
    repository.commit()
    assert "its sha256 is not the rule_sha256 beside it" in repository.state(repository.run()).why
    (repository.root / FILE).write_text('{"schema": "x"}')
    with pytest.raises(UserError, match="barrierbench.confirmation/1"):
        repository.entries()


def test_what_cannot_be_registered(repository):
    with pytest.raises(UserError, match="shells_modes has been run .*: a rule is registered before the first run"):
        repository.register(table=repository.run())
    with pytest.raises(UserError, match="claims/K11.json: /parts: every deciding part that takes runs needs confirm.sweep"):
        repository.register(read_claim("K11"))
    half = [{key: value for key, value in part.items() if key != "confirm" or k} for k, part in enumerate(read_claim("K13").parts)]
    with pytest.raises(UserError, match="every deciding part that takes runs needs confirm.sweep"):
        repository.register(replace(read_claim("K13"), parts=tuple(half)))
    path = repository.root / f"claims/confirmation/{NAME}.json"
    data = json.loads(path.read_text())
    data["axes"][0]["cases"] = data["axes"][0]["cases"][:21]
    path.write_text(json.dumps(data))
    with pytest.raises(UserError, match="7 scenes; a confirmation has at least 8"):
        repository.register()
    assert not (repository.root / FILE).exists()
    assert registry.state(CLAIM, repository.run(), {}, repository.root).why == "not registered before shells_modes was run"


def test_the_verb_refuses_a_claim_that_calls_itself_confirmed(monkeypatch, capsys):
    entry = {"date": "2026-12-01", "rule": {"parts": [], "statistics": {}}, "sweeps": {}}
    entry["rule_sha256"] = registry.sha_of(entry["rule"])
    monkeypatch.setattr(registry, "read", lambda: {"K12": entry})
    monkeypatch.setattr(verb, "write_all", lambda table, asker: None)
    monkeypatch.setattr(verb, "missing", lambda claim, table: [])
    assert verb.main(["K12", "--no-run"]) == 2
    said = capsys.readouterr()
    assert "K12 calls itself confirmed and is not: claims/K12.json: the rule is another than the one registered on 2026-12-01" in said.err and "confirmed: refused" in said.out
    assert verb.main(["K2", "--no-run"]) == 0
    assert verb.main(["--register"]) == 2 and "--register needs the claims" in capsys.readouterr().err

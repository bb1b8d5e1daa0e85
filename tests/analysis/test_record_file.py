"""One reader judges record, trace and frames for every verb: what is damaged, of another run or no number is refused with file, place and value."""

import json
import shutil

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.tables import causes
from barrierbench_analysis import load
from barrierbench_analysis.figures.pictures import render, stills
from barrierbench_analysis.figures.plots import newton_steps
from barrierbench_analysis.figures.plots import verb as figures
from barrierbench_analysis.studies.gate import compare
from barrierbench_analysis.io.record_file import CHANGED, RecordError, bound_file, other_meanings, read_record, read_trace
from barrierbench_analysis.io.record_rule import RecordRule
from barrierbench_analysis.tables.run import Run
from synthetic import bind, write_run, write_set


def test_a_word_list_of_numbers_is_held_to():
    rule = RecordRule({"type": "object", "properties": {"a": {"type": "integer", "enum": [1, 2]}}})
    assert rule.fault({"a": 2}, True, True) == "" and rule.fault({"a": 7}, True, True) == "/a: found 7; allowed: 1, 2"


@pytest.mark.parametrize("depth", [600, 900, 5000])
def test_what_is_nested_too_deeply_is_refused(folder, depth):
    (folder / "run.json").write_text('{"schema": ' + "[" * depth + "]" * depth + "}")
    with pytest.raises(RecordError, match="run.json"):
        read_record(folder / "run.json")


def test_a_record_that_is_not_there_is_not_called_bad_json(tmp_path, capsys):
    with pytest.raises(RecordError, match=r"nope/run.json: not there; allowed: the run.json of a run"):
        Run(tmp_path / "nope")
    assert stills.main([str(tmp_path / "nope"), "--out", str(tmp_path / "a.png")]) == 2
    assert f"{tmp_path / 'nope/run.json'}: not there" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordError, match="file/run.json: Not a directory"):
        Run(tmp_path / "file")


@pytest.fixture
def folder(tmp_path):
    write_run(tmp_path, "log", 1.0, 0.1)
    return tmp_path / "log"


def edit(folder, change) -> None:
    path = folder / "run.json"
    record = json.loads(path.read_text())
    change(record)
    path.write_text(json.dumps(record))  # writes NaN as Python does


def without_trace_hash(record) -> None:
    """As records before version 3.4 are."""
    record["schema"]["version"] = "3.3.0"
    record["artifacts"] = []
    record["comparability"]["verdict"] = "comparable"


WRONG = [  # what is done to a record, the place that the refusal names, the value
    (lambda r: r["summary"].update(newton_iterations=float("nan")), "#/summary/newton_iterations", "nan"),
    (lambda r: r["steps"][1].update(gap_min_rel=float("inf")), "#/steps/1/gap_min_rel", "inf"),
    (lambda r: r.update(later={"x": float("nan")}), "#/later/x", "nan"),
    (lambda r: r["summary"].update(newton_iterations="many"), "#/summary/newton_iterations", '"many"'),
    (lambda r: r["summary"].update(newton_iterations=-3), "#/summary/newton_iterations", "-3"),
    (lambda r: r["summary"].update(probe_pcg=[1]), "#/summary/probe_pcg", "[1]"),
    (lambda r: r["steps"][2].update(newton_iterations=True), "#/steps/2/newton_iterations", "true"),
    (lambda r: r.update(steps={}), "#/steps", "{}"),
    (lambda r: r.pop("steps"), "#/steps", "not there"),
    (lambda r: r.pop("labels"), "#/labels", "not there"),
    (lambda r: r["labels"].pop("formulation"), "#/labels/formulation", "not there"),
    (lambda r: r.update(status=None), "#/status", "not there"),
    (lambda r: r.update(schema="3"), "#/schema", '"3"'),
    (lambda r: r["schema"].update(version="3"), "#/schema", '"3"'),
    (lambda r: r["artifacts"][0].update(sha256="no hash at all"), "trace.jsonl", "no hash at all"[:16]),
]


@pytest.mark.parametrize("change, place, value", WRONG, ids=[place + " " + value for _, place, value in WRONG])
def test_every_verb_refuses_a_wrong_record_and_says_where(folder, tmp_path, capsys, change, place, value):
    read_record(folder / "run.json")
    edit(folder, change)
    said = []
    for verb in (lambda: causes.main([str(folder)]), lambda: figures.main([str(tmp_path), str(tmp_path / "out")])):
        assert verb() == 2
        said.append(capsys.readouterr().err)
    with pytest.raises(RecordError) as error:
        load(tmp_path)
    said.append(str(error.value))
    if "trace" not in place:
        assert render.main([str(folder)]) == 2
        said.append(capsys.readouterr().err)
        with pytest.raises(UserError) as error:
            read_record(folder / "run.json")
        said.append(str(error.value))
    for text in said:
        assert str(folder) in text and place in text and value in text and "allowed" in text, text
    assert not (tmp_path / "out").exists()


def test_words_of_a_later_version_are_read_and_those_of_an_earlier_one_are_held_to_the_list(folder):
    edit(folder, lambda record: record["status"].update(outcome="melted"))
    assert read_record(folder / "run.json")["status"]["outcome"] == "melted"
    edit(folder, lambda record: record["schema"].update(version="3.0.0"))
    with pytest.raises(RecordError, match="#/status/outcome: found \"melted\"; allowed: .*newton_stall"):
        read_record(folder / "run.json")


@pytest.mark.parametrize("hashed", [True, False])
@pytest.mark.parametrize("kept", [0.5, 0.99, 0.0])
def test_a_part_of_a_trace_is_never_read_as_the_whole(folder, capsys, hashed, kept):
    if not hashed:
        edit(folder, without_trace_hash)
    assert len(read_trace(read_record(folder / "run.json"), folder)) == 6
    path = folder / "trace.jsonl"
    lines = path.read_text().splitlines(keepends=True)
    text = "".join(lines[:3]) if kept == 0.5 else "".join(lines)[: int(kept * len("".join(lines)))]
    path.write_text(text)

    with pytest.raises(RecordError, match="trace.jsonl: found .*; allowed: .*as the record beside it says|trace.jsonl: found .*Newton iteration"):
        read_trace(read_record(folder / "run.json"), folder)
    assert causes.main([str(folder)]) == 2
    assert figures.main([str(folder.parent)]) == 2
    assert compare.main([str(folder), str(folder)]) != 0
    assert "trace" in capsys.readouterr().err


def test_a_trace_of_another_run_and_one_that_is_named_and_gone_are_refused(tmp_path):
    write_set(tmp_path)
    for name in ("log", "cubic"):
        assert len(read_trace(read_record(tmp_path / name / "run.json"), tmp_path / name)) == 6
    shutil.copyfile(tmp_path / "cubic/trace.jsonl", tmp_path / "log/trace.jsonl")  # as many lines
    (tmp_path / "quadratic/trace.jsonl").unlink()
    edit(tmp_path / "cubic_dynamic", lambda record: record.update(artifacts=[]))

    found = load(tmp_path)
    assert list(found.runs["run"]) == ["cubic"]
    assert len(found.unreadable) == 3
    for name, why in (("log", "found sha256"), ("quadratic", "No such file"), ("cubic_dynamic", "names no trace")):
        assert any(f"{name}/trace.jsonl" in line and why in line for line in found.unreadable), (name, found.unreadable)


@pytest.mark.parametrize("version, bound", [("3.3.9", False), ("3.4.0", True), ("3.4.1", True), ("3.99.0", True)])
def test_from_version_3_4_on_a_trace_is_read_only_where_its_record_names_it(folder, version, bound):
    """A blank more in a line: the same iterations, so only the hash shows it."""
    edit(folder, lambda record: record["schema"].update(version=version))
    path = folder / "trace.jsonl"
    path.write_text(path.read_text().replace("{", "{ ", 1))
    if not bound:
        assert len(read_trace(read_record(folder / "run.json"), folder)) == 6
        return
    with pytest.raises(RecordError, match="trace.jsonl: found sha256"):
        read_trace(read_record(folder / "run.json"), folder)


@pytest.mark.parametrize("hashed", [True, False])
@pytest.mark.parametrize("change, said", [
    (lambda lines: [lines[0], json.dumps(json.loads(lines[1]) | {"contacts": {"total": float("nan")}}), *lines[2:]], r"trace.jsonl:2: /contacts/total is not finite"),
    (lambda lines: [*lines[:-1], lines[-1][:-9]], r"trace.jsonl: found 5 whole lines and a torn one; allowed: 6"),
    (lambda lines: lines[:-1], r"trace.jsonl: found 5 whole lines; allowed: 6, one for each Newton iteration"),
    (lambda lines: [*lines, lines[-1]], r"trace.jsonl: found 7 whole lines; allowed: 6")])
def test_a_hash_makes_no_trace_whole(folder, hashed, change, said):
    """The record names the very file, and still a line is torn, missing, or has a NaN or infinite number."""
    path = folder / "trace.jsonl"
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")
    bind(folder)
    if not hashed:
        edit(folder, without_trace_hash)
    with pytest.raises(RecordError, match=said):
        read_trace(read_record(folder / "run.json"), folder)


def test_a_file_that_the_record_does_not_name_is_none_of_the_run(folder):
    (folder / "frames").mkdir()
    (folder / "frames/start.ply").write_bytes(b"ply\n")
    record = read_record(folder / "run.json")
    with pytest.raises(RecordError, match="names no such file"):
        bound_file(record, folder, "frames/start.ply")
    assert bound_file(record, folder, "trace.jsonl") == folder / "trace.jsonl"
    bind(folder)
    assert bound_file(read_record(folder / "run.json"), folder, "trace.jsonl").is_file()


def test_fields_that_changed_their_meaning_are_those_between_two_versions():
    said = set(other_meanings("3.4.0", "3.5.0"))
    assert {"comparability.verdict", "trace contraction"} <= said and said == set(other_meanings("3.5.0", "3.4.0"))
    pairs, ends = set(other_meanings("3.5.2", "3.6.0")), set(other_meanings("3.6.0", "3.7.0"))
    assert {"summary.contacts", "trace contacts"} <= pairs and ends == {"steps[].end_error_m", "steps[].end_error_tolerances", "summary.end_error_tolerances"}
    later = set(other_meanings("3.5.2"))
    assert later == pairs | ends and not said & later and set(other_meanings("3.4.0")) == said | later
    assert not other_meanings("3.7.0", "3.99.0") and not other_meanings("3.3.0", "3.4.0") and set(other_meanings("3.3.0")) == said | later
    assert "smallest gap" in CHANGED["comparability.verdict"]["before"]


STEPS = {"schema": "barrierbench.steps/1", "config": {"scene": {"name": "drape"}, "formulation": {"shape": "log"}},
         "trials": [{"step": 0, "hessian": "blend", "status": "converged", "tolerance_m": 1e-6, "dx_inf_m": [1e-2, 1e-5]}]}


@pytest.mark.parametrize("change, place", [
    (lambda d: d.update(trials=[]), "#/trials"), (lambda d: d.update(trials={"a": 1}), "#/trials"), (lambda d: d.update(trials=[3]), "#/trials/0/step"),
    (lambda d: d.update(config=None), "#/config"), (lambda d: d["config"].pop("formulation"), "#/config"),
    (lambda d: d["trials"][0].update(dx_inf_m=[float("nan")]), "#/trials/0/dx_inf_m"), (lambda d: d["trials"][0].pop("dx_inf_m"), "#/trials/0/dx_inf_m"),
    (lambda d: d["trials"][0].update(hessian="other"), "#/trials/0/hessian"), (lambda d: d["trials"][0].update(step="1"), "#/trials/0/step"),
    (lambda d: d["trials"][0].update(tolerance_m=None), "#/trials/0/tolerance_m"), (lambda d: d.update(schema="x"), "schema: found 'x'")])
def test_figures_of_a_broken_steps_file_are_refused(tmp_path, capsys, change, place):
    data = json.loads(json.dumps(STEPS))
    path = tmp_path / "steps.json"
    path.write_text(json.dumps(data))
    assert newton_steps.read_steps(path)["trials"]
    change(data)
    path.write_text(json.dumps(data))
    assert figures.main([str(path)]) == 2
    said = capsys.readouterr().err
    assert str(path) in said and place in said and ("allowed" in said or "is needed" in said)


@pytest.mark.parametrize("text", ["", "{", "[]", b"\xff", '{"schema": "barrierbench.steps/1"}'])
def test_figures_of_a_torn_steps_file_are_refused(tmp_path, capsys, text):
    path = tmp_path / "steps.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert figures.main([str(path)]) == 2
    assert str(path) in capsys.readouterr().err

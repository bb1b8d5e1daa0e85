"""bench gate compare: which numbers differ, in which direction, and what cannot be compared."""

import json
import shutil

import pytest


@pytest.fixture
def pair(block, tmp_path):
    """pair(edit of the second record) -> two folders."""

    def make(edit=lambda record: None, trace=lambda text: text, name="pair"):
        folders = []
        for side in ("a", "b"):
            folder = tmp_path / name / side
            shutil.copytree(block, folder)
            folders.append(folder)
        path = folders[1] / "run.json"
        record = json.loads(path.read_text())
        edit(record)
        path.write_text(json.dumps(record))
        path = folders[1] / "trace.jsonl"
        path.write_text(trace(path.read_text()))
        return folders

    return make


def test_a_record_is_the_same_as_itself(gate, pair, capsys):
    assert gate("compare", *pair()) == 0
    assert "green" in capsys.readouterr().out


def test_a_worse_number_is_named_with_its_direction(gate, pair, capsys):
    def worse(record):
        record["summary"]["newton_iterations"] *= 2
        record["summary"]["cond"]["full/none"]["log10_cond"]["median"] += 1

    a, b = pair(worse)
    assert gate("compare", a, b) == 1
    lines = capsys.readouterr().out.splitlines()
    assert any("newton_iterations" in line and "FAIL" in line and "higher, +100%" in line for line in lines)
    assert any("log10_cond full/none median" in line and "higher, x 10" in line for line in lines)
    assert gate("compare", b, a) == 0  # fewer iterations and a lower condition number are no regression
    lines = capsys.readouterr().out.splitlines()
    assert any("log10_cond full/none median" in line and "better" in line and "lower, x 0.1" in line for line in lines)
    assert any("newton_iterations" in line and "better" in line and "lower, -50%" in line for line in lines)


def test_a_stage_that_the_reference_lacks_is_red_unless_the_records_are_of_other_configs(gate, pair, capsys):
    def stage(record):
        record["summary"]["cond"]["contact/none"] = record["summary"]["cond"]["full/none"]

    assert gate("compare", *pair(stage)) == 1
    assert any("log10_cond contact/none max" in line and "not in the reference" in line for line in capsys.readouterr().out.splitlines())

    def other(record):
        stage(record)
        record["config"]["time"]["dt_s"] = 0.005

    assert gate("compare", *pair(other, name="other"), "--different-configs") == 0


def test_one_build_has_one_state(gate, pair, capsys):
    assert gate("compare", *pair(lambda record: record["summary"].update(state_hash="0" * 64))) == 1
    assert "state_hash" in capsys.readouterr().out


def test_another_build_may_end_in_another_state(gate, pair):
    def other(record):
        record["summary"]["state_hash"], record["ids"]["build_id"] = "0" * 64, "1" * 64

    assert gate("compare", *pair(other)) == 0


def test_other_configs_are_listed_and_refused_unless_asked(gate, pair, capsys):
    folders = pair(lambda record: record["config"]["time"].update(dt_s=0.005))
    assert gate("compare", *folders) == 2
    said = capsys.readouterr()
    assert "/time/dt_s: 0.01 and 0.005" in said.err and "--different-configs" in said.err and said.out == ""
    assert gate("compare", *folders, "--different-configs") == 0
    assert "/time/dt_s: 0.01 and 0.005" in capsys.readouterr().out


def without_hash(record) -> None:
    """As a record of another program, or of an earlier version, which names no trace."""
    record["schema"]["version"] = "3.3.0"
    record["artifacts"] = [file for file in record["artifacts"] if file["kind"] != "trace"]


def test_a_trace_that_is_not_the_one_of_its_record_cannot_be_compared(gate, pair, capsys):
    for k, damage in enumerate((lambda text: text[:-30], lambda text: text.replace('{"step', '{step', 1), lambda text: text + text.splitlines()[0] + "\n")):
        assert gate("compare", *pair(trace=damage, name=f"pair{k}")) == 2
        said = capsys.readouterr().err
        assert "trace.jsonl: found sha256" in said and "as the record beside it says" in said


def test_a_torn_trace_without_a_hash_is_counted_and_no_reason_to_fail(gate, pair, capsys):
    assert gate("compare", *pair(without_hash, trace=lambda text: text[:-30])) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if "trace lines dropped" in line)
    assert " 1 " in line and "torn last line" in line


def test_a_bad_line_in_the_middle_of_a_trace_without_a_hash(gate, pair, capsys):
    assert gate("compare", *pair(without_hash, trace=lambda text: text.replace('{"step', '{step', 1))) == 2
    assert "trace.jsonl:1: not a JSON object" in capsys.readouterr().err


@pytest.mark.parametrize("edit, place", [
    (lambda record: record["summary"].update(newton_iterations=float("nan")), "/summary/newton_iterations: found nan"),
    (lambda record: record["steps"][3].update(kinetic_J=float("inf")), "/steps/3/kinetic_J: found inf"),
    (lambda record: record["summary"].update(gap_min_m=None, gap_min_m_status="nan"), "/summary/gap_min_m_status: nan"),
])
def test_a_number_that_is_none(gate, pair, capsys, edit, place):
    assert gate("compare", *pair(edit)) == 2
    assert place in capsys.readouterr().err


def test_another_schema_version(gate, pair, capsys):
    assert gate("compare", *pair(lambda record: record["schema"].update(version="9.0.0"))) == 2
    assert "allowed: barrierbench.run 3.x.y" in capsys.readouterr().err


def test_fields_that_mean_something_else_in_an_earlier_version_are_named_and_compared_with_nothing(gate, pair, capsys):
    a, b = pair(lambda record: record["schema"].update(version="3.4.0"))
    for sides in ((a, b), (b, a)):
        assert gate("compare", *sides) == 0
        line = next(line for line in capsys.readouterr().out.splitlines() if " meanings " in line)
        assert "not_judged" in line and "3.4.0" in line and "comparability.verdict" in line and "trace contraction" in line
    for same in ((a, a), (b, b)):  # between two records of one version nothing means anything else
        assert gate("compare", *same) == 0 and " meanings " not in capsys.readouterr().out


def test_a_gate_says_what_an_earlier_record_means_otherwise(gate, pair, tmp_path, capsys):
    a, b = pair(lambda record: record["schema"].update(version="3.4.0"))
    kept = tmp_path / "kept.json"
    assert gate("accept", "--record", a / "run.json", "--baseline", kept, "--reason", "a test") == 0
    for record, said in ((a, False), (b, True)):
        capsys.readouterr()
        assert gate("gate", "--record", record / "run.json", "--baseline", kept, "--out", tmp_path / "gate") == 0
        shown = capsys.readouterr().out
        assert (" meanings " in shown and "comparability.verdict" in shown) == said, shown


def test_a_record_of_another_program_has_no_such_fields(gate, pair, capsys):
    def foreign(record):
        record["schema"]["version"] = "3.2.0"
        for section in ("comparability", "audit", "artifacts"):
            del record[section]

    a, b = pair(foreign)
    (b / "trace.jsonl").unlink()
    assert gate("compare", b, b) in (0, 1) and " meanings " not in capsys.readouterr().out


def test_a_record_without_numbers_is_no_green_one(gate, pair):
    def strip(record):
        record["summary"], record["steps"] = {}, []

    a, b = pair(strip)
    assert gate("compare", a, b) == 1
    shutil.copy(b / "run.json", a / "run.json")
    assert gate("compare", a, b) == 1  # nothing of class III was judged


def test_folders(gate, pair, tmp_path, capsys):
    a, b = pair()
    for side, folder in (("left", a), ("right", b)):
        for name in ("one", "two"):
            shutil.copytree(folder, tmp_path / side / name)
    assert gate("compare", tmp_path / "left", tmp_path / "right") == 0
    shutil.rmtree(tmp_path / "right" / "two")
    shutil.copytree(b, tmp_path / "right" / "three")
    capsys.readouterr()
    assert gate("compare", tmp_path / "left", tmp_path / "right") == 2
    said = capsys.readouterr().err
    assert "two: only in" in said and "three: only in" in said
    assert gate("compare", tmp_path / "left", tmp_path / "right", "--common") == 0
    assert gate("compare", tmp_path / "nowhere", b) == 2

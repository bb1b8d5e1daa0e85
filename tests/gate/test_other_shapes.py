"""Records and baselines of another shape are refused with exit code 2: 1 reads as a regression, and a traceback ends with 1 too."""

import copy
import json
import subprocess
import sys
from pathlib import Path

import pytest

from barrierbench_analysis.studies.gate import accept, compare, gate

ROOT = Path(__file__).resolve().parents[2]
ABSENT = object()
VALUES = ("x", -1.5, [], {"a": {}}, ABSENT)


def places(value, above=(), depth=5):
    """Of a JSON document, and of the first item of its lists."""
    items = value.items() if isinstance(value, dict) else enumerate(value[:1]) if isinstance(value, list) else ()
    for key, below in items if depth else ():
        yield above + (key,)
        yield from places(below, above + (key,), depth - 1)


def changed(document: dict, place: tuple, value) -> str:
    made = copy.deepcopy(document)
    node = made
    for key in place[:-1]:
        node = node[key]
    if value is ABSENT:
        del node[place[-1]]
    else:
        node[place[-1]] = value
    return json.dumps(made)


@pytest.fixture(scope="module")
def kept(tmp_path_factory) -> Path:
    """A folder with the record of the toy solver and its baseline."""
    folder = tmp_path_factory.mktemp("toy")
    subprocess.run([sys.executable, ROOT / "examples/ci/toy_solver.py", "--record", folder / "run.json"], check=True, capture_output=True)
    assert accept.main(["--record", str(folder / "run.json"), "--baseline", str(folder / "b.json"), "--reason", "x"]) == 0
    return folder


def codes(verb, *words) -> int:
    return verb.main([str(word) for word in words])


def test_records_of_another_shape(kept, tmp_path, capsys):
    record, made, seen = json.loads((kept / "run.json").read_text()), tmp_path / "m.json", set()
    for place in places(record):
        for value in VALUES:
            made.write_text(changed(record, place, value))
            found = (codes(compare, made, kept / "run.json"), codes(compare, kept / "run.json", made), codes(gate, "--record", made, "--baseline", kept / "b.json", "--out", tmp_path),
                     codes(accept, "--record", made, "--baseline", tmp_path / "new.json", "--reason", "x"))
            (tmp_path / "new.json").unlink(missing_ok=True)
            assert set(found) <= {0, 1, 2}, (place, value)
            seen.update(found)
            said = capsys.readouterr()
            assert "Traceback" not in said.err and (2 not in found or said.err.strip())
    assert seen == {0, 1, 2}
    made.write_text(changed(record, ("summary", "cond"), "x"))
    assert codes(compare, made, kept / "run.json") == 2 and 'm.json#/summary/cond: found "x"; allowed: object' in capsys.readouterr().err


def test_baselines_of_another_shape(kept, tmp_path, capsys):
    baseline, made = json.loads((kept / "b.json").read_text()), tmp_path / "b.json"
    for place in places(baseline):
        for value in VALUES:
            made.write_text(changed(baseline, place, value))
            assert codes(gate, "--record", kept / "run.json", "--baseline", made, "--out", tmp_path) in (0, 1, 2), (place, value)
            assert codes(accept, "--record", kept / "run.json", "--baseline", made, "--reason", "x") in (0, 1, 2), (place, value)
            capsys.readouterr()
    made.write_text(changed(baseline, ("scene",), "x"))
    assert codes(gate, "--record", kept / "run.json", "--baseline", made) == 2 and "b.json#/scene: found 'x'; type object is needed" in capsys.readouterr().err


def test_records_without_a_config_are_not_compared(kept, tmp_path, capsys):
    """Nothing says that they are runs of one configuration."""
    record = json.loads((kept / "run.json").read_text())
    del record["config"]
    for name in ("a", "b"):
        (tmp_path / f"{name}.json").write_text(json.dumps(record))
    assert codes(compare, tmp_path / "a.json", tmp_path / "b.json") == 2 and "no config" in capsys.readouterr().err
    assert codes(compare, kept / "run.json", tmp_path / "b.json") == 2
    assert codes(compare, tmp_path / "a.json", tmp_path / "b.json", "--different-configs") == 0

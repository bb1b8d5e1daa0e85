"""What the tests of gates share: the program, and stand-ins for it that have a defect."""

import json
import sys
from pathlib import Path

import pytest

# Runs the real program with settings that a defect of the code would amount to, then writes what was requested into the record: to the gate it
# is the same config, and only the numbers can give the defect away.
STAND_IN = """#!{python}
import hashlib, json, os, subprocess, sys
from pathlib import Path
program, defects, edit = {program!r}, {defects!r}, {edit!r}
arguments = sys.argv[1:]
if "--out" not in arguments or "/output/checkpoint_every=1" in arguments:  # validity; a run that is killed and resumed
    os.execv(program, [program, *arguments])
out = Path(arguments[arguments.index("--out") + 1])
honest = subprocess.run([program, *arguments], capture_output=True, text=True)
if honest.returncode != 0:
    sys.exit(honest.stderr)
asked = json.loads((out / "run.json").read_text())
for pointer, value in defects.items():
    arguments += ["--set", pointer + "=" + json.dumps(value)]
done = subprocess.run([program, *arguments], capture_output=True, text=True)
if done.returncode != 0:
    sys.exit(done.stderr)
record = json.loads((out / "run.json").read_text())
record["config"], record["ids"], record["passes"] = asked["config"], asked["ids"], asked["passes"]
for pointer, value in edit.items():
    place = record
    *sections, last = pointer.strip("/").split("/")
    for section in sections:
        place = place[section.replace("~1", "/")]
    place[last] = value
(out / "run.json").write_text(json.dumps(record))
"""


@pytest.fixture
def gate(program, monkeypatch, tmp_path):
    """Calls a verb of the gate on the real program, in this process: gate(verb, *arguments) -> exit code."""
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)

    def call(verb: str, *arguments) -> int:
        from barrierbench_analysis.studies.gate import accept, calibrate, compare, gate, trend

        verbs = {"accept": accept, "calibrate": calibrate, "compare": compare, "gate": gate, "trend": trend}
        more = ["--out", str(tmp_path / "gate")] if verb == "gate" and "--out" not in arguments else []
        return verbs[verb].main([*map(str, arguments), *more])

    return call


@pytest.fixture
def defective(program, monkeypatch, tmp_path):
    """defective(settings, edit): from now on the program has a defect that acts like these settings, or leaves its record like that."""

    def install(defects: dict, edit: dict | None = None) -> None:
        path = tmp_path / "program-with-a-defect"
        path.write_text(STAND_IN.format(python=sys.executable, program=program, defects=defects, edit=edit or {}))
        path.chmod(0o755)
        monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(path))

    return install


@pytest.fixture
def seeds(build_folder) -> range:
    """Of 20 clean repetitions, none of them a seed of a calibration; 3 where sanitizers make the program ten times as slow."""
    return range(301, 304 if build_folder.name == "sanitize" else 321)


@pytest.fixture
def answer(tmp_path):
    """What the last call of the gate wrote."""
    return lambda: json.loads((tmp_path / "gate" / "gate.json").read_text())


@pytest.fixture(scope="session")
def block(program, tmp_path_factory) -> Path:
    """The folder of one honest run of the block, to be copied and edited."""
    from barrierbench_analysis.studies.gate import cases

    out = tmp_path_factory.mktemp("gate") / "block"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BARRIERBENCH_PROGRAM", program)
        case = next(case for case in cases.read_set("small") if case.name == "block-log")
        run = cases.run_case(case, out)
    assert run.record["status"]["outcome"] == "ok" and len(run.trace) > 50
    return out

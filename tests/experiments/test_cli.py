"""The program as a user meets it: verbs, exit codes, messages, and what is left in the output folder.

Exit codes: 0 a record was written or the question answered, 2 anything wrong before the first step, 75 try again.
"""

import json
import os
import resource
import signal
import subprocess
from pathlib import Path

import jsonschema
import pytest
from processes import started, wait_until

ROOT = Path(__file__).resolve().parents[2]
BLOCK = str(ROOT / "configs/scenes/resting_block_1d.json")
VERBS = ["run", "sweep", "check", "explain", "list", "eval"]
GRID = {"generator": "grid", "n_x": 2, "n_y": 2}


def bench(program: str, *arguments, **options) -> subprocess.CompletedProcess:
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=60, **options)


def write(path: Path, content) -> Path:
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def bodies(tmp_path: Path, mesh: dict, **more) -> Path:
    """A config of one falling body."""
    return write(tmp_path / "bodies.json", {
        "schema": "barrierbench.config/1",
        "scene": {"bodies": [{"name": "cloth", "mesh": mesh}]},
        "formulation": {"name": "log", "d_hat_m": 0.01},
        "time": {"dt_s": 0.01, "steps": 1}, **more})


def sweep_spec(tmp_path: Path, steps) -> Path:
    return write(tmp_path / "sweep.json", {
        "schema": "barrierbench.sweep/1", "name": "steps", "base": BLOCK,
        "axes": [{"pointer": "/time/steps", "values": steps}]})


def refused(done: subprocess.CompletedProcess, *parts: str, code: int = 2) -> None:
    """Ended with the code, with the reason on stderr and nothing on stdout."""
    assert done.returncode == code, (done.returncode, done.stdout, done.stderr)
    for part in parts:
        assert part in done.stderr
    assert "internal" not in done.stderr and done.stdout == ""


# --- help and names


@pytest.mark.parametrize("verb", VERBS)
def test_help_has_an_example(program, verb):
    done = bench(program, verb, "--help")
    assert done.returncode == 0 and done.stderr == ""
    assert "example: " in done.stdout and f"bench {verb}" in done.stdout
    assert "--plugin" in done.stdout and "--progress" in done.stdout


def test_the_help_of_sweep_shows_both_kinds_of_axes(program):
    text = bench(program, "sweep", "--help").stdout
    assert '{"pointer": "/time/dt_s", "values": [0.01, 0.005]}' in text
    assert '{"cases": [{"label": "log"' in text and "sweep.schema.json" in text


def test_the_sweep_of_the_help_runs(program, tmp_path):
    text = bench(program, "sweep", "--help").stdout
    spec = json.loads(text[text.index("{\n"):text.index("\n}\n") + 2])
    spec["base"] = str(ROOT / "configs/scenes/drape.json")
    planned = bench(program, "sweep", write(tmp_path / "sweep.json", spec), "--dry-run")
    assert planned.returncode == 0, planned.stderr
    assert len(planned.stdout.splitlines()) == 4


@pytest.mark.parametrize(("word", "verb"), [("runn", "run"), ("swep", "sweep"), ("explian", "explain")])
def test_a_mistyped_verb_gets_the_nearest(program, word, verb):
    refused(bench(program, word, BLOCK), f"did you mean {verb}?", word)
    refused(bench(program, "--progress", "none", word, BLOCK), f"did you mean {verb}?")


@pytest.mark.parametrize("words", [["figure"], ["-h", "figure"], ["help", "figure"]])
def test_a_word_that_is_no_verb_gets_the_verbs_of_the_front_door_once(program, words):
    done = bench(program, *words, env={**os.environ, "BENCH_VERBS": "figures render run"})
    refused(done, "figures, render, run", "did you mean figures?")
    assert "meshes" not in done.stderr and done.stderr.count("run") == 1


@pytest.mark.parametrize("arguments", [[], ["rnu", BLOCK], ["run"], ["run", BLOCK, "--sett", "/time/steps=1"],
                                       ["--progress", "loud", "run", BLOCK], ["list", "shaps"]])
def test_a_command_line_that_means_nothing(program, arguments):
    refused(bench(program, *arguments))


def test_list_names_what_configs_may_name(program):
    done = bench(program, "list")
    assert done.returncode == 0
    for name in ("log", "two_stage", "exponential", "minimax", "minimax_bounded", "elasticity_inclusive", "bdf2", "line_search", "drape2d", "cubic_dynamic_lagged"):
        assert name in done.stdout
    shapes = bench(program, "list", "shapes").stdout
    assert "cubic" in shapes and "drape2d" not in shapes


@pytest.mark.parametrize(("section", "parts"), [
    ("generators", ["icosphere", "radius_m             0.5 m            a number >= 1e-15 and <= 1e+15 (m)", "closed               true             true or false", "vertices along x"]),
    ("scenes", ["start_gap_d_hat      1.2 d_hat        a number >= 1e-36 and <= 1e+18 (d_hat)", "a number >= 1e-36 and <= 1000000 (d_hat)",
                "/time/dt_s 0.01 s, /time/steps 100, /formulation/d_hat_m 0.005 m, /strain_limit/limit 0.02", "bodies"]),
])
def test_list_shows_parameters_with_defaults_units_and_ranges(program, section, parts):
    text = bench(program, "list", section).stdout
    for part in parts:
        assert part in text
    assert text.splitlines()[1:] and set(text.splitlines()) <= set(bench(program, "list").stdout.splitlines())


def test_explain_shows_every_setting_and_who_gave_it(program):
    text = bench(program, "explain", BLOCK, "--set", "/time/dt_s=0.005").stdout
    settings = {line[4:].split()[0]: line for line in text.splitlines() if line[4:5] == "/"}
    assert settings["/time/dt_s"].split() == ["*", "/time/dt_s", "0.005"]
    assert settings["/scene/name"].startswith("  *")
    assert settings["/step_solver/armijo"].split() == ["/step_solver/armijo", "0.0001"]
    assert settings["/formulation/shape"].split() == ["/formulation/shape", '"log"'] and len(settings) > 40


def test_answers_that_nobody_can_read(program):
    with open("/dev/full", "w") as full:
        done = subprocess.run([program, "list"], stdout=full, stderr=subprocess.PIPE, text=True, check=False, timeout=60)
    assert done.returncode == 75 and "standard output" in done.stderr


# --- configs


@pytest.mark.parametrize("verb", ["run", "check", "explain"])
@pytest.mark.parametrize("override, pointer, suggestion", [
    ("/scene/name=resting_blok_1d", "#/scene/name", "did you mean resting_block_1d?"),
    ("/formulation=cubicc", "#/formulation/name", "did you mean cubic?"),
    ("/time/stepz=3", "#/time/stepz", "did you mean steps?"),
    ("/time/dt_s=-1", "#/time/dt_s", "a number >= 1e-18 and <= 1e+09 (s)"),
])
def test_a_wrong_config_is_refused_before_anything_is_written(program, tmp_path, verb, override, pointer, suggestion):
    out = ["--out", tmp_path / "out"] if verb == "run" else []
    refused(bench(program, verb, BLOCK, "--set", override, *out), BLOCK + pointer, suggestion)
    assert not (tmp_path / "out").exists()


def test_what_a_config_extends_is_no_setting(program, tmp_path):
    """It is read before the settings: as one of them it would say nothing."""
    other = write(tmp_path / "other.json", {"schema": "barrierbench.config/1", "time": {"steps": 7}})
    refused(bench(program, "check", BLOCK, "--set", f'/extends="{other}"'), "/extends", "stands in its file")
    axis = {"cases": [{"label": "a", "set": {"/extends": str(other)}}, {"label": "b", "set": {"/time/steps": 2}}]}
    spec = write(tmp_path / "sweep.json", {"schema": "barrierbench.sweep/1", "name": "x", "base": BLOCK, "axes": [axis]})
    refused(bench(program, "sweep", spec, "--out", tmp_path / "out"), "[a]", "/extends", "stands in its file")
    assert not (tmp_path / "out").exists()


def test_files_that_are_not_there_or_not_json(program, tmp_path):
    for verb in ("run", "check", "explain", "sweep"):
        refused(bench(program, verb, tmp_path / "nowhere.json"), "nowhere.json")
        refused(bench(program, verb, tmp_path), str(tmp_path))
        refused(bench(program, verb, write(tmp_path / "broken.json", "{\n  \"schema\": ,\n}")), "broken.json")
    refused(bench(program, "eval", tmp_path / "nowhere.jsonl"), "nowhere.jsonl")
    refused(bench(program, "eval", tmp_path), "a folder")


def test_check_and_explain_run_nothing(program, tmp_path):
    checked = bench(program, "check", BLOCK, cwd=tmp_path)
    explained = bench(program, "explain", BLOCK, cwd=tmp_path)
    assert checked.returncode == 0 and "ok" in checked.stdout and "config_id" in checked.stdout
    assert explained.returncode == 0 and "skipped" in explained.stdout
    assert list(tmp_path.iterdir()) == []


# --- meshes and plugins


@pytest.mark.parametrize("name, content, parts", [
    ("absent.ply", None, ["/scene/bodies/0/mesh/file"]),
    ("a.xyz", "0 0 0\n", ["a.xyz"]),
    ("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ["nan.obj:1", "nan"]),
    ("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", ["index.obj:4", "4"]),
    ("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", ["flat.obj"]),
    ("twice.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 2 3 1\n", ["twice.obj"]),
    ("short.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n", ["short.ply"]),
    ("empty.stl", "", ["empty.stl"]),
])
@pytest.mark.parametrize("verb", ["check", "explain", "run"])
def test_meshes_that_cannot_be_used(program, tmp_path, verb, name, content, parts):
    if content is not None:
        write(tmp_path / name, content)
    out = ["--out", tmp_path / "out"] if verb == "run" else []
    refused(bench(program, verb, bodies(tmp_path, {"file": name}), *out), *parts)
    assert not (tmp_path / "out").exists()


def test_run_records_an_initial_intersection(program, tmp_path):
    """An outcome, not an error: a sweep goes on."""
    crossing = json.loads(bodies(tmp_path, GRID).read_text())
    crossing["scene"]["bodies"].append({"name": "other", "mesh": GRID, "transform": {"axis": [1, 0, 0], "angle_deg": 90}})
    path = write(tmp_path / "crossing.json", crossing)
    refused(bench(program, "check", path), "crossing.json", "cloth", "other")
    assert bench(program, "run", path, "--out", tmp_path / "crossing").returncode == 0
    record = json.loads((tmp_path / "crossing/run.json").read_text())
    assert record["status"]["outcome"] == "initial_intersection" and "other" in record["status"]["detail"]


def test_plugins_that_cannot_be_loaded(program, build_folder, tmp_path):
    modules = build_folder / "tests/barriers"
    text = write(tmp_path / "text.so", "not a library")
    for path, part in [(tmp_path / "nowhere.so", "nowhere.so"), (text, "text.so"),
                       (modules / "plugin_other_abi.so", "abi_version"), (modules / "plugin_no_symbol.so", "no symbol")]:
        if path.parent == modules and not path.exists():
            pytest.skip(f"{path} is not built")
        refused(bench(program, "--plugin", path, "run", BLOCK, "--out", tmp_path / "out"), str(path), part)
    assert not (tmp_path / "out").exists()


def test_a_plugin_shape_can_be_named(program, build_folder):
    plugin = build_folder / "examples/plugins/plugin_inverse_shape.so"
    if not plugin.exists():
        pytest.skip(f"{plugin} is not built")
    plain, extended = bench(program, "list", "shapes"), bench(program, "--plugin", plugin, "list", "shapes")
    assert extended.returncode == 0
    new = set(extended.stdout.split("\n")) - set(plain.stdout.split("\n"))
    assert len(new) == 1


# --- runs


def test_run_writes_one_valid_record(program, tmp_path):
    done = bench(program, "run", BLOCK, "--out", tmp_path / "out", "--set", "/time/steps=3")
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["run.json", "trace.jsonl"]
    record = json.loads((tmp_path / "out/run.json").read_text())
    schema = json.loads((ROOT / "configs/schema/run.schema.json").read_text())
    jsonschema.Draft202012Validator(schema).validate(record)
    trace = json.loads((ROOT / "configs/schema/trace.schema.json").read_text())
    for line in (tmp_path / "out/trace.jsonl").read_text().splitlines():
        jsonschema.Draft202012Validator(trace).validate(json.loads(line))
    assert record["status"]["outcome"] == "ok" and record["summary"]["steps"] == 3
    assert str(tmp_path / "out/run.json") in done.stdout


def test_the_config_of_a_record_is_a_config(program, tmp_path):
    bench(program, "run", BLOCK, "--out", tmp_path / "one", "--set", "/time/steps=3")
    one = json.loads((tmp_path / "one/run.json").read_text())
    again = write(tmp_path / "again.json", one["config"])
    bench(program, "run", again, "--out", tmp_path / "two")
    two = json.loads((tmp_path / "two/run.json").read_text())
    assert two["ids"]["config_id"] == one["ids"]["config_id"]
    assert two["summary"]["state_hash"] == one["summary"]["state_hash"]


# --- output folders and signals


def test_an_output_folder_that_cannot_be_made(program, tmp_path):
    file = write(tmp_path / "file", "")
    for out in (file / "below", Path("/proc/no_such_folder")):
        refused(bench(program, "run", BLOCK, "--out", out), str(out))
    if os.geteuid() != 0:  # root may write everywhere
        tmp_path.chmod(0o555)
        refused(bench(program, "run", BLOCK, "--out", tmp_path / "out"), "Permission denied")
        tmp_path.chmod(0o755)


@pytest.mark.parametrize("limit", [100, 6000])
def test_a_full_output_folder(program, tmp_path, limit):
    """A limit on file sizes stands for a disk that is full at once, or when the record is written."""
    def full():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = bench(program, "run", BLOCK, "--out", tmp_path / "out", "--set", "/time/steps=1",
                 restore_signals=False, preexec_fn=full)
    refused(done, str(tmp_path / "out"), code=75)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("taken", ["frames", "frames/step_000000.ply"])
def test_a_frame_that_can_never_be_written(program, tmp_path, taken):
    """A file where the folder should be, a folder where the file should be."""
    place = tmp_path / "out" / taken
    place.parent.mkdir(parents=True)
    if taken == "frames":
        write(place, "")
    else:
        place.mkdir()
    done = bench(program, "run", BLOCK, "--out", tmp_path / "out", "--set", "/time/steps=1", "--set", "/output/frames_every=1")
    refused(done, str(place))
    assert not [p for p in tmp_path.rglob("*") if ".tmp." in p.name]


def test_a_disk_that_a_frame_fills(program, tmp_path):
    def full():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000))

    config = bodies(tmp_path, {"generator": "grid", "n_x": 20, "n_y": 20}, output={"frames_every": 1})
    done = bench(program, "run", config, "--out", tmp_path / "out", restore_signals=False, preexec_fn=full)
    refused(done, "frames.part/start.ply", code=75)
    assert not (tmp_path / "out").exists()


def long_run(tmp_path) -> list:
    """With a frame of every step, by which a test sees how far it is."""
    return ["run", BLOCK, "--out", str(tmp_path / "out"), "--set", "/time/steps=1000000", "--set", "/output/frames_every=1",
            "--set", "/passes/time=false"]


def frame(tmp_path, step: int) -> Path:
    return tmp_path / f"out/frames.part/step_{step:06}.ply"


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_leaves_no_record(program, tmp_path, sent):
    with started(program, *long_run(tmp_path)) as run:
        wait_until(frame(tmp_path, 1).exists, run)
        run.send_signal(sent)
        out, err = run.communicate(timeout=30)
    assert run.returncode == 75, err
    assert "interrupted" in err and out == ""
    assert not (tmp_path / "out/run.json").exists()


def test_eval_ends_at_an_interrupt(program):
    def listening():  # a shell's background job would hand SIGINT on as ignored
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    with subprocess.Popen([program, "eval"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, preexec_fn=listening) as waiting:
        waiting.stdin.write('{"kind": "rho", "shape": "cubic", "u": 0.5}\n')
        waiting.stdin.flush()
        assert json.loads(waiting.stdout.readline())["rho"] == pytest.approx(4)  # at once, not at the end
        waiting.send_signal(signal.SIGINT)
        waiting.wait(timeout=10)
    assert waiting.returncode == -signal.SIGINT


def test_the_sweep_of_the_page_is_the_one_of_the_help(program):
    text, page = bench(program, "sweep", "--help").stdout, (ROOT / "docs/guides/run-an-ablation.md").read_text()
    shown = text[text.index("{\n"):text.index("\n}\n") + 2]
    assert f"```json\n{shown}\n```" in page

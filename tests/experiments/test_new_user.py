"""What somebody who meets the program tries first: help of one place, the version, a config through a pipe, how large a scene is, which
row is which run, and lines that fit the terminal."""

import json
import re
import subprocess

import pytest
from test_cli import BLOCK, ROOT, bench, refused, sweep_spec, write

from tests import terminal
from tests.falling_cloth import CLOTH_ON_BALL

DRAPE2D = ROOT / "configs/scenes/drape2d.json"


def on_terminal(program: str, columns: int, *words) -> str:
    """What the program writes on a terminal of that width."""
    status, text = terminal.shown([program, *map(str, words)], columns)
    assert status == 0, text
    return text


def shown_lines(text: str) -> list[str]:
    """Lines as they stand on the screen: each rewriting of one is one."""
    return [line for line in re.split(r"\r\n|\r\x1b\[K|\n", text) if line]


# --- help and version


def test_help_of_a_verb_is_the_verb_s(program):
    assert bench(program, "help", "run").stdout == bench(program, "run", "--help").stdout != ""
    assert "every setting of a sweep" in bench(program, "help", "sweep").stdout


def test_help_of_a_place_is_what_is_there_and_below_it(program):
    whole = bench(program, "help", "config").stdout
    for words in (["/scene/obstacles"], ["config", "/scene/obstacles"], ["/scene/obstacles/0"], ["/scene/obstacles/N"]):
        found = bench(program, "help", *words).stdout
        assert "/scene/obstacles/N: " in found and "radius_m" in found and "dt_s" not in found
        assert all(line in whole for line in found.splitlines()[2:])
    leaf = bench(program, "help", "/time/dt_s").stdout
    assert "/time/dt_s of a config" in leaf and "Time step" in leaf and "steps " not in leaf
    assert "pointer" in bench(program, "help", "sweep", "/axes").stdout


def test_a_place_that_is_not_there_is_refused_with_the_nearest(program):
    refused(bench(program, "help", "/scene/obstacle"), "did you mean obstacles?")
    refused(bench(program, "help", "/time/dt_s/more"), "/more", "nothing below /time/dt_s")
    refused(bench(program, "help", "record", "/steps"), "record /steps")
    refused(bench(program, "help", "/time", "--schema"), "without --schema")
    refused(bench(program, "help", "rum"), "did you mean")


def test_the_version(program):
    message = bench(program, "--version")
    assert message.returncode == 0 and re.match(r"barrierbench \d+\.\d+\.\d+, commit .*, records 3\.\d+\.\d+$", message.stdout)


# --- a config from the standard input


@pytest.mark.parametrize("verb", ["check", "explain"])
def test_a_config_through_a_pipe_is_that_of_the_file(program, tmp_path, verb):
    text = (ROOT / "configs/scenes/hang.json").read_text()
    of_file, of_pipe = bench(program, verb, ROOT / "configs/scenes/hang.json"), bench(program, verb, "-", input=text, cwd=tmp_path)
    assert of_pipe.returncode == 0, of_pipe.stderr
    names = [done.stdout.replace(str(ROOT / "configs/scenes/hang.json"), "-") for done in (of_file, of_pipe)]
    assert names[0] == names[1]


def test_a_run_of_a_config_through_a_pipe(program, tmp_path):
    done = bench(program, "run", "-", "--out", tmp_path / "out", input=json.dumps(CLOTH_ON_BALL))
    assert done.returncode == 0, done.stderr
    assert bench(program, "run", tmp_path / "out/run.json", "--out", tmp_path / "again").returncode == 0


def test_what_is_wrong_in_a_pipe_says_where(program, tmp_path):
    refused(bench(program, "check", "-", input='{"schema": 1'), "the standard input")
    refused(bench(program, "check", "-", input='{"schema": "barrierbench.config/1", "scene": {"name": "hang"}, "time": {"dt_s": -1}}'), "the standard input#/time/dt_s")
    refused(bench(program, "sweep", "-", input="{}"), "-")


# --- how large a scene is


def test_check_says_how_large_a_scene_its_edges_and_d_hat_are(program, tmp_path):
    grid = {"generator": "grid", "n_x": 5, "n_y": 5, "size_x_m": 0.4, "size_y_m": 0.4}  # edges of 0.1 m and their diagonals
    body = {"name": "cloth", "mesh": grid, "transform": {"translate_m": [1, 0, 2]}}
    file = write(tmp_path / "a.json", {**CLOTH_ON_BALL, "scene": {"bodies": [body]}, "formulation": {"name": "log", "d_hat_m": 0.01}})
    message = bench(program, "check", file).stdout
    assert "bounding box 0.4 x 0.4 x 0 m, from (0.8, -0.2, 2) to (1.2, 0.2, 2) m" in message
    mean = (40 * 0.1 + 16 * 0.1 * 2**0.5) / 56
    assert f"body cloth: 25 vertices, 56 edges of 0.1 to 0.141 m, mean {mean:.3g} m; d_hat 0.01 m is {0.01 / mean:.2g} of the mean edge\n" in message
    wide = bench(program, "check", file, "--set", "/formulation/d_hat_m=0.11").stdout
    assert "more than the shortest edge" in wide and "more than" not in message


TWO_SQUARES = """v 0 0 1
v 1 0 1
v 2 0 1
v 0 1 1
v 1 1 1
v 2 1 1
f 1 2 5 4
o right half
f 2 3 6 5
g rim
l 3 6
"""


def test_names_of_an_obj_are_said_and_make_bodies_and_pins(program, tmp_path):
    (tmp_path / "squares.obj").write_text(TWO_SQUARES)
    mesh = {"file": str(tmp_path / "squares.obj")}
    body = {"name": "cloth", "mesh": mesh, "pins": [{"objects": ["rim"]}]}
    config = {**CLOTH_ON_BALL, "scene": {"bodies": [body]}, "formulation": {"name": "log", "d_hat_m": 0.01}}
    message = bench(program, "check", write(tmp_path / "a.json", config)).stdout
    assert "body cloth: 6 vertices" in message and f"objects and groups of {mesh['file']}: right half (4 vertices), rim (2 vertices)\n" in message
    half = bench(program, "check", tmp_path / "a.json", "--set", '/scene/bodies/0/mesh/objects=["right half"]').stdout
    assert "body cloth: 4 vertices" in half and "right half (4 vertices), rim (2 vertices)\n" in half  # all of the file
    unknown = bench(program, "check", tmp_path / "a.json", "--set", '/scene/bodies/0/pins/0/objects=["hem"]')
    refused(unknown, "/scene/bodies/0/pins/0/objects/0: found \"hem\"", "allowed: one of right half, rim")

    for kind in ("body", "frame"):
        requested = json.dumps({"path": mesh["file"], "as": kind, "names": True})
        answer = subprocess.run([program, "meshes"], input=requested.encode(), capture_output=True, check=True).stdout
        names = json.loads(answer.split(b"\n", 1)[0])["objects"]
        assert names == [{"name": "right half", "vertices": 4, "faces": 1, "lines": 1}, {"name": "rim", "vertices": 2, "faces": 0, "lines": 1}]


def test_names_of_an_obj_are_said_once_for_a_file_and_briefly(program, tmp_path):
    long = "o " + "x" * 5000 + "\nl 1 4\n"
    (tmp_path / "many.obj").write_text(TWO_SQUARES + long + "".join(f"o part {i}\nl 2 5\n" for i in range(30)))
    mesh = {"file": str(tmp_path / "many.obj"), "objects": ["right half"]}
    bodies = [{"name": name, "mesh": mesh, "transform": {"translate_m": [0, 0, z]}} for name, z in (("low", 0), ("high", 1))]
    config = {**CLOTH_ON_BALL, "scene": {"bodies": bodies}, "formulation": {"name": "log", "d_hat_m": 0.01}}
    message = bench(program, "check", write(tmp_path / "a.json", config)).stdout
    [line] = [line for line in message.splitlines() if "objects and groups of" in line]
    assert line.endswith("part 16 (2 vertices), and 13 more; the verb meshes has all of their names")
    assert "x" * 100 + "... (5000 bytes) (2 vertices)" in line and "x" * 101 not in line


def test_the_start_is_written_as_a_frame_also_where_it_is_refused(program, tmp_path):
    file = write(tmp_path / "a.json", CLOTH_ON_BALL)
    assert bench(program, "check", file, "--start-frame", tmp_path / "one").returncode == 0
    assert sorted(path.name for path in (tmp_path / "one/frames").iterdir()) == ["scene.json", "start.ply"]
    refused(bench(program, "check", file, "--start-frame", tmp_path / "one"), "--start-frame", "there already")
    inside = ["--set", "/scene/bodies/0/transform/translate_m=[0,0,0]"]
    refused(bench(program, "check", file, *inside, "--start-frame", tmp_path / "two"), "a start without intersections")
    assert (tmp_path / "two/frames/start.ply").is_file()


# --- which run is which


def row_of(stdout: str) -> str:
    return stdout.splitlines()[1].split("  ")[0]


def test_two_policies_have_two_labels_and_a_name_is_shown(program, tmp_path):
    few = ["--set", "/time/steps=2"]
    plain = bench(program, "run", DRAPE2D, *few, "--out", tmp_path / "0")
    assert row_of(plain.stdout) == "drape2d: log"
    policies = ['{"name": "ipc_adaptive"}', '{"name": "elasticity_inclusive"}']
    rows = []
    for k, policy in enumerate(policies):
        done = bench(program, "run", DRAPE2D, *few, "--set", f"/formulation/stiffness_policy={policy}", "--out", tmp_path / str(k + 1))
        assert done.returncode == 0, done.stderr
        rows.append(row_of(done.stdout))
        assert rows[-1].startswith(f"drape2d: log, {json.loads(policy)['name']} ")
        assert json.loads((tmp_path / str(k + 1) / "run.json").read_text())["labels"]["note"] == rows[-1]
    named = bench(program, "run", DRAPE2D, *few, "--set", '/name="my try"', "--out", tmp_path / "named", "--progress-every", "0.0001")
    assert row_of(named.stdout) == "my try: log" and "my try: log [" in named.stderr
    again = bench(program, "run", tmp_path / "named/run.json", "--out", tmp_path / "again")
    assert row_of(again.stdout) == "my try: log"


# --- lines that fit


@pytest.mark.parametrize("columns", [60, 80, 100])
def test_lines_of_a_run_fit_the_terminal(program, tmp_path, columns):
    words = ["run", DRAPE2D, "--set", "/time/steps=6", "--set", '/name="a name that is longer than what is usual in tables"', "--out", tmp_path / "out"]
    lines = shown_lines(on_terminal(program, columns, *words))
    table = [line for line in lines if line.startswith(("run ", "a name"))]
    assert len(table) >= 2 and any("[time]" in line or "step" in line for line in lines)
    assert max(map(len, table)) <= max(columns, 77) and all("outcome" in line or "ok" in line or "step" in line or "..." in line for line in table)
    steps = [line for line in lines if " [" in line]
    assert all(len(line) < columns for line in steps)


def test_a_wide_terminal_and_none_have_every_column(program, tmp_path):
    words = ["run", BLOCK, "--set", "/time/steps=3", "--out"]
    heads = [shown_lines(on_terminal(program, columns, *words, tmp_path / str(columns))) for columns in (137, 80)]
    head = [next(line for line in lines if line.startswith("run ")) for lines in heads]
    assert head[0] == bench(program, *words, tmp_path / "none").stdout.splitlines()[0]
    assert "cond bj" in head[0] and "cond bj" not in head[1] and {"outcome", "steps", "newton", "crossings"} <= set(head[1].split())


def test_rows_of_a_sweep_in_processes_fit_too(program, tmp_path):
    lines = shown_lines(on_terminal(program, 80, "sweep", sweep_spec(tmp_path, [3, 4]), "--jobs", "2", "--out", tmp_path / "out"))
    below = next(k for k, line in enumerate(lines) if "comparability" in line)  # from there on: what may be compared
    table = lines[:below]
    rows = [line for line in table if line.startswith(("run ", "steps: "))]
    assert sum(line.startswith("run ") for line in rows) == 1 and sum(" ok " in line for line in rows) == 2
    assert max(map(len, rows)) <= 80 and len(lines) > below + 2


@pytest.mark.parametrize("columns", [0, 60, 80, 200])
def test_what_may_be_compared_fits_the_terminal_and_loses_no_word(program, tmp_path, columns):
    """0: no terminal, and lines of any length."""
    kappa = "/formulation/stiffness_policy/kappa_N_per_m"
    cases = [{"label": label, "set": {kappa: value}} for label, value in (("stiff", 1000), ("as soft as a cushion, and a name of sixty characters or some more: é", 10))]
    few = {"/matching/rule": "as_given", "/time/steps": 30, "/time/dt_s": 0.01}
    spec = {"schema": "barrierbench.sweep/1", "name": "two", "base": BLOCK, "set": few, "axes": [{"cases": cases}]}
    words = ["sweep", write(tmp_path / "two.json", spec), "--out", tmp_path / "out"]
    message = on_terminal(program, columns, *words) if columns else bench(program, *words).stdout
    lines = shown_lines(message)
    below = lines[next(k for k, line in enumerate(lines) if "comparability" in line) :]
    assert all(line == line.rstrip() and (not columns or len(line) <= columns) for line in below)
    assert below[0].split() == ["run", "outcome", "comparability"]
    text = " ".join(" ".join(below).split())
    records = [json.loads(file.read_text()) for file in (tmp_path / "out").glob("*/run.json")]
    reasons = [record["comparability"]["reason"] for record in records if record["comparability"]["verdict"] != "comparable"]
    assert len(records) == 2 and reasons and all(reason in text for reason in reasons)
    assert all(record["labels"]["note"] in text for record in records)
    verdicts = {record["comparability"]["verdict"] for record in records}
    places = [line.index(line.split()[-1]) for line in below[1:] if line.strip() and line.split()[-1] in verdicts]
    assert places == 2 * [below[0].index("comparability")]


def test_why_a_run_of_a_sweep_failed_is_broken_at_the_terminal(program, tmp_path):
    spec = {"schema": "barrierbench.sweep/1", "name": "one", "base": str(DRAPE2D), "set": {"/step_solver/max_iterations": 1},
            "axes": [{"pointer": "/time/steps", "values": [4]}]}
    file = write(tmp_path / "one.json", spec)
    lines = shown_lines(on_terminal(program, 70, "sweep", file, "--out", tmp_path / "out"))
    [record] = [json.loads(path.read_text()) for path in (tmp_path / "out").glob("*/run.json")]
    assert record["status"]["outcome"] != "ok" and len("  step 0: " + record["status"]["detail"]) > 70
    assert record["status"]["detail"] in " ".join(" ".join(lines).split())
    why = [line for line in lines if line.startswith("  ")]  # the row of the run has 77 columns at least
    assert len(why) >= 2 and all(len(line) <= 70 for line in why)


def test_help_list_and_explain_are_broken_at_the_terminal_and_nowhere_else(program):
    for words in (["help", "config"], ["list", "scenes"], ["list", "methods"], ["explain", str(BLOCK)]):
        lines = shown_lines(on_terminal(program, 90, *words))
        too_long = [line for line in lines if len(line) > 90 and " " in line.strip()[:60].strip()]
        assert len(too_long) < 0.02 * len(lines), too_long[:3]
        whole = bench(program, *words).stdout
        assert " ".join(" ".join(lines).split()) == " ".join(whole.split())

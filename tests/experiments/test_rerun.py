"""What a record says of its making, and that it repeats itself: `bench run RUN.json`."""

import json
import shutil
from pathlib import Path

import pytest

from test_cli import BLOCK, bench, bodies, refused, write

STATE_HASH = "0" * 64
PATCH = "v 0 0 0.02\nv 1 0 0.02\nv 0 1 0.02\nv 1 1 0.02\nf 1 2 3\nf 2 4 3\n"
FLOOR = [{"name": "floor", "kind": "plane", "point_m": [0, 0, 0], "axis": [0, 0, 1]}]


def read(folder: Path) -> dict:
    return json.loads((folder / "run.json").read_text())


def edit(folder: Path, **values) -> Path:
    """Puts other values at dotted places of the record; returns its path."""
    record = read(folder)
    for place, value in values.items():
        *sections, field = place.split("__")
        target = record
        for section in sections:
            target = target[section]
        assert target[field] != value
        target[field] = value
    return write(folder / "run.json", record)


@pytest.fixture
def block(program, tmp_path) -> Path:
    """The folder of a small run that ends in contact."""
    out = tmp_path / "one"
    assert bench(program, "run", BLOCK, "--out", out, "--set", "/time/steps=3").returncode == 0
    assert read(out)["steps"][-1]["contacts"]["total"] > 0
    return out


@pytest.fixture
def cloth(program, tmp_path) -> tuple[Path, Path]:
    """A config whose cloth comes from a file of its own and falls on a plane; the file."""
    mesh = write(tmp_path / "patch.obj", PATCH)
    config = json.loads(bodies(tmp_path, {"file": "patch.obj"}, time={"dt_s": 0.01, "steps": 8}).read_text())
    config["scene"]["obstacles"] = FLOOR
    return write(tmp_path / "bodies.json", config), mesh


def run(program: str, config: Path, out: Path, *more) -> dict:
    done = bench(program, "run", config, "--out", out, *more)
    assert done.returncode == 0, done.stderr
    record = read(out)
    assert record["status"]["outcome"] == "ok" and record["steps"][-1]["contacts"]["total"] > 0
    return record


# --- the verdict


def test_a_record_repeats_itself_in_a_folder_of_its_own(program, block, tmp_path):
    before = (block / "run.json").read_bytes()
    done = bench(program, "run", block / "run.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "the final state is the same, bit for bit" in done.stdout
    bench(program, "run", block / "run.json", cwd=tmp_path)
    first, second = sorted((tmp_path / "results/runs").iterdir())
    assert first.name.endswith("-rerun") and second.name.endswith("-rerun-2")
    assert (block / "run.json").read_bytes() == before
    one, again = read(block), read(first)
    assert again["summary"]["state_hash"] == one["summary"]["state_hash"] != ""
    assert again["ids"]["rerun_of"] == one["ids"]["run_id"] == again["ids"]["run_id"]


@pytest.mark.parametrize("place, value, reason", [
    ("ids__build_id", "b" * 64, "another build"),
    ("machine__cpu_model", "Abacus", "another processor"),
    ("provenance__libraries", {"blas": "OpenBLAS Prescott"}, "another BLAS or BLAS kernel"),
])
def test_a_state_that_may_differ_comes_with_the_reason(program, block, tmp_path, place, value, reason):
    done = bench(program, "run", edit(block, summary__state_hash=STATE_HASH, **{place: value}), "--out", tmp_path / "two")
    assert done.returncode == 0
    assert "the final state differs, as it may" in done.stdout and reason in done.stdout


@pytest.mark.parametrize("place, value", [("summary__state_hash", STATE_HASH), ("status__outcome", "newton_stall")])
def test_a_state_that_should_have_been_the_same_has_an_exit_code_of_its_own(program, block, tmp_path, place, value):
    done = bench(program, "run", edit(block, **{place: value}), "--out", tmp_path / "two")
    assert done.returncode == 3, (done.stdout, done.stderr)
    assert "nothing that the records name explains it" in done.stdout
    assert read(tmp_path / "two")["status"]["outcome"] == "ok"


def test_another_setting_is_a_reason(program, block, tmp_path):
    done = bench(program, "run", block / "run.json", "--out", tmp_path / "two", "--set", "/time/steps=4")
    assert done.returncode == 0 and "another config" in done.stdout
    assert read(tmp_path / "two")["summary"]["steps"] == 4


def test_a_rerun_never_replaces_its_record(program, block):
    before = (block / "run.json").read_bytes()
    refused(bench(program, "run", block / "run.json", "--out", block), "--out", str(block))
    assert (block / "run.json").read_bytes() == before


def test_a_record_with_another_trace_is_refused(program, block, tmp_path):
    """What the record says and what its trace says would be of two runs. Without the trace the record is still whole."""
    trace = block / "trace.jsonl"
    (named,) = [file for file in read(block)["artifacts"] if file["kind"] == "trace"]
    whole = trace.read_text()
    for other in (whole.replace('"iteration":0', '"iteration":9', 1), whole[:-30], ""):
        assert other != whole
        trace.write_text(other)
        refused(bench(program, "run", block / "run.json", "--out", tmp_path / "two"), str(trace), "/artifacts/", named["sha256"])
        assert not (tmp_path / "two").exists()
    trace.unlink()
    done = bench(program, "run", block / "run.json", "--out", tmp_path / "two")
    assert done.returncode == 0 and "the same, bit for bit" in done.stdout, done.stderr


def test_a_record_without_a_first_step_repeats_its_outcome(program, tmp_path):
    grid = {"generator": "grid", "n_x": 2, "n_y": 2}
    crossing = json.loads(bodies(tmp_path, grid).read_text())
    crossing["scene"]["bodies"].append({"name": "other", "mesh": grid, "transform": {"axis": [1, 0, 0], "angle_deg": 90}})
    bench(program, "run", write(tmp_path / "crossing.json", crossing), "--out", tmp_path / "one")
    assert read(tmp_path / "one")["status"]["outcome"] == "initial_intersection"
    done = bench(program, "run", tmp_path / "one/run.json", "--out", tmp_path / "two")
    assert done.returncode == 0 and "no first step" in done.stdout


# --- what the record names


def test_threads_change_neither_config_id_nor_state_but_the_run(program, tmp_path):
    one, two = (run(program, BLOCK, tmp_path / str(n), "--set", f"/threads={n}") for n in (1, 2))
    assert one["ids"]["config_id"] == two["ids"]["config_id"]
    assert one["summary"]["state_hash"] == two["summary"]["state_hash"] != ""
    assert one["ids"]["run_id"] != two["ids"]["run_id"]


def test_a_mesh_is_known_by_its_content_and_named_from_the_record(program, cloth, tmp_path):
    config, mesh = cloth
    one = run(program, config, tmp_path / "runs/one")
    named = one["config"]["scene"]["bodies"][0]["mesh"]
    assert named["file"] == "../../patch.obj" and list(one["scene"]["mesh_sha256"]) == ["../../patch.obj"]
    done = bench(program, "run", tmp_path / "runs/one/run.json", "--out", tmp_path / "again")
    assert done.returncode == 0 and "the same, bit for bit" in done.stdout

    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    moved = [shutil.copy(file, elsewhere) for file in (config, mesh)]
    assert run(program, moved[0], tmp_path / "two")["ids"]["config_id"] == one["ids"]["config_id"]
    write(elsewhere / "patch.obj", PATCH.replace("0.02", "0.03"))
    assert run(program, moved[0], tmp_path / "three")["ids"]["config_id"] != one["ids"]["config_id"]


def test_a_mesh_that_changed_or_went_is_an_error(program, cloth, tmp_path):
    config, mesh = cloth
    run(program, config, tmp_path / "one")
    again = ["run", tmp_path / "one/run.json", "--out", tmp_path / "two"]
    write(mesh, PATCH.replace("0.02", "0.03"))
    refused(bench(program, *again), "run.json", "/scene/bodies/0/mesh/sha256", "patch.obj")
    mesh.unlink()
    refused(bench(program, *again), "run.json", "/scene/bodies/0/mesh/file", "patch.obj")
    assert not (tmp_path / "two").exists()


def test_kept_inputs_travel_with_the_record(program, cloth, tmp_path):
    config, mesh = cloth
    record = run(program, config, tmp_path / "one", "--keep-inputs")
    named = record["config"]["scene"]["bodies"][0]["mesh"]["file"]
    assert named.startswith("inputs/") and (tmp_path / "one" / named).read_text() == PATCH
    mesh.unlink()
    shutil.move(tmp_path / "one", tmp_path / "far/away/one")
    done = bench(program, "run", tmp_path / "far/away/one/run.json", "--out", tmp_path / "two", "--keep-inputs")
    assert done.returncode == 0 and "the same, bit for bit" in done.stdout, done.stderr
    assert read(tmp_path / "two")["config"]["scene"]["bodies"][0]["mesh"]["file"] == named


# --- plugins


@pytest.fixture
def plugin(build_folder, tmp_path) -> Path:
    built = build_folder / "examples/plugins/plugin_inverse_shape.so"
    if not built.exists():
        pytest.skip(f"{built} is not built")
    return Path(shutil.copy(built, tmp_path / "shape.so"))


def with_plugin(program: str, plugin: Path, out: Path, *more) -> dict:
    listed = set(bench(program, "--plugin", plugin, "list", "shapes").stdout.split("\n"))
    shape = (listed - set(bench(program, "list", "shapes").stdout.split("\n"))).pop().split()[0]
    done = bench(program, "--plugin", plugin, "run", BLOCK, "--out", out, "--set", "/time/steps=3",
                 "--set", f"/formulation/shape={shape}", *more)
    assert done.returncode == 0, done.stderr
    return read(out)


def test_a_plugin_is_known_by_its_content_and_found_again(program, plugin, tmp_path):
    one = with_plugin(program, plugin, tmp_path / "one")
    (named,) = one["provenance"]["plugins"]
    assert named["file"] == "../shape.so" and len(named["sha256"]) == 64
    again = ["run", tmp_path / "one/run.json", "--out", tmp_path / "two"]
    done = bench(program, *again)
    assert done.returncode == 0 and "the same, bit for bit" in done.stdout, done.stderr

    with plugin.open("ab") as file:
        file.write(b"\0")  # the same code, another file
    assert with_plugin(program, plugin, tmp_path / "other")["ids"]["run_id"] != one["ids"]["run_id"]
    refused(bench(program, *again), "run.json", "/provenance/plugins/0/sha256", named["sha256"])
    done = bench(program, "--plugin", plugin, *again)
    assert done.returncode == 0 and "another set of plugins" in done.stdout
    plugin.unlink()
    refused(bench(program, *again), "run.json", "/provenance/plugins/0/file", "shape.so")


def test_a_kept_plugin_travels_with_the_record(program, plugin, tmp_path):
    record = with_plugin(program, plugin, tmp_path / "one", "--keep-inputs")
    assert record["provenance"]["plugins"][0]["file"].startswith("inputs/")
    plugin.unlink()
    done = bench(program, "run", tmp_path / "one/run.json", "--out", tmp_path / "two")
    assert done.returncode == 0 and "the same, bit for bit" in done.stdout, done.stderr

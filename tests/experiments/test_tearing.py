"""examples/tearing: a cloth is cut along its weak edges, every stitch of the line breaks one after the other, and
the tear waits where the line is stronger. The frames say which stitches are broken; the script itself compares
them with what records count.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_cli import bench, refused

from barrierbench_analysis.io.record_file import read_record

ROOT = Path(__file__).resolve().parents[2]
COLUMNS, ROWS, STEPS = 11, 5, 260

sys.path.insert(0, str(ROOT / "examples/tearing"))
import tear  # noqa: E402


def made(strong=None) -> tear.Cut:
    whole = tear.grid(COLUMNS, ROWS)
    return tear.cut(whole, tear.edge_weights(whole, strong))


def torn(program, folder, *words) -> subprocess.CompletedProcess:
    size = ("--columns", str(COLUMNS), "--rows", str(ROWS), "--steps", str(STEPS))
    command = [sys.executable, ROOT / "examples/tearing/tear.py", folder, *size, "--program", program, *words]
    done = subprocess.run(command, cwd=ROOT, env={"PYTHONPATH": str(ROOT / "analysis/src"), "PATH": "/usr/bin:/bin", "HOME": str(folder)},
                          capture_output=True, text=True, check=False, timeout=300)  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done


def test_the_mesh_is_cut_along_the_weak_edges_alone():
    cut = made()
    assert len(cut.upper) == COLUMNS and len(cut.mesh.vertices) == COLUMNS * ROWS + COLUMNS
    apart = cut.mesh.vertices[cut.upper] - cut.mesh.vertices[cut.lower]
    np.testing.assert_allclose(apart, np.tile([0, tear.SLIT, 0], (COLUMNS, 1)), atol=1e-15)
    of_triangles = np.sign(cut.mesh.vertices[cut.mesh.triangles][:, :, 1])
    assert (abs(of_triangles.sum(axis=1)) == 3).all()  # none joins the lips
    assert cut.length.sum() == pytest.approx(tear.SIZE[0]) and (cut.weight == pytest.approx(0.3))


def test_edges_that_are_no_path_are_refused():
    whole = tear.grid(COLUMNS, ROWS)
    with pytest.raises(SystemExit, match="weak edges: found 0 ends; allowed: one path"):
        tear.cut(whole, np.full(len(tear.edges(whole)), 0.5))


def test_the_line_tears_through_stitch_by_stitch(program, tmp_path):
    message = torn(program, tmp_path)
    assert f"{COLUMNS} of {COLUMNS} stitches are broken" in message.stdout
    record = read_record(tmp_path / "run/run.json")
    counts = [step["broken_stitches"] for step in record["steps"]]
    assert counts == sorted(counts) and counts[0] == 0
    assert counts[-1] == COLUMNS == record["summary"]["broken_stitches"]
    assert len(set(counts)) > COLUMNS // 2  # not all at once
    found = tear.read_tear(made(), tmp_path / "run")
    front = found.front(made())
    assert (np.diff(front) >= 0).all() and front[-1] == pytest.approx(tear.SIZE[0])
    through = found.t[
        np.argmax(found.broken.all(axis=1))
    ]  # the front goes as far as legs that do not stretch
    assert through * tear.SPEED == pytest.approx(tear.SIZE[0], rel=0.1)
    assert abs(found.force[-1]) < 0.05 * found.force.max()  # nothing is left to pull at
    assert record["audit"]["crossings"] == 0
    assert (tmp_path / "tearing.png").stat().st_size > 10000
    assert "EXPERIMENT" in json.loads((tmp_path / "tearing.json").read_text())["name"]


def test_the_tear_waits_where_the_line_is_stronger(program, tmp_path):
    torn(program, tmp_path, "--strong-from-m", "0")
    cut = made(0)
    found = tear.read_tear(cut, tmp_path / "run")
    weak = cut.weight < 0.5
    assert 3 < weak.sum() < COLUMNS - 3
    passed = int(np.argmax(found.broken[:, weak].all(axis=1)))
    strong = int(np.argmax(found.broken[:, ~weak].any(axis=1)))
    assert 0 < passed and passed + 20 < strong
    assert found.force[passed:].max() > 2 * found.force[: passed + 1].max()


def test_the_device_executor_breaks_the_same_stitches(program, tmp_path):
    counts = []
    for words in ([], ["/device=host", "/linear_solver/name=pcg_resident"]):
        config = tear.write_scene(made(), tmp_path / str(len(counts)), 60)
        sets = [word for setting in words for word in ("--set", setting)]
        done = bench(program, "run", config, "--out", config.parent / "run", *sets)
        assert done.returncode == 0, done.stderr
        counts.append(
            [step["broken_stitches"] for step in read_record(config.parent / "run/run.json")["steps"]]
        )
    assert counts[0] == counts[1] and counts[0][-1] > 1


def test_other_engines_are_refused(program, tmp_path):
    config = tear.write_scene(made(), tmp_path, 1)
    content = json.loads(config.read_text())
    content["scene"]["bodies"][0]["pins"] = []  # pulls are refused, too
    config.write_text(json.dumps(content))
    refused(bench(program, "export-scene", config), f"found stitch ({COLUMNS} stitches)")

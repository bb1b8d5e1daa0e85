"""What the tests of studies make and change."""

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/sweeps"))
from sweep_files import bench, write_sweep  # noqa: E402

SHAPES = {"pointer": "/formulation", "values": ["log", "cubic"]}
STEPS = {"pointer": "/time/steps", "values": [40, 60]}  # long enough to touch
PATCH = "v 0 0 0.02\nv 1 0 0.02\nv 0 1 0.02\nv 1 1 0.02\nf 1 2 3\nf 2 4 3\n"


def sweep_of_four(program: str, folder: Path) -> Path:
    file = write_sweep(folder, STEPS, SHAPES)
    assert bench(program, "sweep", file, "--out", folder / "study").returncode == 0
    paths = sorted((folder / "study").glob("*/run.json"))
    assert len(paths) == 4 and all(json.loads(path.read_text())["steps"][-1]["contact_load_max_N"] > 0 for path in paths)
    return folder / "study"


def edit(path: Path, place: tuple, value) -> None:
    record = json.loads(path.read_text())
    *way, last = place
    at = record
    for key in way:
        at = at[key]
    assert at[last] != value
    at[last] = value
    path.write_text(json.dumps(record))


def ran(program: str, folder: Path, config: dict, *words) -> Path:
    (folder / "config.json").write_text(json.dumps(config))
    done = bench(program, "run", folder / "config.json", "--out", folder / "run", *words)
    assert done.returncode == 0, done.stderr
    return folder / "run"


def filmed(program: str, folder: Path, *words) -> Path:
    """A run of a tetrahedron whose mesh and motion are three files; the first of them is both."""
    for k, number in enumerate((8, 9, 10)):
        corners = "".join(f"v {x} {y} {z + k / 100}\n" for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
        (folder / f"walk_{number}.obj").write_text(corners + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    body = {"name": "walker", "kind": "rigid", "mesh": {"file": "walk_8.obj"}, "motion": {"film": {"file": "walk_8.obj"}}}
    (folder / "times.csv").write_text("time_s\n0\n0.01\n0.03\n")
    sheet = {"name": "sheet", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "transform": {"translate_m": [0, 0, 2]}, "material": {"youngs_N_per_m": 50}}
    config = {"schema": "barrierbench.config/1", "time": {"dt_s": 0.01, "steps": 2}, "formulation": {"name": "log", "d_hat_m": 0.01}, "threads": 1,
              "scene": {"name": "bodies", "bodies": [sheet, body]}}
    return ran(program, folder, config, *words)


def of_a_patch(folder: Path) -> dict:
    """A config of two steps whose cloth is in a file of its own."""
    (folder / "patch.obj").write_text(PATCH)
    return {"schema": "barrierbench.config/1", "time": {"dt_s": 0.01, "steps": 2}, "formulation": {"name": "log", "d_hat_m": 0.01}, "threads": 1,
            "scene": {"name": "bodies", "bodies": [{"name": "cloth", "mesh": {"file": "patch.obj"}, "material": {"youngs_N_per_m": 50}}]}}


def made(program: str, folder: Path) -> Path:
    return ran(program, folder, of_a_patch(folder))


def cut(program: str, folder: Path) -> Path:
    """The same, stopped after its first step."""
    (folder / "config.json").write_text(json.dumps(of_a_patch(folder)))
    bench(program, "run", folder / "config.json", "--out", folder / "run", "--step-limit", "1")
    assert json.loads((folder / "run/run.json").read_text())["status"]["outcome"] == "timeout"
    return folder / "run"

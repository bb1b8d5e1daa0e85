"""Whole runs with bodies and rest shapes that are films: as keyframes of the same motion, kept inputs, films that
cross, and what is refused by name.
"""

import json

import numpy as np
import pytest
from test_cli import bench, refused, write

from barrierbench_analysis.io.frames import frame_of, frame_paths
from barrierbench_analysis.io.record_file import read_record

BOX = {"generator": "box", "n": 2, "size_x_m": 0.2, "size_y_m": 0.2, "size_z_m": 0.1}
SHEET = {"generator": "grid", "n_x": 7, "n_y": 7, "size_x_m": 0.3, "size_y_m": 0.3}
KEYS = [(0.0, 0.0, 0.0), (0.02, 0.01, 0.004), (0.05, 0.03, -0.01), (0.1, 0.0, 0.02)]  # s, m along z, m along x
LIFT = {"keyframes": [{"time_s": t, "translate_m": [x, 0, z]} for t, z, x in KEYS]}


def config(body: dict, **more) -> dict:
    """A sheet that falls onto a box that moves."""
    return {
        "schema": "barrierbench.config/1",
        "scene": {
            "bodies": [
                {"name": "sheet", "mesh": SHEET, "transform": {"translate_m": [0.01, 0.02, 0.056]},
                 "material": {"youngs_N_per_m": 100, "density_kg_per_m2": 0.2, "bending_J": 1e-5}},
                {"name": "box", "kind": "rigid", "mesh": BOX, **body},
            ],
        },
        "formulation": {"name": "log", "d_hat_m": 0.005},
        "friction": {"mu": 0.2},
        "time": {"dt_s": 0.01, "steps": 10},
        "passes": {"time": False},
        "output": {"frames_every": 1},
        **more,
    }  # fmt: skip


def run(program, folder, config, *more) -> dict:
    folder.mkdir(exist_ok=True)
    done = bench(program, "run", write(folder / "config.json", config), "--out", folder / "out", *more)
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "out/run.json").read_text())


def obj(points: np.ndarray, faces: np.ndarray) -> str:
    lines = ["v %.17g %.17g %.17g" % tuple(p) for p in points]
    return "\n".join([*lines, *("f %d %d %d" % tuple(f + 1) for f in faces), ""])


@pytest.fixture
def film(program, tmp_path):
    """Writes a film of the box, of KEYS or of other frames; answers the path of its first file."""
    record = run(program, tmp_path / "mesh", config({}, time={"dt_s": 0.01, "steps": 1}))
    folder = tmp_path / "mesh/out"
    frame = frame_of(read_record(folder / "run.json"), folder, next(iter(frame_paths(record, folder))))
    own = np.flatnonzero(frame.of_vertices["body"] == 1)
    faces = frame.triangles[np.isin(frame.triangles, own).all(axis=1)] - own[0]
    points = frame.vertices[own].astype(float)

    def write_film(name="film", frames=None, faces=faces, times=None, first=0) -> str:
        out = tmp_path / name
        out.mkdir()
        frames = [points + [x, 0, z] for _, z, x in KEYS] if frames is None else frames(points)
        for k, x in enumerate(frames):
            (out / f"box_{first + k:03}.obj").write_text(obj(np.asarray(x), faces))
        if times is not None:
            rows = "".join(f"{k},{k},{t}\n" for k, t in enumerate(times))
            (out / "times.csv").write_text(f"frame,step,time_s\n{rows}")
        return str(out / f"box_{first:03}.obj")

    return write_film


TIMES = [t for t, _, _ in KEYS]


def of_film(path: str, **more) -> dict:
    return {"motion": {"film": {"file": path, **({"times_s": TIMES} if not more else more)}}}


def states(record, folder) -> list[np.ndarray]:
    read = read_record(folder / "run.json")
    return [frame_of(read, folder, step).vertices.astype(float) for step in frame_paths(record, folder)]


def gaps(record) -> np.ndarray:
    return np.array([np.nan if s["gap_min_m"] is None else s["gap_min_m"] for s in record["steps"]])


@pytest.mark.parametrize("integrator", ["implicit_euler", "bdf2", "newmark", "half_gravity"])
def test_a_film_is_the_keyframed_body_of_the_same_motion(program, tmp_path, film, integrator):
    more = {"integrator": {"name": integrator}}
    keyed = run(program, tmp_path / "keyed", config({"motion": LIFT}, **more))
    filmed = run(program, tmp_path / "filmed", config(of_film(film()), **more))
    assert keyed["status"]["outcome"] == filmed["status"]["outcome"] == "ok"
    assert filmed["audit"]["judged"] > 0 and filmed["audit"]["motion_pairs"] > 0
    a, b = (states(r, tmp_path / n / "out") for r, n in ((keyed, "keyed"), (filmed, "filmed")))
    assert np.isfinite(gaps(keyed)).sum() >= 3, "no contact"
    np.testing.assert_allclose(gaps(filmed), gaps(keyed), rtol=1e-9)
    for x, y in zip(a, b):
        np.testing.assert_allclose(y, x, atol=1e-9 * 0.3)
    # momentum of the sheet from step to step
    p, q = (np.diff([x[:49].mean(axis=0) for x in xs], axis=0) for xs in (a, b))
    assert np.abs(p).max() > 1e-3
    np.testing.assert_allclose(q, p, atol=1e-9 * np.abs(p).max())


def test_times_come_from_the_config_a_step_or_a_file(program, tmp_path, film):
    even = [0.0, 0.02, 0.04, 0.06]
    start = {"start_s": 0.03}
    of_file = film("a", times=even)
    given = film("b")
    runs = [
        run(program, tmp_path / f"run{k}", config(of_film(path, **settings, **start)))
        for k, (path, settings) in enumerate([(of_file, {}), (given, {"times_s": even}), (given, {"frame_s": 0.02})])
    ]
    assert len({r["summary"]["state_hash"] for r in runs}) == 1
    box = states(runs[0], tmp_path / "run0/out")
    assert (box[0][-26:] == box[3][-26:]).all() and not (box[4][-26:] == box[3][-26:]).all(), "held until 0.03 s"


def test_a_smooth_film_goes_through_the_same_frames_another_way(program, tmp_path, film):
    path = film()
    linear = run(program, tmp_path / "l", config(of_film(path)))
    smooth = run(program, tmp_path / "s", config(of_film(path, times_s=TIMES, interpolation="smooth")))
    a, b = (states(r, tmp_path / n / "out") for r, n in ((linear, "l"), (smooth, "s")))
    at = [round(t / 0.01) for t in TIMES[1:]]  # frames of a run begin with its start
    for k in range(1, 11):
        same = np.abs(a[k][-26:] - b[k][-26:]).max()
        assert (same < 1e-12) == (k in at), (k, same)


def test_the_inputs_of_a_run_are_kept_and_it_runs_again_from_them(program, tmp_path, film):
    path = film("a", times=TIMES)
    record = run(program, tmp_path / "one", config(of_film(path, start_s=0.0)), "--keep-inputs")
    folder = tmp_path / "one/out"
    kept = sorted(p.name for p in next((folder / "inputs").iterdir()).iterdir())
    assert kept == ["box_000.obj", "box_001.obj", "box_002.obj", "box_003.obj", "times.csv"]
    assert len(record["scene"]["mesh_sha256"]) == 5
    again = bench(program, "run", folder / "run.json", "--out", tmp_path / "again")
    assert again.returncode == 0, again.stderr
    other = json.loads((tmp_path / "again/run.json").read_text())
    assert other["summary"]["state_hash"] == record["summary"]["state_hash"]
    assert other["ids"]["config_id"] == record["ids"]["config_id"], "wherever the files are"


def test_a_film_that_crosses_itself_is_said_before_the_first_step(program, tmp_path):
    leg = {"generator": "cylinder", "radius_m": 0.05, "length_m": 1.0, "n_around": 10, "n_along": 24}
    curls = {"generator": "bend", "angle_rad": 9.0, "from_m": -0.4, "to_m": 0.4, "period_s": 0.2, "n_frames": 41, "duration_s": 0.2}
    body = {"mesh": leg, "transform": {"translate_m": [0, 0, -0.6]}, "motion": {"film": curls}}
    file = write(tmp_path / "c.json", config(body, time={"dt_s": 0.01, "steps": 12}))
    bench(program, "run", file, "--out", tmp_path / "out")
    record = json.loads((tmp_path / "out/run.json").read_text())
    assert record["status"]["outcome"] == "given_parts_cross" and record["summary"]["steps"] == 0
    detail = record["status"]["detail"]
    assert detail.count("box[") == 2 and "both are prescribed" in detail and " s" in detail
    checked = bench(program, "check", file, "--film")
    refused(checked, "from ", "prescribed parts that do not cross each other")
    assert checked.stderr.count("box[") >= 2
    curls["angle_rad"] = 2.0
    fine = bench(program, "check", write(tmp_path / "d.json", config(body)), "--film")
    assert fine.returncode == 0, fine.stderr
    assert "film of box: 41 frames of 252 vertices, 0 to 0.2 s, linear" in fine.stdout
    assert "no prescribed part crosses another in 20 steps" in fine.stdout
    refused(bench(program, "check", write(tmp_path / "e.json", config({})), "--film"), "no film", "--film")


def test_what_a_film_may_not_be_is_said_by_name(program, tmp_path, film):
    def message(path, *parts, **settings):
        name = "c.json"
        refused(bench(program, "check", write(tmp_path / name, config(of_film(path, **settings)))), *parts)

    good = film("good")
    message(good, "found 3 times", "4, one a frame", times_s=TIMES[:3])
    message(good, "of frame 2 after 0.02", "times that increase", times_s=[0, 0.02, 0.01, 0.1])
    message(good, "frame_s beside times_s", frame_s=0.1, times_s=TIMES)
    message(good, "times.csv beside the frames", start_s=0.0)
    message(good, "one of linear, smooth", frame_s=0.1, interpolation="cubic")
    message(film("mm", frames=lambda x: [1000 * x, 1000 * x]), "1000 times as large", frame_s=0.1)
    message(film("moved", frames=lambda x: [x + [0, 0, 0.1], x]), "0.1 m from where the body starts", frame_s=0.1)
    message(film("short", frames=lambda x: [x, x[:-1]]), "box_001.obj", "a vertex from 1 to 25", frame_s=0.1)
    bad = film("nan", frames=lambda x: [x, np.where(np.arange(len(x))[:, None] == 3, np.nan, x)])
    message(bad, "box_001.obj", "nan", frame_s=0.1)
    turned = film("turned", faces=np.array([[0, 2, 1]]))
    message(turned, "triangles", "as the mesh of the body has", frame_s=0.1)
    hole = film("hole")
    (tmp_path / "hole/box_001.obj").unlink()
    message(hole, "no frame between box_000.obj and box_002.obj", frame_s=0.1)
    message(str(tmp_path / "none/a_0.obj"), "none", "folder of mesh files", frame_s=0.1)
    message(good, "the hash of the files' hashes", frame_s=0.1, sha256="0" * 64)
    ball = {"name": "ball", "kind": "sphere", "radius_m": 0.1, "point_m": [0, 0, 9], **of_film(good)}
    both = config({})
    both["scene"]["obstacles"] = [ball]
    refused(bench(program, "check", write(tmp_path / "o.json", both)), "a film of an obstacle", "rigid body, or of pins")


# --- films that deform, with all else that a motion has


def turned(points, angle):
    """Cross-sections turn the more the higher they are: every vertex goes a way of its own."""
    a = angle * (points[:, 2] + 1)
    c, s = np.cos(a), np.sin(a)
    return np.stack([c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1], points[:, 2]], axis=1)


TURNS = {"generator": "twist", "turn_rad_per_m": 0.6, "from_m": -1, "period_s": 0.2, "n_frames": 101, "duration_s": 0.1}


def angle(t):
    return 0.6 * 0.5 * (1 - np.cos(2 * np.pi * t / 0.2))


def test_every_vertex_goes_its_own_way_and_the_operations_come_after(program, tmp_path):
    moved = {"motion": {"film": TURNS, "velocity_m_per_s": [0, 0, 0.5], "end_s": 0.1}}
    more = {"translate_m": [1, 2, 3]}
    whole = config(moved)
    whole["scene"].update(more)
    whole["scene"]["bodies"][0]["transform"]["translate_m"][2] = 0.2
    record = run(program, tmp_path / "a", whole)
    there = states(record, tmp_path / "a/out")
    start = there[0][-26:] - [1, 2, 3]
    assert np.abs(there[10][-26:] - there[0][-26:]).max() > 0.05
    for k, x in enumerate(there):
        expected = turned(start, angle(0.01 * k)) + [1, 2, 3 + 0.5 * 0.01 * k]
        np.testing.assert_allclose(x[-26:], expected, atol=1e-5)


def test_a_run_on_a_film_that_is_cut_goes_on_to_the_same_end(program, tmp_path):
    body = config({"motion": {"film": TURNS}}, output={"checkpoint_every": 1})
    body["scene"]["bodies"][0].update(limited=False, rest_film={"generator": "grow", "factor_x": 1.2, "period_s": 0.2, "duration_s": 0.1})
    file = write(tmp_path / "c.json", body)
    assert bench(program, "run", file, "--out", tmp_path / "whole").returncode == 0
    assert bench(program, "run", file, "--out", tmp_path / "cut", "--step-limit", 4).returncode == 0
    assert bench(program, "run", file, "--out", tmp_path / "cut", "--resume").returncode == 0
    a, b = (json.loads((tmp_path / n / "run.json").read_text()) for n in ("whole", "cut"))
    assert a["status"]["outcome"] == "ok" and a["summary"]["steps"] == 10
    assert a["summary"]["state_hash"] == b["summary"]["state_hash"]


@pytest.mark.parametrize("pin", [{"hold_s": 0.03}, {"pull_N_per_m": 1e5}, {}])
def test_pins_of_a_film_go_where_their_own_vertices_go(program, tmp_path, pin):
    whole = config({}, time={"dt_s": 0.005, "steps": 20})
    sheet = whole["scene"]["bodies"][0]
    sheet.update(transform={"translate_m": [0, 0, 0.3]}, pins=[{"indices": [0, 6], "motion": {"film": TURNS}, **pin}])
    record = run(program, tmp_path / "a", whole)
    there = states(record, tmp_path / "a/out")
    start = there[0][[0, 6]] - [0, 0, 0.3]  # films go through the transform of the body
    assert record["status"]["outcome"] == "ok" and np.abs(there[-1][[0, 6]] - there[0][[0, 6]]).max() > 0.02
    expected = turned(start, angle(0.1)) + [0, 0, 0.3]
    np.testing.assert_allclose(there[-1][[0, 6]], expected, atol=2e-3 if "pull_N_per_m" in pin else 1e-5)


def test_a_film_of_pins_may_differ_where_nothing_is_pinned(program, tmp_path, film):
    whole = config({})
    whole["scene"]["bodies"][0].update(pins=[{"indices": [3], "motion": {"film": TURNS}}])
    assert bench(program, "check", write(tmp_path / "a.json", whole)).returncode == 0
    jumps = {**TURNS, "start_s": -0.05}  # at the time 0 it has turned
    whole["scene"]["bodies"][0]["pins"][0]["motion"]["film"] = jumps
    refused(bench(program, "check", write(tmp_path / "b.json", whole)), "pins/0/motion/film", "vertex 3", "do not jump")


# --- rest shapes


def pinned(rest: dict, **more) -> dict:
    """A planar sheet, pinned along one side, whose rest shape may grow."""
    sheet = {"name": "sheet", "mesh": {"generator": "grid", "n_x": 9, "n_y": 5, "size_x_m": 0.4, "size_y_m": 0.2},
             "limited": False, "pins": [{"box_m": [[-0.201, -1, -1], [-0.199, 1, 1]]}],
             "material": {"youngs_N_per_m": 200, "poisson": 0, "density_kg_per_m2": 0.2}, **rest}  # fmt: skip
    return {"schema": "barrierbench.config/1", "scene": {"planar": True, "gravity_m_per_s2": [0, 0, 0], "bodies": [sheet]},
            "formulation": {"name": "log", "d_hat_m": 0.005}, "integrator": {"name": "quasi_static"},
            "time": {"dt_s": 0.05, "steps": 10}, "passes": {"time": False}, "output": {"frames_every": 10}, **more}  # fmt: skip


GROW = {"generator": "grow", "factor_x": 1.5, "period_s": 1.0, "n_frames": 51, "duration_s": 0.5}


def end_of(program, folder, config) -> np.ndarray:
    record = run(program, folder, config)
    assert record["status"]["outcome"] == "ok", record["status"]
    return states(record, folder / "out")[-1]


def test_a_pinned_grid_grows_along_one_axis(program, tmp_path):
    """Blender's own example: pins stay, and the free side is carried away."""
    still = end_of(program, tmp_path / "still", pinned({}))
    grown = end_of(program, tmp_path / "grown", pinned({"rest_film": GROW}))
    x = still[:, 0] + 0.2  # from the pinned side
    np.testing.assert_allclose(grown[:, 0] + 0.2, 1.5 * x, atol=1e-4)
    np.testing.assert_allclose(grown[:, 1:], still[:, 1:], atol=1e-4)
    held = np.isclose(x, 0)
    assert held.sum() == 5 and (grown[held] == still[held]).all()


def test_a_rest_film_is_the_same_on_an_executor(program, tmp_path):
    cpu = end_of(program, tmp_path / "cpu", pinned({"rest_film": GROW}))
    host = end_of(program, tmp_path / "host", pinned({"rest_film": GROW}, device="host"))
    assert np.abs(cpu[:, 0]).max() > 0.25
    np.testing.assert_allclose(host, cpu, atol=1e-8)


def test_a_rest_shape_that_is_none_between_two_frames_is_said_before_the_first_step(program, tmp_path, film):
    sheet = pinned({})
    points = np.array([[x, y, 0] for y in (-0.1, -0.05, 0, 0.05, 0.1) for x in np.linspace(-0.2, 0.2, 9)])
    out = tmp_path / "half_turn"
    out.mkdir()
    for k, sign in enumerate((1, -1)):  # half a turn: all is on one line in between
        (out / f"rest_{k}.obj").write_text("".join("v %.17g %.17g %.17g\n" % tuple(p * [sign, 1, 1]) for p in points))
    sheet["scene"]["bodies"][0]["rest_film"] = {"file": str(out / "rest_0.obj"), "frame_s": 0.5}
    refused(bench(program, "check", write(tmp_path / "c.json", sheet)), "the rest shape at the end of step 4, 0.25 s", "triangle")


def test_a_rest_film_stands_beside_a_schedule_and_refuses_what_it_cannot_mean(program, tmp_path):
    material = {**pinned({})["scene"]["bodies"][0]["material"], "shrink_schedule": [{"time_s": 0.0, "factor": 1.0}, {"time_s": 0.5, "factor": 0.8}]}
    both = end_of(program, tmp_path / "both", pinned({"rest_film": GROW, "material": material}))
    film = end_of(program, tmp_path / "film", pinned({"rest_film": {**GROW, "factor_x": 1.2, "factor_y": 0.8}}))
    assert np.abs(film[:, 0]).max() > 0.25
    np.testing.assert_allclose(both, film, atol=1e-7)
    limited = pinned({"rest_film": GROW, "limited": True}, strain_limit={"limit": 0.1, "stiffness_policy": {"name": "fixed", "k_s_N_per_m": 5}})
    refused(bench(program, "check", write(tmp_path / "l.json", limited)), "rest_film", "a strain limit")
    mesh = pinned({})["scene"]["bodies"][0]["mesh"]
    refused(bench(program, "check", write(tmp_path / "m.json", pinned({"rest_film": GROW, "rest_mesh": mesh}))), "one of both")
    refused(bench(program, "check", write(tmp_path / "g.json", pinned({"rest_film": {**GROW, "factor_x": -1}}))), "factor_x")

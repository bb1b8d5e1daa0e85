"""Starts that cross: check lists every crossing with its place, untangle repairs what it can by a motion near the least, and refuses or names the rest."""

import csv
import json
import math

import pytest

from barrierbench_analysis.io.frames import read_frame
from tests import bench_call

MATERIAL = {"model": "corotational", "youngs_N_per_m": 250, "poisson": 0.24, "density_kg_per_m2": 0.15}
D_HAT = 0.005
GAP = 0.1 * D_HAT  # that every pair has after a repair
GROUND = {"name": "ground", "kind": "plane", "point_m": [0, 0, 0], "axis": [0, 0, 1]}


def bench(program, *words):
    return bench_call.bench(*words, program=program)


def body(name, mesh, pins=(), material=MATERIAL, **transform):
    made = {"name": name, "mesh": mesh, "limited": False, "material": material, "transform": transform}
    return made | ({"pins": list(pins)} if pins else {})


def sheet(name, n=5, size=1.0, **more):
    return body(name, {"generator": "grid", "n_x": n, "n_y": n, "size_x_m": size, "size_y_m": size}, **more)


def cube(name, size=1.0, **more):
    return body(name, {"generator": "box", "size_x_m": size, "size_y_m": size, "size_z_m": size}, **more)


def config(folder, *bodies, obstacles=()):
    scene = {"name": "bodies", "bodies": list(bodies)} | ({"obstacles": list(obstacles)} if obstacles else {})
    policy = {"name": "fixed", "kappa_N_per_m": 50}
    made = {"schema": "barrierbench.config/1", "formulation": {"name": "log", "d_hat_m": D_HAT, "stiffness_policy": policy},
            "time": {"dt_s": 0.001, "steps": 1}, "scene": scene}
    path = folder / "start.json"
    path.write_text(json.dumps(made))
    return path


def obj(folder, name, vertices, cells):
    """A mesh file of triangles, or of lone edges."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices]
    lines += [("f " if len(cell) == 3 else "l ") + " ".join(str(v + 1) for v in cell) for cell in cells]
    (folder / f"{name}.obj").write_text("\n".join(lines) + "\n")
    return {"file": f"{name}.obj"}


def two_triangles(folder):
    """The second reaches 0.1 m through the first with one corner."""
    flat = obj(folder, "flat", [(-1.0, -1.0, 0.0), (1.5, -1.0, 0.0), (0.0, 1.5, 0.0)], [(0, 1, 2)])
    up = obj(folder, "up", [(0.0, 0.0, -0.1), (0.2, 0.1, 1.0), (-0.2, 0.1, 1.0)], [(0, 1, 2)])
    return [body("flat", flat), body("up", up)]


def folded(folder):
    """A strip that comes back over itself and reaches through its own beginning with its end."""
    n, rows = 13, []
    for i in range(n):
        turn = min(i, 8) / 8 * math.pi * 1.12
        x, z = 0.5 * math.sin(turn), 0.5 * (1 - math.cos(turn))
        if i > 8:
            x, z = x - 0.15 * (i - 8) * math.cos(0.12 * math.pi), z - 0.27 * (i - 8)
        rows.append((x, z))
    vertices = [(x, 0.2 * k - 0.2 + 0.013 * (i % 2), z) for i, (x, z) in enumerate(rows) for k in range(3)]
    vertices += [(-0.7 + 0.0 * k, 0.2 * k - 0.2, 0.0) for k in range(3)]
    cells = []
    for i in range(n - 1):
        for k in range(2):
            a = 3 * i + k
            cells += [(a, a + 3, a + 1), (a + 1, a + 3, a + 4)]
    far = 3 * n
    for k in range(2):
        cells += [(far + k, k, far + k + 1), (far + k + 1, k, k + 1)]
    return [body("strip", obj(folder, "strip", vertices, cells))]


def rod_through_sheet(_):
    """A rod upright, 0.06 m of it below the sheet."""
    rod = {"line_density_kg_per_m": 0.05, "rod_stretching_N": 20, "rod_bending_N_m2": 1e-5}
    mesh = {"generator": "rod", "n_segments": 7, "length_m": 0.5}
    upright = {"axis": [0, 1, 0], "angle_deg": -90, "translate_m": [0.03, 0.02, 0.19]}
    return [sheet("sheet"), body("rod", mesh, material=rod, **upright)]


def tangle(_):
    """Five cards about one place."""
    axes, angles = ([1, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]), (90, 75, 60, 50, 40)
    return [sheet(f"card{i}", 4, 0.5, axis=axes[i], angle_deg=angles[i], translate_m=[0.05 * i, 0.03 * i, 0.02 * i]) for i in range(5)]


SHEET, CARD, CUBE = 0.15, 0.25 * 0.15, 6 * 0.15  # kg, of 0.15 kg/m^2
STARTS = {  # bodies, obstacles; by how much they overlap along the axis with the smallest overlap (m), and the masses of both (kg)
    "two triangles": (two_triangles, (), None),
    "card through card": (lambda _: [sheet("table"), sheet("card", 5, 0.5, axis=[1, 0, 0], angle_deg=90, translate_m=[0.03, 0.02, 0.24])], (), (0.01, SHEET, CARD)),
    "sheet through cube": (lambda _: [cube("cube"), sheet("sheet", 9, 2.0, translate_m=[0.03, 0.02, 0.45])], (), (0.05, CUBE, 4 * SHEET)),
    "card below a plane": (lambda _: [sheet("card", 5, 0.5, translate_m=[0, 0, -0.02])], (GROUND,), (0.02, CARD, math.inf)),
    "two cubes": (lambda _: [cube("low"), cube("high", translate_m=[0.05, 0.03, 0.9])], (), (0.1, CUBE, CUBE)),
    "strip through itself": (folded, (), None),
    "rod through sheet": (rod_through_sheet, (), None),
    "five cards": (tangle, (), None),
}


def repaired(program, folder, bodies, obstacles=(), *more):
    path = config(folder, *bodies, obstacles=obstacles)
    assert bench(program, "check", path).returncode == 2, "the start does not cross"
    done = bench(program, "untangle", path, "--out", folder / "out", *more)
    return done, folder / "out" / "config.json"


@pytest.mark.parametrize("name", STARTS)
def test_a_start_is_repaired_and_a_run_begins_from_it(program, tmp_path, name):
    make, obstacles, known = STARTS[name]
    done, out = repaired(program, tmp_path, make(tmp_path), obstacles)
    assert done.returncode == 0, done.stdout + done.stderr
    numbers = json.loads((out.parent / "repair.json").read_text())
    assert numbers["displacement_max_m"] > 0 and numbers["displacement_mass_norm"] > 0
    if known is not None:
        overlap, *masses = known
        way, mobility = overlap + GAP, sum(1 / mass for mass in masses)
        assert 0.999 * (way if math.inf in masses else way / 2) <= numbers["displacement_max_m"] <= 1.01 * way, numbers
        part = 1.001 if math.inf in masses else 0.8  # of the shift of both as they are: near the contact alone it takes less
        assert numbers["displacement_mass_norm"] <= part * way / mobility**0.5, numbers
    assert bench(program, "check", out).returncode == 0
    ran = bench(program, "run", out, "--out", tmp_path / "run")
    assert ran.returncode == 0, ran.stderr
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"]["outcome"] == "ok"


def crossings_of(program, path, folder):
    """Of check: rows of --pairs of the kind crossing, and what it printed."""
    done = bench(program, "check", path, "--pairs", folder / "pairs.csv", "--export", folder / "marks.ply")
    with (folder / "pairs.csv").open(newline="") as file:
        return [row for row in csv.DictReader(file) if row["kind"] == "crossing"], done


def test_check_lists_every_crossing_by_bodies_with_its_place_and_marks_it(program, tmp_path):
    card = sheet("card", 5, 0.5, axis=[1, 0, 0], angle_deg=90, translate_m=[0.03, 0.02, 0.24])
    path = config(tmp_path, sheet("table"), card)
    rows, done = crossings_of(program, path, tmp_path)
    assert len(rows) > 4 and {row["bodies"] for row in rows} == {"card|table"}
    assert all(abs(float(row["z_m"])) < 1e-9 and abs(float(row["y_m"]) - 0.02) < 1e-9 for row in rows), "places of the crossings"
    assert f"{len(rows)} crossings" in done.stderr and "card|table" in done.stderr and "more" in done.stderr
    assert len(done.stderr.splitlines()) < 20 and done.returncode == 2 and not done.stdout
    frame = read_frame(tmp_path / "marks.ply")
    marked = frame.of_vertices["crossing"]
    assert 0 < marked.sum() < len(marked) and set(frame.of_vertices["body"][marked == 1]) == {0, 1}


def test_a_start_of_which_all_that_crosses_is_pinned_is_refused_by_pair(program, tmp_path):
    card = sheet("card", 5, 0.5, axis=[1, 0, 0], angle_deg=90, translate_m=[0.03, 0.02, 0.15], pins=[{"indices": list(range(20))}])
    path = config(tmp_path, sheet("table", pins=[{"all": True}]), card)
    done = bench(program, "untangle", path, "--out", tmp_path / "out")
    assert done.returncode == 2 and "prescribed" in done.stderr and "card[" in done.stderr and "table[" in done.stderr
    assert not list(tmp_path.glob("out*"))


def test_an_unrepairable_start_is_named_with_its_place_and_its_pin_and_nothing_is_written(program, tmp_path):
    """A pinned triangle through the middle of a sheet whose border is pinned: neither can leave, and edges keep their lengths."""
    spike = obj(tmp_path, "spike", [(0.0, 0.0, -0.2), (0.0, 0.0, 0.2), (0.013, 0.2, 0.0)], [(0, 1, 2)])
    net = sheet("net", 3, 0.3, pins=[{"indices": [0, 1, 2, 3, 5, 6, 7, 8]}])
    path = config(tmp_path, net, body("spike", spike, pins=[{"all": True}], translate_m=[0.021, -0.07, 0]), sheet("free", translate_m=[0, 0, 9]))
    done = bench(program, "untangle", path, "--out", tmp_path / "out", "--iterations", 50)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "net|spike" in done.stdout and ") m" in done.stdout and "prescribed and never moves" in done.stdout
    assert not list(tmp_path.glob("out*"))


def test_pins_stay_to_the_bit(program, tmp_path):
    card = sheet("card", 5, 0.5, axis=[1, 0, 0], angle_deg=90, translate_m=[0.03, 0.02, 0.24], pins=[{"top_row": True}])
    done, out = repaired(program, tmp_path, [sheet("table"), card])
    assert done.returncode == 0, done.stdout + done.stderr
    starts = []
    for name, path in ("before", tmp_path / "start.json"), ("after", out):
        bench(program, "check", path, "--start-frame", tmp_path / name)
        starts.append(read_frame(tmp_path / name / "frames" / "start.ply"))
    before, after = (frame.vertices[25:] for frame in starts)
    top = before[:, 2] == before[:, 2].max()
    assert top.sum() == 5 and (before[top] == after[top]).all()
    assert json.loads(out.read_text())["scene"]["bodies"][0]["mesh"] != json.loads((tmp_path / "start.json").read_text())["scene"]["bodies"][0]["mesh"]


def test_a_folder_that_is_there_and_scenes_that_are_no_bodies_are_refused(program, tmp_path):
    path = config(tmp_path, sheet("table"))
    (tmp_path / "out").mkdir()
    done = bench(program, "untangle", path, "--out", tmp_path / "out")
    assert done.returncode == 2 and "there already" in done.stderr
    path.write_text(json.dumps({"schema": "barrierbench.config/1", "scene": {"name": "drape2d"}, "formulation": "log"}))
    done = bench(program, "untangle", path, "--out", tmp_path / "new")
    assert done.returncode == 2 and "bodies" in done.stderr and not (tmp_path / "new").exists()


def test_a_folder_may_end_with_a_slash_and_folders_of_others_beside_it_stay(program, tmp_path):
    path = config(tmp_path, *two_triangles(tmp_path))
    beside = tmp_path / "out.part"
    beside.mkdir()
    (beside / "mine.txt").write_text("mine")
    done = bench(program, "untangle", path, "--out", f"{tmp_path}/out/")
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "out/config.json").is_file() and (beside / "mine.txt").read_text() == "mine"
    assert sorted(one.name for one in tmp_path.glob("out*")) == ["out", "out.part"]


def test_layers_within_their_thickness_are_moved_apart(program, tmp_path):
    """Half thicknesses of 20 mm each, 10 mm apart: each has to go at least 15.25 mm, gap included."""
    layers = [sheet(name, 4, 0.5, translate_m=[0.01 * k, 0, 0.01 * k]) | {"offset_m": 0.02} for k, name in enumerate(("low", "high"))]
    done, out = repaired(program, tmp_path, layers)
    assert done.returncode == 0, done.stdout + done.stderr
    most = json.loads((out.parent / "repair.json").read_text())["displacement_max_m"]
    assert 0.999 * (0.03 + GAP) / 2 <= most <= 1.01 * (0.03 + GAP), most
    assert bench(program, "check", out).returncode == 0


def test_a_thick_net_that_cannot_leave_is_not_called_repaired(program, tmp_path):
    """Its middle alone can move, and would have to go farther than its edges allow."""
    spike = obj(tmp_path, "spike", [(0.0, 0.0, 0.0), (0.05, 0.02, 0.2), (-0.05, 0.02, 0.2)], [(0, 1, 2)])
    net = sheet("net", 3, 0.3, pins=[{"indices": [0, 1, 2, 3, 5, 6, 7, 8]}]) | {"offset_m": 0.05}
    held = body("spike", spike, pins=[{"all": True}], translate_m=[0, 0, 0.02]) | {"offset_m": 0.05}
    path = config(tmp_path, net, held, sheet("free", translate_m=[0, 0, 9]))
    done = bench(program, "untangle", path, "--out", tmp_path / "out", "--iterations", 50, "--stretch", 0.01)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "net|spike" in done.stdout and not list(tmp_path.glob("out*"))


@pytest.mark.parametrize("at_most", [100, 3000])
def test_a_full_disk_leaves_no_folder_behind(program, tmp_path, at_most):
    path = config(tmp_path, sheet("card", 5, 0.5, translate_m=[0, 0, -0.02]), obstacles=[GROUND])
    done = bench_call.bench("untangle", path, "--out", tmp_path / "out", program=program, at_most=at_most)
    assert done.returncode == 75 and "out" in done.stderr, done.stderr
    assert not list(tmp_path.glob("out*"))


def test_the_start_is_drawn_with_what_crosses(program, tmp_path):
    path = config(tmp_path, sheet("table"), sheet("card", 5, 0.5, axis=[1, 0, 0], angle_deg=90, translate_m=[0.03, 0.02, 0.24]))
    done = bench(program, "draw", "still", path, "--color", "crossing", "--size", 64, 48, "--out", tmp_path / "start.png")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "start.png").stat().st_size > 0 and "crosses" in (tmp_path / "start.txt").read_text()

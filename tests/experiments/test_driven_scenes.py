"""The scenes of driven things against what a pencil says of them: a strip that is twisted, a curtain in the wind, a balloon that is let go."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from test_cli import bench

from barrierbench_analysis.io.frames import frame_of
from barrierbench_analysis.io.record_file import read_record

SCENES = Path(__file__).resolve().parents[2] / "configs/scenes"
G = 9.81  # m/s^2
both = pytest.mark.parametrize("formulation", ["log", "cubic"])


class Run:
    def __init__(self, program, folder, scene, formulation, every=1):
        words = ("--set", f'/formulation/name="{formulation}"', "--set", f"/output/frames_every={every}")
        done = bench(program, "run", SCENES / f"{scene}.json", "--out", folder, "--progress", "none", *words)
        assert done.returncode == 0, done.stderr
        self.folder, self.config = folder, json.loads((SCENES / f"{scene}.json").read_text())
        self.record = read_record(folder / "run.json")
        assert self.record["status"]["outcome"] == "ok", self.record["status"]
        assert self.record["audit"]["judged"] > 0
        self.steps = self.record["steps"]

    def at(self, step):
        return frame_of(self.record, self.folder, step).vertices

    def load(self, step):
        return self.steps[step]["contact_load_sum_N"] or 0


@both
def test_a_strip_is_twisted_alike_from_both_ends(program, tmp_path, formulation):
    run = Run(program, tmp_path, "twist_cloth", formulation)
    start, end = run.at(-1), run.at(74)
    for side, where in ((-1, start[:, 0] < -0.19), (1, start[:, 0] > 0.19)):
        assert where.sum() == 7
        for step in (34, 69, 74):
            share = min((step + 1) * 0.01 / 0.7, 1)
            angle, way = side * 3 * math.pi * share, -side * 0.028 * share
            expected = start[where] + [way, 0, 0]
            y = start[where][:, 1]
            expected[:, 1], expected[:, 2] = y * math.cos(angle), y * math.sin(angle)
            np.testing.assert_allclose(run.at(step)[where], expected, atol=1e-14)
    assert run.load(69) > 1, "N, it presses on itself"
    # half a turn about z takes the start onto itself, vertex i onto the last but i: equal and opposite torques keep it so,
    # until it buckles to one side, and once more when it is wound up
    assert run.load(18) > 0.1
    for step, tolerance in ((18, 1e-12), (74, 1e-4)):
        there = run.at(step)
        np.testing.assert_allclose(there[::-1] * [-1, -1, 1], there, atol=tolerance)
    middle = np.abs(start[:, 0]) < 0.03
    assert np.abs(start[middle][:, 1]).max() == pytest.approx(0.075)
    assert 0.005 < np.linalg.norm(end[middle][:, 1:], axis=1).max() < 0.03, "a coil"


@both
def test_a_curtain_hangs_where_drag_balances_weight_and_is_blown_against_the_wall(program, tmp_path, formulation):
    run = Run(program, tmp_path, "curtain_wind", formulation)
    start, rest = run.at(-1), run.at(149)
    top = start[:, 2] > 0.19
    assert top.sum() == 9
    np.testing.assert_allclose(run.at(148), rest, atol=2e-5)
    normal, tangential, wind, density, area, stiffness = 2, 0.2, 0.5, 0.2, 0.16, 2
    slope = normal * wind / (density * G)  # of the angle to the vertical: normal parts of drag and weight
    hang = rest[~top] - rest[top].mean(axis=0)
    np.testing.assert_allclose(hang[:, 0] / -hang[:, 2], slope, rtol=0.01)
    angle = math.atan(slope)
    across, along = normal * wind * math.cos(angle), tangential * wind * math.sin(angle)  # N/m^2
    force = area * np.array([across * math.cos(angle) + along * math.sin(angle), 0,
                             across * math.sin(angle) - along * math.cos(angle) - density * G])
    pulled = stiffness * (rest[top] - start[top]).sum(axis=0)
    assert pulled[0] > 0.05 and pulled[2] < -0.2
    np.testing.assert_allclose(pulled, force, atol=0.01 * np.linalg.norm(force))
    assert run.load(149) == 0 and run.steps[149]["gap_min_m"] is None
    assert run.load(209) > 0.01 and 0 < run.steps[209]["gap_min_m"] < 0.005
    assert run.at(209)[:, 0].max() == pytest.approx(0.3 - run.steps[209]["gap_min_m"], abs=1e-12)


@both
def test_a_balloon_swells_is_released_and_comes_to_lie(program, tmp_path, formulation):
    run = Run(program, tmp_path, "balloon", formulation)
    start, swollen = run.at(-1), run.at(59)
    ball = slice(0, len(start) - 25)
    n = len(start) - 25
    corners = frame_of(run.record, run.folder, -1).triangles
    corners = corners[corners.max(axis=1) < n]

    def volume(x):
        x = x - x[ball].mean(axis=0)
        return np.linalg.det(x[corners]).sum() / 6

    x = start[corners]
    areas = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1) / 2
    area = areas.sum()
    # a sphere scaled by s: membrane area 2 E/(1 - nu) (s - 1) and pulls k n R^2 (s - 1) against 3 p V s^2
    stiffness = area * 2 * 100 / 0.7 + 0.5 * n * 0.1**2
    b, c = stiffness, 3 * 100 * volume(start)
    s = (b - math.sqrt(b * b - 4 * b * c)) / (2 * c)
    assert s > 1.03
    assert (volume(swollen) / volume(start)) ** (1 / 3) == pytest.approx(s, rel=2e-3)
    # let go: the centre of all falls, whatever pressure, stitch and contact do between its parts
    assert 0 < run.load(64) < 0.5
    mass = np.zeros(len(start))
    np.add.at(mass, corners, np.repeat(0.2 * areas[:, None] / 3, 3, axis=1))
    sheet = frame_of(run.record, run.folder, -1).triangles
    sheet = sheet[sheet.min(axis=1) >= n]
    np.add.at(mass, sheet, 0.1 * 0.06**2 / len(sheet) / 3)
    fall = [mass @ run.at(step)[:, 2] / mass.sum() for step in (62, 63, 64)]
    speed = (fall[1] - fall[0]) / 0.005
    damped = speed * (0.8**0.005 - 1) / 0.005 - G
    assert speed < -0.05
    assert (fall[2] - 2 * fall[1] + fall[0]) / 0.005**2 == pytest.approx(damped, rel=1e-4)
    # on the floor it has come to rest, and the floor bears the weight
    end = run.at(119)
    assert 0 < end[:, 2].min() < 0.002
    assert run.load(119) > 0
    stitched = run.config["scene"]["stitches"][0]
    before = np.linalg.norm(start[n + stitched["a_vertices"][0]] - start[stitched["b_vertices"][0]])
    after = np.linalg.norm(end[n + stitched["a_vertices"][0]] - end[stitched["b_vertices"][0]])
    assert before > 0.019 and after < 0.003

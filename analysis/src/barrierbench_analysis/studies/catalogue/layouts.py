"""Where the copies of a body stand. A body of the catalogue may have `copies`: {"layout": NAME,
parameters}; the rigid motion of each copy comes after the body's own `transform`. A layout is one function
here and a word of LAYOUTS.
"""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from .named import call

Place = tuple[Rotation, np.ndarray]  # x -> rotation x + translation (m)


def _about(axis, angle_deg: float) -> Rotation:
    return Rotation.from_rotvec(math.radians(angle_deg) * np.array(axis, float) / np.linalg.norm(axis))


def row(count: int, step_m: list, turn_deg: float = 0.0, axis: list = (0, 0, 1)) -> Iterator[Place]:
    """The k-th is k steps away, turned k times."""
    for k in range(count):
        yield _about(axis, k * turn_deg), k * np.array(step_m, float)


def grid(counts: list, step_m: list, lift_m: float = 0.0) -> Iterator[Place]:
    """About the z axis; raised by lift sin^2 of the distance (m) from it."""
    for i in range(counts[0]):
        for j in range(counts[1]):
            x = step_m[0] * (i - 0.5 * (counts[0] - 1))
            y = step_m[1] * (j - 0.5 * (counts[1] - 1))
            yield Rotation.identity(), np.array([x, y, lift_m * math.sin(math.hypot(x, y)) ** 2])


SPIRAL_POINTS = 4096


def spiral(count: int, spacing_m: float) -> Iterator[Place]:
    """The first `count` places farther than the spacing from the one before, on two turns whose radius
    falls from 1 m to 0.5 m; x of a body points along it. Formula of the scene domino of Ando 2024, with z
    up.
    """
    last, made = None, 0
    for i in reversed(range(SPIRAL_POINTS)):
        angle = 4 * math.pi * i / SPIRAL_POINTS - math.pi / 2
        radius = 0.5 + 0.5 * i / SPIRAL_POINTS
        at = np.array([-radius * math.cos(angle), -radius * math.sin(angle), 0.0])
        if last is not None and np.linalg.norm(at - last) <= spacing_m:
            continue
        if made == count:
            return
        last, made = at, made + 1
        yield Rotation.from_rotvec([0, 0, angle + math.pi / 2]), at


def house_of_cards(rows: int, height_m: float, lean_deg: float, gap_m: float) -> Iterator[Place]:
    """Of cards in the y-z plane, `height` along z: rows of pairs that lean against each other, `rows` of
    them in the lowest, one fewer in each above; flat cards on neighbouring pairs, every second one a gap
    higher; next cards are `gap` apart.
    """
    lean = math.radians(lean_deg)
    half_width, half_height = 0.5 * height_m * math.sin(lean), 0.5 * height_m * math.cos(lean)
    pitch = 4 * half_width + 2 * gap_m  # of the pairs of a row
    floor = gap_m
    for n in range(rows, 0, -1):
        first = -0.5 * pitch * (n - 1)
        for k in range(n):
            for side in (-1, 1):
                x = first + k * pitch + side * (half_width + 0.5 * gap_m)
                yield _about((0, 1, 0), -side * lean_deg), np.array([x, 0, floor + half_height])
        top = floor + 2 * half_height + gap_m
        for k in range(n - 1):
            x = first + (k + 0.5) * pitch
            yield _about((0, 1, 0), 90), np.array([x, 0, top + gap_m * (k % 2)])
        floor = top + 2 * gap_m if n > 2 else top + gap_m


LAYOUTS = (row, grid, spiral, house_of_cards)


def places(copies: dict, path: Path, where: str) -> Iterator[Place]:
    """Of `copies` at its place in a file. Errors: as call."""
    return call(LAYOUTS, "layout", copies, path, where)()


def placed(transform: dict, place: Place) -> dict:
    """The transform of a config that is the body's own and then the place."""
    rotation, translation = place
    own = _about(transform.get("axis", [0, 0, 1]), transform.get("angle_deg", 0.0))
    at = rotation.apply(np.array(transform.get("translate_m", [0, 0, 0]), float)) + translation
    turn = (rotation * own).as_rotvec()
    angle = float(np.linalg.norm(turn))
    out = {key: value for key, value in transform.items() if key == "scale"}
    if angle > 1e-12:
        out |= {"axis": [float(c) for c in turn / angle], "angle_deg": math.degrees(angle)}
    return out | {"translate_m": [float(c) for c in at]}

"""Geometry of a scene of PolyFEM: transformed meshes, and which sides of them a selection names.

The meaning of keys is that of json-specs/input-spec.json, GeometryReader.cpp and Selection.cpp of
polyfem/polyfem at 661588e8d9.
"""

from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import is_number
from barrierbench_analysis.program.mesh_arrays import MeshArrays, read_body_file
from barrierbench_analysis.program.trajectories.trajectory import surface_of

from .card import Card
from .config import cells_of
from .motions import turned_about

LENGTHS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 1e-3, "um": 1e-6, "km": 1e3, "in": 0.0254, "ft": 0.3048}
SELECTION_KEYS = (
    "id axis position relative boundary_only box center radius p1 p2 point normal offset"
    " threshold id_offset file"
).split()
MODES = "letters of xyz, axis_angle or rotation_vector"
PLACES = ("translation", "rotation", "rotation_mode", "scale", "dimensions")


def numbers(card: Card, pointer: str, value, count: int, rest: float) -> np.ndarray:
    """An array of up to `count` numbers, filled up with `rest`. Errors: UserError."""
    if not isinstance(value, list) or not all(map(is_number, value)):
        raise card.refuse(pointer, value, f"an array of {count} numbers")
    if len(value) > count:
        raise card.refuse(pointer, value, f"at most {count} numbers")
    return np.array([*map(float, value), *[rest] * (count - len(value))])


def direction(card: Card, pointer: str, value) -> np.ndarray:
    """A vector of three numbers that has a length, made 1. Errors: UserError."""
    found = numbers(card, pointer, value, 3, 0.0)
    if not found.any():
        raise card.refuse(pointer, value, "three numbers that are not all 0")
    return found / np.linalg.norm(found)


def number_of(card: Card, pointer: str, value, whole: bool = False) -> float:
    """A number of a selection. Errors: UserError."""
    if not is_number(value) or (whole and not isinstance(value, int)):
        raise card.refuse(pointer, value, "a whole number" if whole else "a number")
    return value


def rotation_of(card: Card, pointer: str, angles, mode: str) -> np.ndarray:
    """A rotation as PolyFEM has it: turns in degrees about x, y and z in the order of the letters, an axis
    behind an angle, a rotation vector in degrees. Errors: UserError.
    """
    if not isinstance(mode, str):
        raise card.refuse(f"{pointer}_mode", mode, MODES)
    mode = mode.lower()
    if angles == []:
        return np.eye(3)
    if isinstance(angles, (int, float)) and mode in ("x", "y", "z"):
        angles = [angles if axis == mode else 0.0 for axis in "xyz"]
    if mode == "axis_angle":
        angle, *axis = numbers(card, pointer, angles, 4, 0.0)
        return _turn(np.array(axis), angle)
    found = numbers(card, pointer, angles, 3, 0.0)
    if mode == "rotation_vector":
        return _turn(found, np.linalg.norm(found))
    if not mode or set(mode) - set("xyz"):
        raise card.refuse(f"{pointer}_mode", mode, MODES)
    rotation = np.eye(3)
    for axis in mode:
        number = "xyz".index(axis)
        rotation = _turn(np.eye(3)[number], found[number]) @ rotation
    return rotation


def _turn(axis: np.ndarray, degrees: float) -> np.ndarray:
    length = np.linalg.norm(axis)
    if length == 0:
        return np.eye(3)
    return turned_about(np.eye(3), np.zeros(3), axis / length, np.deg2rad(degrees)).T


def placed(card: Card, at: str, one: dict, points: np.ndarray, unit: float) -> np.ndarray:
    """Points of a file after the transformation of its geometry: scale, rotation about the origin,
    translation. unit: of the file, in that of the scene. Errors: UserError.
    """
    how = one.get("transformation") or {}
    if not isinstance(how, dict):
        raise card.refuse(f"{at}/transformation", how, "an object")
    here = f"{at}/transformation"
    if isinstance(how.get("dimensions"), list):
        size = np.ptp(points, axis=0)
        wanted = numbers(card, f"{here}/dimensions", how["dimensions"], 3, 0.0)
        scale = wanted / np.where(size == 0, 1, size)
    elif isinstance(how.get("scale"), (int, float)):
        scale = np.full(3, float(how["scale"]))
    else:
        given = how.get("scale") or []
        scale = numbers(card, f"{here}/scale", given, 3, 0.0) if given else np.ones(3)
    rotation = rotation_of(card, f"{here}/rotation", how.get("rotation", []), how.get("rotation_mode", "xyz"))
    shift = numbers(card, f"{here}/translation", how.get("translation", []), 3, 0.0)
    for key in PLACES:
        if key in how:
            card.mapped(f"{here}/{key}", "the mesh file of the body", "applied to its vertices")
    return (points * unit * scale) @ rotation.T + shift


def mesh_of(card: Card, at: str, one: dict, root: Path, unit: str) -> MeshArrays:
    """The mesh of a geometry in the unit of length of the scene. Errors: UserError."""
    name = one.get("mesh")
    if not isinstance(name, str):
        raise card.refuse(f"{at}/mesh", name, "the path of a mesh file")
    path = root / name
    try:
        found = read_body_file(path)
    except UserError as error:
        raise UserError(f"{card.source}#{at}/mesh: {error}") from None
    own = one.get("unit") or unit
    if not isinstance(own, str) or own not in LENGTHS:
        raise card.refuse(f"{at}/unit", own, ", ".join(LENGTHS))
    points = placed(card, at, one, found.points, LENGTHS[own] / LENGTHS[unit])
    card.mapped([f"{at}/{key}" for key in ("mesh", "type", "unit", "enabled")], "/scene/bodies/N/mesh")
    return cells_of(points, found.triangles, found.segments, found.tetrahedra)


def sides_of(card: Card, at: str, selection, cells: MeshArrays) -> dict[int, np.ndarray]:
    """Vertices of the sides of the surface that each number is given to: the first operation wins whose
    region holds the centre of a side. Errors: UserError for an operation that is none.
    """
    faces = surface_of(cells)
    if isinstance(selection, int):
        return {selection: np.unique(faces)}
    operations = [selection] if isinstance(selection, dict) else selection
    if not isinstance(operations, list):
        raise card.refuse(at, selection, "a number, or operations with an id")
    centers = cells.points[faces].mean(axis=1)
    low, high = cells.points.min(axis=0), cells.points.max(axis=0)
    ids = np.zeros(len(faces), int)
    free = np.ones(len(faces), bool)
    for number, one in enumerate(operations):
        place = f"{at}/{number}" if isinstance(selection, list) else at
        if not isinstance(one, dict):
            raise card.refuse(place, one, "an object with id and a region")
        if "threshold" in one:
            ids[free] = _box_sides(card, place, one, centers, low, high)[free]
            free[:] = False
            continue
        inside = free & _inside(card, place, one, centers, low, high)
        ids[inside] = int(one["id"])
        free &= ~inside
    return {int(one): np.unique(faces[ids == one]) for one in np.unique(ids) if one != 0}


def selected(at: str, selection) -> list[str]:
    """What the operations of a selection may say."""
    if isinstance(selection, int):
        return [at]
    places = [f"{at}/{k}" for k in range(len(selection))] if isinstance(selection, list) else [at]
    return [f"{place}/{key}" for place in places for key in SELECTION_KEYS]


def _box_sides(
    card: Card, at: str, one: dict, centers: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    near = number_of(card, f"{at}/threshold", one["threshold"])
    near = 1e-7 if near < 0 else near  # what PolyFEM takes below 0
    made = np.full(len(centers), 7)
    order = ((2, 1, 6), (2, 0, 5), (1, 1, 4), (0, 1, 3), (1, 0, 2), (0, 0, 1))  # the first ones win
    for axis, upper, number in order:
        made[np.abs(centers[:, axis] - (high if upper else low)[axis]) < near] = number
    return made + number_of(card, f"{at}/id_offset", one.get("id_offset", 0), whole=True)


def axis_of(card: Card, pointer: str, value) -> int:
    """1, 2 or 3 for x, y or z, with a sign. Errors: UserError."""
    if isinstance(value, str) and value.removeprefix("-").removeprefix("+").lower() in ("x", "y", "z"):
        return (-1 if value[0] == "-" else 1) * ("xyz".index(value[-1].lower()) + 1)
    if is_number(value) and isinstance(value, int) and 1 <= abs(value) <= 3:
        return value
    raise card.refuse(pointer, value, "x, y, z or 1, 2, 3, also with - before it")


def _inside(card: Card, at: str, one: dict, p: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Which of the points p are in the region of an operation."""
    if not isinstance(one.get("id"), int):
        raise card.refuse(f"{at}/id", one.get("id"), "a whole number")
    size = high - low
    relative = bool(one.get("relative", False))

    def point(key: str) -> np.ndarray:
        value = numbers(card, f"{at}/{key}", one[key], 3, 0.0)
        return size * value + low if relative else value

    def length(key: str) -> float:
        found = number_of(card, f"{at}/{key}", one[key])
        return found * (float(np.linalg.norm(size)) if relative else 1.0)

    if "box" in one:
        if not isinstance(one["box"], list) or len(one["box"]) != 2:
            raise card.refuse(f"{at}/box", one["box"], "two corners of three numbers each")
        corners = [numbers(card, f"{at}/box", row, 3, 0.0) for row in one["box"]]
        first, last = ([size * c + low for c in corners]) if relative else corners
        return ((p >= first) & (p <= last)).all(axis=1)
    if "center" in one and "radius" in one:
        return np.linalg.norm(p - point("center"), axis=1) <= length("radius")
    if "p1" in one and "p2" in one and "radius" in one:
        first, way = point("p1"), point("p2") - point("p1")
        if not way.any():
            raise card.refuse(f"{at}/p2", one["p2"], "another point than p1")
        along = (p - first) @ way / np.linalg.norm(way)
        across = np.linalg.norm(p - first - along[:, None] * way / np.linalg.norm(way), axis=1)
        return (along >= 0) & (along <= np.linalg.norm(way)) & (across <= length("radius"))
    if "axis" in one and "position" in one:
        axis = axis_of(card, f"{at}/axis", one["axis"])
        number = abs(axis) - 1
        place = number_of(card, f"{at}/position", one["position"])
        place = place * size[number] + low[number] if relative else place
        return p[:, number] >= place if axis > 0 else p[:, number] <= place
    if "normal" in one:
        normal = direction(card, f"{at}/normal", one["normal"])
        offset = number_of(card, f"{at}/offset", one.get("offset", 0.0))
        start = point("point") if "point" in one else normal * offset
        return (p - start) @ normal >= 0
    raise card.refuse(at, sorted(one), "box, center and radius, p1, p2 and radius, axis and position, normal")

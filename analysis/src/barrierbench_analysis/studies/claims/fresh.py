"""Whether a scene of a confirmation sweep is one that no tuning sweep used: by its definition, not by its
label.
"""

import copy
import json
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.digests import of_file, of_text
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_json, read_object

from .entry import ROOT, Sweep
from .merged import merged, put

# Where rules and thresholds were tuned, or could have been.
TUNING = (
    "claims/sweeps/*.json",
    "configs/sweeps/*.json",
    "configs/pareto/*.json",
    "configs/studies/pareto.json",
    "configs/work_precision/*.json",
    "configs/studies/work_precision.json",
    "configs/gates/*.json",
    "configs/stress/*.json",
    "configs/gap_map/*.json",
    "configs/studies/gap_map.json",
)
# Of a generated mesh `level`, `n` and all that begins with n_ is its resolution, and a finer mesh is no other
# scene; these numbers are its shape.
SHAPE = {"helix": {"n_turns"}, "woven_tube": {"n_axial", "n_rings"}, "knit": {"n_rows", "n_loops"}}
LEAST = 8  # confirmation scenes of a sweep


def _is_resolution(mesh: dict, key: str) -> bool:
    """Whether `key` of this mesh says how fine it is."""
    counts = key in ("n", "level") or key.startswith("n_")
    return counts and key not in SHAPE.get(mesh.get("generator"), ())


@cache
def _defaults() -> dict:
    return fields.schema("config")["properties"]["scene"]


def _plain(value, schema: dict, folder: Path):
    """A scene without names, without resolution, without what is a default, and with the contents of mesh
    files in the place of their paths.
    """
    if isinstance(value, list):
        return [
            _plain(one, schema.get("items", {}) if isinstance(schema.get("items"), dict) else {}, folder)
            for one in value
        ]
    if isinstance(value, bool) or not isinstance(value, dict):
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return float(value) + 0.0 if number else value  # -0.0 is 0
    rules, found = schema.get("properties", {}), {}
    for key, one in value.items():
        rule = rules.get(key, {})
        mesh = "generator" in value or "file" in value
        if (
            (key == "name" and "generator" not in value)
            or (mesh and _is_resolution(value, key))
            or ("default" in rule and one == rule["default"])
        ):
            continue
        file = folder / one if key == "file" and isinstance(one, str) else None
        found[key] = of_file(file) if file and file.is_file() else _plain(one, rule, folder)
    return found


def identity(scene: dict, folder: Path) -> str:
    """Canonical hash of what a scene is made of: bodies with meshes, materials, places and speeds, obstacles,
    gravity; in whatever order.
    """
    if scene.get("name") != "bodies":
        return of_text(json.dumps(scene, sort_keys=True))
    plain = _plain(scene, _defaults(), folder)
    for key in ("bodies", "obstacles"):
        if isinstance(plain.get(key), list):
            plain[key].sort(key=lambda one: json.dumps(one, sort_keys=True))
    return of_text(json.dumps(plain, sort_keys=True))


def _found(value, key: str) -> Iterator:
    """Everything that stands under a key, at any depth."""
    if isinstance(value, dict):
        for name, one in value.items():
            if name == key:
                yield one
            yield from _found(one, key)
    elif isinstance(value, list):
        for one in value:
            yield from _found(one, key)


def _bases(data: dict, path: Path) -> Iterator[dict]:
    for key in ("base", "config"):
        for name in _found(data, key):
            file = (path.parent / name).resolve() if isinstance(name, str) else path
            if file.suffix == ".json" and file.is_file() and file != path:
                yield from (scene for scene in _found(read_json(file), "scene") if isinstance(scene, dict))
    yield from (scene for scene in _found(data, "scene") if isinstance(scene, dict))


def _changed(scene: dict, pointers: dict) -> dict | None:
    made = {"scene": copy.deepcopy(scene)}
    try:
        for pointer, value in pointers.items():
            put(made, pointer, value)
    except (KeyError, IndexError, TypeError, ValueError):  # settings of another scene of the file
        return None
    return made["scene"]


def scenes_of(path: Path) -> list[dict]:
    """Every scene that a file of runs can make: its bases and whole scenes, with each of its settings of a
    scene, and with each two of them.
    """
    data = read_json(path)
    sets = [
        {p: v for p, v in one.items() if p.startswith("/scene")}
        for one in _found(data, "set")
        if isinstance(one, dict)
    ]
    whole = [one["/scene"] for one in sets if isinstance(one.get("/scene"), dict)]
    parts = [p for p in ({q: v for q, v in one.items() if q != "/scene"} for one in sets) if p]
    scenes = [*_bases(data, path), *whole]
    once = [made for scene in scenes for p in parts if (made := _changed(scene, p)) is not None]
    twice = (
        [made for scene in once for p in parts if (made := _changed(scene, p)) is not None]
        if len(once) * len(parts) < 5000
        else []
    )
    return [*scenes, *once, *twice]


def identities(path: Path) -> set[str]:
    """Of all scenes of bodies that a file of runs can make."""
    return {identity(scene, path.parent) for scene in scenes_of(path) if scene.get("name") == "bodies"}


@cache
def scenes_of_sweep(sweep: Sweep) -> frozenset[str]:
    """identities() of its file, worked out once for all claims that ask."""
    return frozenset(identities(sweep.path))


@cache
def used(root: Path = ROOT) -> dict[str, str]:
    """identity -> a file of runs that has the scene."""
    found: dict[str, str] = {}
    for path in (path for place in TUNING for path in sorted(root.glob(place))):
        found = dict.fromkeys(identities(path), str(path.relative_to(root))) | found
    return found


def shared(sweep: Sweep, others: Iterable[Sweep]) -> str:
    """The file of the first of the other sweeps that has a scene of this one; empty when none has."""
    mine = scenes_of_sweep(sweep)
    return next((one.file for one in others if mine & scenes_of_sweep(one)), "")


def check(sweep: Sweep, root: Path = ROOT, own: Iterable[Sweep] = ()) -> None:
    """own: sweeps that the claim itself was judged by before; one of them may have confirmed another claim.
    Errors: UserError when a scene is no `bodies` (whose definition is all written out), when it is one of a
    tuning sweep or of `own`, and when there are too few.
    """
    data = read_object(sweep.path)
    taken = {scene: one.file for one in own for scene in scenes_of_sweep(one)} | used(root)
    names = {case["label"].partition(" ")[0] for case in data["axes"][0]["cases"]}
    if len(names) < LEAST:
        raise UserError(f"{sweep.file}: {len(names)} scenes; a confirmation has at least {LEAST}")
    label_of: dict[str, str] = {}
    for case in data["axes"][0]["cases"]:
        scene = merged(data, sweep.path, case["set"])["scene"]
        if scene.get("name") != "bodies":
            raise UserError(
                f"{sweep.file}: {case['label']}: the scene is {scene.get('name')!r}; a confirmation scene is"
                " of bodies, all written out"
            )
        mine, label = identity(scene, sweep.path.parent), case["label"].partition(" ")[0]
        if label_of.setdefault(mine, label) != label:
            raise UserError(
                f"{sweep.file}: {case['label']}: its scene is that of {label_of[mine]}: a scene counts once"
            )
        if file := taken.get(mine):
            raise UserError(
                f"{sweep.file}: {case['label']}: its scene is one of {file}, where rules were tuned; labels"
                " and resolution make no other scene"
            )

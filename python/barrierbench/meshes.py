"""Meshes of a config that are numpy arrays: written as files, which is what the program reads and records name."""

from __future__ import annotations

import atexit
import hashlib
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core

CORNERS = {"triangles": 3, "segments": 2, "tetrahedra": 4}
ELEMENTS = {
    "triangles": ("face", "property list uchar int vertex_indices"),
    "segments": ("edge", "property int vertex1\nproperty int vertex2"),
    "tetrahedra": ("tetrahedron", "property list uchar int vertex_indices"),
}


def _array(where: str, given: Any, columns: int, kind: str) -> NDArray:
    """[n, columns] of numbers or of indices. Errors: ConfigError with the place."""
    try:
        array = np.asarray(given)
    except ValueError:
        array = np.asarray(None)
    right = array.ndim == 2 and array.shape[1] == columns and array.dtype.kind in kind
    if array.size == 0 and array.ndim <= 2:
        return np.zeros((0, columns), int)
    if not right:
        what = "numbers (m)" if "f" in kind else "vertex indices from 0"
        found = f"shape {array.shape} of {array.dtype}"
        raise _core.ConfigError(f"{where}: found {found}; allowed: [n, {columns}] {what}")
    return array


def _ply(where: str, mesh: Mapping[str, Any]) -> bytes:
    vertices = _array(f"{where}/vertices", mesh["vertices"], 3, "fiu").astype("<f8")
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property double {axis}" for axis in "xyz"]
    body = [vertices.tobytes()]
    for name, corners in CORNERS.items():
        indices = _array(f"{where}/{name}", mesh.get(name, ()), corners, "iu")
        if len(indices) and not 0 <= indices.min() <= indices.max() < len(vertices):
            found = f"{indices.min()} to {indices.max()}"
            raise _core.ConfigError(f"{where}/{name}: found {found}; allowed: 0 to {len(vertices) - 1}")
        element, properties = ELEMENTS[name]
        if len(indices) == 0 and name != "triangles":
            continue
        header += [f"element {element} {len(indices)}", properties]
        rows = np.zeros(len(indices), [("n", "u1"), ("of", "<i4", corners)])
        rows["n"], rows["of"] = corners, indices
        body.append((rows if "list" in properties else rows["of"]).tobytes())
    return "\n".join([*header, "end_header\n"]).encode() + b"".join(body)


@cache
def _scratch() -> Path:
    """For meshes of configs that leave no folder; goes with the process."""
    folder = Path(tempfile.mkdtemp(prefix="barrierbench-meshes-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _file(where: str, mesh: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The mesh as the config of the program has it. Errors: ConfigError; OSError."""
    content = _ply(where, mesh)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"mesh-{hashlib.sha256(content).hexdigest()[:16]}.ply"
    if not path.is_file():
        path.write_bytes(content)
    return {"file": str(path.resolve()), **{k: v for k, v in mesh.items() if k not in ("vertices", *CORNERS)}}


def _meshes(config: Mapping[str, Any]) -> Iterator[tuple[int, str, Mapping[str, Any]]]:
    """Number of the body, key and mesh of those that are arrays."""
    scene = config.get("scene")
    bodies = scene.get("bodies") if isinstance(scene, Mapping) else None
    for index, body in enumerate(bodies if isinstance(bodies, (list, tuple)) else ()):
        for name in ("mesh", "rest_mesh"):
            mesh = body.get(name) if isinstance(body, Mapping) else None
            if isinstance(mesh, Mapping) and "vertices" in mesh:
                yield index, name, mesh


def has_arrays(config: Mapping[str, Any]) -> bool:
    """Whether a mesh of the config is given as arrays."""
    return any(True for _ in _meshes(config))


def with_files(config: Mapping[str, Any], folder: Path | None = None) -> Mapping[str, Any]:
    """The config with files for its meshes that are arrays: {"vertices": [n, 3] m, "triangles": [m, 3], "segments":
    [k, 2], "tetrahedra": [t, 4]}. folder: where they lie; None: a temporary folder. Errors: ConfigError with the
    place.
    """
    if not has_arrays(config):
        return config
    bodies = list(config["scene"]["bodies"])
    for index, name, mesh in _meshes(config):
        file = _file(f"config#/scene/bodies/{index}/{name}", mesh, folder or _scratch())
        bodies[index] = {**bodies[index], name: file}
    return {**config, "scene": {**config["scene"], "bodies": bodies}}

"""What can be named in a config, configs with every default filled in, and scenes as numpy arrays."""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from .given import json_text
from .meshes import has_arrays, with_files

SCHEMA = "barrierbench.config/1"  # of a config; a dict may leave it out
LARGEST = 16 << 20  # bytes of a config, as in core/base/input/read_file.hpp
Config = Mapping[str, Any] | str | os.PathLike


class Setting(NamedTuple):
    """A setting that an entry takes."""

    name: str  # unit in its suffix
    default: str
    unit: str
    allowed: str
    doc: str


class Entry(NamedTuple):
    """Something that has a name in a config."""

    name: str
    doc: str
    parameters: tuple[Setting, ...]


def _entries(text: str) -> list[Entry]:
    return [
        Entry(one["name"], one["doc"], tuple(Setting(**row) for row in one["parameters"])) for one in json.loads(text)
    ]


def scenes() -> list[Entry]:
    """Registered scenes (/scene/name) with their parameters.

    >>> [scene.name for scene in scenes()]
    ['drape2d', 'drape', 'hang', 'sphere_on_sheet', 'resting_block_1d']
    """
    return _entries(_core.scenes_json())


def parts() -> list[Entry]:
    """Kinds of element that a body can be made of, with their keys of /scene/bodies/N/material.

    >>> "membrane" in [part.name for part in parts()]
    True
    """
    return _entries(_core.parts_json())


def generators() -> list[Entry]:
    """Mesh generators (/scene/bodies/N/mesh/generator)."""
    return _entries(_core.generators_json())


def policies() -> list[Entry]:
    """Stiffness policies of contacts (/formulation/stiffness_policy/name)."""
    return _entries(_core.policies_json())


def step_solvers() -> list[Entry]:
    """Step solvers (/step_solver/name)."""
    return _entries(_core.step_solvers_json())


def linear_solvers() -> list[Entry]:
    """Linear solvers (/linear_solver/name)."""
    return _entries(_core.linear_solvers_json())


def _text_of(path: Path) -> str:
    """Of a regular file of at most LARGEST bytes: a FIFO or a device can be waited for, or read, for ever."""
    status = path.stat()
    found = "" if stat.S_ISREG(status.st_mode) else "a folder" if stat.S_ISDIR(status.st_mode) else "no regular file"
    if not found and status.st_size > LARGEST:
        found = f"{status.st_size} bytes"
    if found:
        raise _core.ConfigError(f"{path}: found {found}; allowed: a config of at most {LARGEST} bytes that can be read")
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise _core.ConfigError(f"{path}: found bytes that are not UTF-8; allowed: a config in UTF-8") from None


def _given(
    config: Config, overrides: Sequence[str] | Mapping[str, Any], out: str | None = None
) -> tuple[str, str, str, list[str]]:
    """Text, source, folder and overrides of a config, for _core. out: folder of the record, for meshes in arrays."""
    changes = (
        [f"{pointer}={json_text(value, pointer)}" for pointer, value in overrides.items()]
        if isinstance(overrides, Mapping)
        else list(overrides)
    )
    if isinstance(config, Mapping):
        given = json_text({"schema": SCHEMA, **with_files(config)}, "config"), "config", os.getcwd(), changes
        if not (out and has_arrays(config)):
            return given
        _core.build_scene(*given)  # what it refuses leaves nothing in the folder
        return json_text({"schema": SCHEMA, **with_files(config, Path(out) / "inputs")}, "config"), *given[1:]
    if isinstance(config, str) and config.lstrip().startswith("{"):
        return config, "config", os.getcwd(), changes
    path = Path(config)
    try:
        return _text_of(path), str(path), str(path.resolve().parent), changes
    except OSError as error:
        raise _core.ConfigError(f"{path}: found {error.strerror}; allowed: a config that can be read") from None


def resolve(config: Config, overrides: Sequence[str] | Mapping[str, Any] = ()) -> dict[str, Any]:
    """A config with every default filled in, as a record keeps it.

    config: a dict (its lists may be numpy arrays), JSON text, or the path of a file. overrides: {"/time/steps": 5} or
    ["/time/steps=5"], as --set.
    Errors: ConfigError with every violation, each with its JSON pointer.

    >>> resolve({"scene": {"name": "hang"}}, {"/time/steps": 5})["time"]["steps"]
    5
    """
    return json.loads(_core.resolved_json(*_given(config, overrides)))


class Scene(NamedTuple):
    """A scene as numbers; n vertices, those that stand for moving obstacles last."""

    name: str
    rest: NDArray[np.float64]  # [n, 3] m
    x0: NDArray[np.float64]  # [n, 3] m, positions at the start
    v0: NDArray[np.float64]  # [n, 3] m/s
    mass: NDArray[np.float64]  # [n] kg; 0 where given
    body: NDArray[np.int32]  # [n] number of the body
    faces: NDArray[np.int32]  # [t, 3] of the collision surface
    edges: NDArray[np.int32]  # [e, 2] of the collision surface, rods among them
    d_hat: NDArray[np.float64]  # [n] m
    offset: NDArray[np.float64]  # [n] m
    pinned: NDArray[np.int32]  # vertices whose positions are prescribed at some time
    bodies: list[str]  # names
    obstacles: list[str]  # names


def build_scene(config: Config, overrides: Sequence[str] | Mapping[str, Any] = ()) -> Scene:
    """The scene of a config. Errors: ConfigError, those of `resolve`, of mesh files and of the scene.

    >>> scene = build_scene({"scene": {"name": "hang"}})
    >>> scene.x0.shape[0] == scene.mass.size, scene.faces.shape[1]
    (True, 3)
    """
    return Scene(**_core.build_scene(*_given(config, overrides)))

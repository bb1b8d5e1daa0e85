"""The files that a record names: what it wrote beside itself (artifacts), and its inputs: meshes, films and
plugins.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from barrierbench_analysis.io.digests import of_text

TIMES = "times.csv"  # beside the frames of a film that has its times in a file
NUMBERED = re.compile(r"(.*?)([0-9]+)([^0-9]*)")  # the stem of a frame: round its last number


def meshes(record: dict) -> dict[str, str]:
    """Files of meshes and films, from the folder of the record -> sha256."""
    return record["scene"].get("mesh_sha256") or {}


def inputs(record: dict) -> dict[str, str]:
    """Files that the run was made of, from the folder of the record -> sha256."""
    plugins = [
        one for one in record["provenance"].get("plugins") or [] if not one["name"].startswith("formula:")
    ]
    return meshes(record) | {one["file"]: one["sha256"] for one in plugins}


def artifacts(record: dict) -> dict[str, str]:
    """Files that the run wrote beside its record -> sha256."""
    return {file["path"]: file["sha256"] for file in record.get("artifacts") or []}


def leads_out(root: Path, folder: Path, name: str) -> bool:
    """Whether a name that a record in `folder` has is of a file that does not lie below `root`."""
    return not Path(os.path.normpath(folder.resolve() / name)).is_relative_to(root.resolve())


def _of_config(value: object) -> Iterator[dict]:
    """The objects of a config that name a file with its sha256: meshes, and films by their first frame."""
    if isinstance(value, dict) and "sha256" in value and value.get("file"):
        yield value
    if isinstance(value, (dict, list)):
        for below in value.values() if isinstance(value, dict) else value:
            yield from _of_config(below)


def _frame(name: str) -> tuple[tuple, int]:
    """The file's name without its last number, and this number; -1 without one."""
    path = PurePosixPath(name)
    if not (found := NUMBERED.fullmatch(path.stem)):
        return (path.parent, path.name), -1
    return (path.parent, found[1], found[3], path.suffix), int(found[2])


def _film_sha256(film: dict, files: dict[str, str]) -> str:
    """Of the hashes of all frames, and of that of the times where they are in a file (experiments/config)."""
    kind, first = _frame(film["file"])
    frames = {number: sha256 for name, sha256 in files.items() for of, number in [_frame(name)] if of == kind}
    hashes = "".join(f"{frames[number]}\n" for number in sorted(frames) if number >= first)
    has_times = film.get("frame_s") is not None or film.get("times_s")
    times = str(PurePosixPath(film["file"]).parent / TIMES)
    return of_text(hashes + ("" if has_times else files.get(times, "")))


def unlike_config(record: dict) -> list[str]:
    """The files whose sha256 in the config is not the one of scene/mesh_sha256."""
    files = meshes(record)
    return [
        one["file"]
        for one in _of_config(record["config"])
        if one["sha256"] not in (files.get(one["file"]), _film_sha256(one, files))
    ]

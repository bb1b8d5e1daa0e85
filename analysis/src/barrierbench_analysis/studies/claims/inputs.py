"""What the runs of a sweep are made from beside the sweep file: base config, presets and meshes. Two
questions: are a record's settings those that these files ask for now, and are they the files that numbers or
a registration were made with?
"""

import itertools
import json
import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from barrierbench_analysis.io.digests import of_file, of_text
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.record_file import leaves
from barrierbench_analysis.studies.kit.runs import Sweep as Made
from barrierbench_analysis.studies.kit.runs import inputs_sha256

from .entry import Sweep, note_of, settings_of
from .merged import base_path, formulation_of, merged

# Settings that a record may have otherwise though its inputs are the same: --threads, names, conventions of
# kappa, lengths of directions.
NOT_COMPARED = ("/threads", "/schema", "/formulation/name", "/matching/reference")
CONVERTED = ("kappa_", "file")  # beginnings of keys
DIRECTIONS = {"axis", "warp_axis"}  # made unit vectors


def inputs_of(sweep: Sweep) -> str:
    """sha256 of the contents of the sweep file and of all that it names: base, presets, meshes."""
    data = read_object(sweep.path)
    data["base"] = str(base_path(data, sweep.path))
    parts = sweep.sha256 + inputs_sha256(Made(sweep.name, json.dumps(data), ()))
    return of_text(parts)


def asked(sweep: Sweep) -> Iterator[tuple[str, dict]]:
    """Of every case its note, and the config that sweep file and base ask for now; defaults of the program
    are not in it.
    """
    data = read_object(sweep.path)
    for chosen in itertools.product(*(settings_of(axis, sweep.path) for axis in data["axes"])):
        yield (
            note_of(sweep.name, [label for label, _ in chosen]),
            merged(data, sweep.path, *(settings for _, settings in chosen)),
        )


@cache
def asked_once(sweep: Sweep) -> dict[str, dict]:
    """asked() as it was when it was first asked."""
    return dict(asked(sweep))


def _compared(place: str) -> bool:
    keys = place.split("/")
    return place not in NOT_COMPARED and not keys[-1].startswith(CONVERTED) and not DIRECTIONS & set(keys)


def _same(found, value) -> bool:
    """Numbers to what a change of units rounds."""
    numbers = all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in (found, value))
    return math.isclose(found, value, rel_tol=1e-9) if numbers else found == value


def _meshes(config: dict, folder: Path) -> dict[str, str]:
    """sha256 -> path of the mesh files that a config names and that are there."""
    files = [
        folder / value
        for place, value in leaves(config.get("scene"))
        if place.endswith("/file") and isinstance(value, str)
    ]
    return {of_file(file): str(file) for file in files if file.is_file()}


def contradiction(record: dict, config: dict, folder: Path) -> str:
    """The first setting that a record has otherwise than `config`, which asked() made, asks for now; a mesh
    of another content; empty when there is none. A setting that was taken out of base or preset is not seen
    here: the program sees it, and inputs_of() of kept numbers does.
    """
    whole = {**config, "formulation": formulation_of(config)} if "formulation" in config else config
    found = dict(leaves(record.get("config") or {}))
    for place, value in leaves(whole):
        if place in found and _compared(place) and not _same(found[place], value):
            return f"{place} is {json.dumps(found[place])}, asked for is {json.dumps(value)}"
    known = set(((record.get("scene") or {}).get("mesh_sha256") or {}).values())
    changed = [file for sha, file in _meshes(config, folder).items() if known and sha not in known]
    return f"{changed[0]} has another content" if changed else ""

"""Rows of earlier calls. A whole map takes many hours of one core, so that results/gap_map.json keeps what
other sessions and machines ran; a row counts as long as its settings are those that the spec asks for now,
and its record means the same.
"""

from __future__ import annotations

import json
from pathlib import Path

from ..digests import of_text
from ..errors import UserError
from ..matching.runs import inputs_sha256
from ..origin import ID_DIGITS, machine_of
from ..record_file import other_meanings
from .rows import PLACE
from .spec import Spec, make_sweep
from .table import Map, read

Place = tuple[str, str]  # scene, resolution
SOURCE = (
    "build",
    "date",
    "machine",
    "version",
)  # of a run: program, day, processor and threads, version of the record


def digests(spec: Spec) -> dict[Place, str]:
    """Of everything that the runs of a scene and resolution have in common: settings, meshes, the base
    config. It names their folder too, so that records of another base config, mesh or setting are never taken
    for these.
    """
    made = make_sweep(spec, [])
    shared, inputs = json.loads(made.text)["set"], inputs_sha256(made)
    found = {}
    for scene in spec.scenes:
        for resolution, overrides in scene.resolutions.items():
            common = json.dumps([shared, scene.settings, overrides], sort_keys=True)
            found[scene.label, resolution] = of_text(f"{common} {inputs}")[:8]
    return found


def source_of(record: dict) -> dict[str, str]:
    return {
        "build": record["ids"]["build_id"][:ID_DIGITS],
        "date": record["status"]["started_utc"][:10],
        "machine": machine_of(record),
        "version": record["schema"]["version"],
    }


def kept_rows(path: Path, spec: Spec) -> dict[tuple, tuple[dict, dict]]:
    """PLACE -> row and its source, of the rows in `path` that count for the spec as it is now; nothing
    without the file. Errors: UserError for a file that cannot be read.
    """
    if not path.is_file():
        return {}
    kept, now = read(path), digests(spec)
    same = {place for place, digest in now.items() if kept.about["places"].get("-".join(place)) == digest}
    shapes = {shape for shape, of in spec.shapes.items() if kept.about["shapes"].get(shape) == list(of)}
    found = {}
    for row in kept.rows:
        source = None if row["source"] is None else kept.about["sources"][row["source"]]
        if (
            source
            and (row["scene"], row["resolution"]) in same
            and row["shape"] in shapes
            and not other_meanings(source["version"])
        ):
            found[tuple(row[column] for column in PLACE)] = (row, source)
    return found


def about(spec: Spec, command: str, rows: list[dict], sources: list[dict]) -> dict:
    """What the numbers are of. Errors: UserError where there are none."""
    sizes = [row["unknowns"] for row in rows if row["source"] is not None]
    if not sizes:
        raise UserError(f"{spec.path}: no run of this map is there: ./bench gap-map --quick")
    return {
        "name": spec.name,
        "command": command,
        "spec_sha256": spec.sha256,
        "doc": spec.doc,
        "shapes": {k: list(v) for k, v in spec.shapes.items()},
        "main": list(spec.main),
        "gaps": list(spec.gaps),
        "limits": list(spec.limits),
        "scenes": {
            s.label: {"obstacle": s.obstacle, "resolutions": list(s.resolutions)} for s in spec.scenes
        },
        "places": {"-".join(place): digest for place, digest in digests(spec).items()},
        "unknowns": [min(sizes), max(sizes)],
        "runs": len(sizes),
        "sources": sources,
    }


def read_for(path: Path, spec: Spec) -> Map:
    """The kept map. Errors: UserError where it is of another spec."""
    found = read(path)
    if found.about["spec_sha256"] != spec.sha256:
        raise UserError(f"{path}: its numbers are of another {spec.path}: ./bench gap-map")
    return found

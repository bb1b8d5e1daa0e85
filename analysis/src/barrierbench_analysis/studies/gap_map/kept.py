"""Rows of earlier calls. A whole map takes many hours of one core, so that results/gap_map.json keeps what
earlier calls, here or on other machines, ran; a row counts as long as its settings are those that the spec
asks for now, and its record means the same.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.origin import ONE_THREAD, stamp
from barrierbench_analysis.io.record_file import other_meanings
from barrierbench_analysis.io.store import check_digest
from barrierbench_analysis.studies.kit.runs import inputs_sha256

from .rows import PLACE, READ
from .skips import skips_of
from .spec import Spec, make_sweep
from .table import Map, read

Place = tuple[str, str]  # scene, resolution


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
    return stamp(record, "build", "date", "machine", "version", threads=ONE_THREAD)


@dataclass(frozen=True)
class Kept:
    """counted: PLACE -> row and its source, of the kept runs that count for a spec. refused: why not -> PLACE
    of the others; a run that is refused for two reasons has both in one."""

    counted: dict[tuple, tuple[dict, dict]]
    refused: dict[str, list[tuple]]

    @property
    def places(self) -> set[tuple]:
        """PLACE of every kept run, whether it counts or not."""
        return {*self.counted, *(place for places in self.refused.values() for place in places)}

    @property
    def why(self) -> str:
        """`2 of 3 kept runs, ...`; empty where all count."""
        n = sum(map(len, self.refused.values()))
        reasons = "; ".join(f"{len(places)} {reason}" for reason, places in self.refused.items())
        return f"{n} of {n + len(self.counted)} kept runs: {reasons}" if n else ""


def _reasons(found: Map, spec: Spec) -> Callable[[dict, dict], str]:
    """Of a row and its source: why it does not count for the spec as it is now; empty where it does."""
    now = digests(spec)
    same = {place for place, digest in now.items() if found.about["places"].get("-".join(place)) == digest}
    shapes = {shape for shape, of in spec.shapes.items() if found.about["shapes"].get(shape) == list(of)}

    def why(row: dict, source: dict) -> str:
        place, reasons = (row["scene"], row["resolution"]), []
        if place not in same:
            reasons.append(
                f"whose settings, meshes or base config have changed since ({' '.join(place)})"
                if place in now
                else f"of a place that the spec has no more ({' '.join(place)})"
            )
        if row["shape"] not in shapes:
            reasons.append(f"whose shape the spec has no more or gives otherwise ({row['shape']})")
        if changed := other_meanings(source["version"]):
            since = ", ".join(sorted({change["since"] for change in changed.values()}))
            read = ", ".join(f"`{field}`" for field in READ if field in changed)
            reasons.append(
                f"with records {source['version']}, in which {len(changed)} fields mean something else than"
                f" in records from {since} on; of these fields the map reads {read or 'none'}"
            )
        return ", and ".join(reasons)

    return why


def sort_out(found: Map, spec: Spec) -> Kept:
    """The kept runs that count for the spec as it is now, and the others."""
    why, kept = _reasons(found, spec), Kept({}, {})
    for row in found.rows:
        if row["source"] is not None:
            source = found.about["sources"][row["source"]]
            place = tuple(row[column] for column in PLACE)
            if reason := why(row, source):
                kept.refused.setdefault(reason, []).append(place)
            else:
                kept.counted[place] = (row, source)
    return kept


def kept_rows(path: Path, spec: Spec) -> Kept:
    """Of the file that earlier calls wrote; nothing without it. Errors: UserError for a file that cannot be
    read.
    """
    return sort_out(read(path), spec) if path.is_file() else Kept({}, {})


def about(spec: Spec, command: str, rows: list[dict], sources: list[dict]) -> dict:
    """What the numbers are of. Errors: UserError where there are none."""
    sizes = [row["unknowns"] for row in rows if row["source"] is not None]
    if not sizes:
        raise UserError(f"{spec.path}: no run of this map is there: ./bench study gap-map --quick")
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
        "skips": [skip.json() for skip in skips_of(rows).left_out],
        "sources": sources,
    }


def read_for(path: Path, spec: Spec) -> Map:
    """The kept map. Errors: UserError where it is of another spec."""
    found, again = read(path), f"./bench study gap-map {spec.path}"
    check_digest(path, "about/spec_sha256", found.about["spec_sha256"], spec.sha256, "spec", again)
    return found

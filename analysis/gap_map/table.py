"""results/gap_map.json: the rows that page and figures are made of, and what they are of."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import UserError
from ..json_file import read_object
from ..whole_file import write_whole
from .rows import COLUMNS

SCHEMA = "barrierbench.gap_map_result/1"


@dataclass
class Map:
    # command, sha256 of the spec, shapes, main, gaps, limits, scenes, digests of places, and the sources:
    # what measured the rows
    about: dict
    rows: list[dict] = field(default_factory=list)

    @property
    def shapes(self) -> list[str]:
        return list(self.about["shapes"])

    @property
    def main(self) -> list[str]:
        return self.about["main"]

    @property
    def limits(self) -> list[str]:
        return self.about["limits"]

    @property
    def gaps(self) -> list[float]:
        return self.about["gaps"]


def write(found: Map, path: Path) -> None:
    rows = ",\n  ".join(
        json.dumps([row[c] for c in COLUMNS], separators=(",", ":"), allow_nan=False) for row in found.rows
    )
    about = ",\n  ".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in found.about.items())
    write_whole(
        path,
        f'{{"schema": "{SCHEMA}",\n "about": {{\n  {about}}},\n "columns": {json.dumps(COLUMNS)},\n "rows":'
        f" [\n  {rows}]}}\n",
    )


def read(path: Path) -> Map:
    """Errors: UserError."""
    data = read_object(path)
    if data.get("schema") != SCHEMA or data.get("columns") != list(COLUMNS):
        raise UserError(
            f"{path}: schema {data.get('schema')!r} with columns {data.get('columns')}; {SCHEMA!r} with"
            f" {list(COLUMNS)} is needed: ./bench gap-map"
        )
    return Map(data["about"], [dict(zip(COLUMNS, row)) for row in data["rows"]])

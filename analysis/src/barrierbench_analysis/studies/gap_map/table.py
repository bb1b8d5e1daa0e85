"""results/gap_map.json: the rows that page and figures are made of, and what they are of."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.json_file import lines_of, read_of_schema, rows_of
from barrierbench_analysis.io.whole_file import write_whole

from .rows import COLUMNS

SCHEMA = "barrierbench.gap_map_result/1"
REMEDY = "; ./bench study gap-map makes it"


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
    about = ",\n  ".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in found.about.items())
    write_whole(
        path,
        f'{{"schema": "{SCHEMA}",\n "about": {{\n  {about}}},\n "columns": {json.dumps(COLUMNS)},\n "rows":'
        f" [\n  {lines_of(found.rows, COLUMNS)}]}}\n",
    )


def read(path: Path) -> Map:
    """Errors: UserError."""
    data = read_of_schema(path, SCHEMA, REMEDY)
    return Map(data["about"], rows_of(data, COLUMNS, path, REMEDY))

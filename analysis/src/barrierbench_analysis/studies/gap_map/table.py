"""results/gap_map.json: the rows that page and figures are made of, and what they are of."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.json_file import rows_of
from barrierbench_analysis.io.store import a_line_each, in_columns, read_store
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
    about = a_line_each(
        (f"{json.dumps(key)}: {json.dumps(value)}" for key, value in found.about.items()), 2, "{}"
    )
    write_whole(
        path,
        f'{{"schema": "{SCHEMA}",\n "about": {about},\n "columns": {json.dumps(COLUMNS)},\n "rows":'
        f" {a_line_each(in_columns(found.rows, COLUMNS), 2)}}}\n",
    )


def read(path: Path) -> Map:
    """Errors: UserError."""
    return read_store(
        path, SCHEMA, lambda data: Map(data["about"], rows_of(data, COLUMNS, path, REMEDY)), REMEDY
    )

"""One run with all that lies beside its record, as pandas, numpy and scipy objects. Files are read when they
are requested, and only where they are the very ones that the record names.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import sparse

from barrierbench_analysis.io import fields
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import Frame, frame_paths, frames_of
from barrierbench_analysis.io.input_file import read_text
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.matrix_market import read_matrix
from barrierbench_analysis.io.record_file import bound_file, named_files, read_record, read_trace

from .run_rows import run_row

PAIR_FORCES = "/output/pair_forces=true"


@dataclass(frozen=True)
class System:
    """H x = b of one Newton iteration. n: rows; a block of rows is a vertex."""

    step: int
    iteration: int
    form: str  # solved, clamped or exact
    matrix: sparse.csc_matrix  # [n, n], N/m, symmetric
    rhs: np.ndarray  # [n], N
    coordinates_m: np.ndarray  # [blocks, 3]
    block_start: np.ndarray  # [blocks + 1] first row of each block, and n


class Run:
    """The run of a folder with run.json. Errors of every accessor: RecordError, UserError, with the file."""

    def __init__(self, folder: str | Path):
        self.folder = Path(folder)
        self.record: dict = read_record(self.folder / "run.json")

    def __repr__(self) -> str:
        return f"Run({str(self.folder)!r}): {self.outcome}"

    @property
    def outcome(self) -> str:
        """ok, or the word of what ended it: `./bench help record`."""
        return self.record["status"]["outcome"]

    @property
    def valid(self) -> bool:
        return self.record["status"]["valid"]

    @property
    def config(self) -> dict:
        """Every setting, defaults filled in."""
        return self.record["config"]

    @cached_property
    def scalars(self) -> pd.Series:
        """The row of this run in tables: fields.columns("runs"), and a value for each swept pointer."""
        return pd.Series(run_row(self.record, self.folder.name))

    @cached_property
    def steps(self) -> pd.DataFrame:
        """One row a time step: fields.columns("steps")."""
        return pd.DataFrame([fields.row("steps", step) for step in self.record["steps"]])

    @cached_property
    def _lines(self) -> list[dict]:
        return read_trace(self.record, self.folder)

    @cached_property
    def trace(self) -> pd.DataFrame:
        """One row a Newton iteration: fields.columns("trace"). Empty where the run wrote none."""
        return pd.DataFrame([fields.row("trace", line) for line in self._lines])

    @cached_property
    def cond(self) -> pd.DataFrame:
        """One row a condition estimate: step, iteration, then fields.columns("cond")."""
        return pd.DataFrame(
            [
                {"step": line["step"], "iteration": line["iteration"], **fields.row("cond", sample)}
                for line in self._lines
                for sample in line["cond"]
            ]
        )

    @cached_property
    def pair_forces(self) -> pd.DataFrame:
        """One row a step and two bodies that touch (/output/pair_forces, docs/reference/records.md): step,
        t_s, body_a, body_b, contacts, normal_N, ...; area_m2 is nan without weights by area. Errors:
        UserError where the run kept none.
        """
        names = named_files(self.record, "pair_forces")
        if not names:
            raise UserError(f"{self.folder}: no forces of bodies; run the config with --set {PAIR_FORCES}")
        text = read_text(bound_file(self.record, self.folder, names[0]))
        words = {"body_a": str, "body_b": str}  # a body may be called nan
        return pd.read_csv(
            StringIO(text),
            dtype=words,
            keep_default_na=False,
            na_values={"area_m2": [""]},
            float_precision="round_trip",
        )

    def frames(self) -> Iterator[tuple[int, Frame]]:
        """Step and state, one after the other; step -1 is the start, 0 the end of the first step."""
        steps = list(frame_paths(self.record, self.folder))
        return zip(steps, frames_of(self.record, self.folder, steps))

    def positions(self) -> np.ndarray:
        """[frames, vertices, 3] m, of all frames."""
        return np.stack([frame.vertices for _, frame in self.frames()])

    def systems(self) -> Iterator[System]:
        """The matrices that the run kept (/output/matrices), in order; none where it kept none."""
        for name in sorted(named_files(self.record, "matrix_side_car")):
            about = read_object(bound_file(self.record, self.folder, name))
            matrix = (Path(name).parent / about["matrix"]["file"]).as_posix()
            yield System(
                about["step"],
                about["iteration"],
                about.get("form", ""),
                read_matrix(bound_file(self.record, self.folder, matrix)),
                np.array(about["rhs"], dtype=float),
                np.array(about["coordinates_m"], dtype=float),
                np.array(about["block_start"], dtype=int),
            )

"""VTKHDF (.vtkhdf, .hdf): unstructured grids and polygons of VTK in HDF5, with their steps in time, and
collections of them, by the package h5py, which is installed on demand.

The layout is that of VTK's specification (docs.vtk.org, VTKHDF file format, version 2): partitions lie one
behind the other in every array; a step names the first of its partitions and where its points, cells and
corners begin. Steps with the same places have the same cells.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError

from .film import FilmFile, Shape, checked_file, no_cells, package

GRID, POLYGONS = "UnstructuredGrid", "PolyData"
COLLECTIONS = ("PartitionedDataSetCollection", "MultiBlockDataSet")
TOPOLOGIES = {"Vertices": 2, "Lines": 4, "Polygons": 7, "Strips": 6}  # of polygons: the type of a cell of VTK
MOST_VERSION = 2
MOST_STEPS = 10_000_000


def h5py(user: str):
    return package(user, "h5py", "h5py (BSD-3-Clause)", "vtkhdf")


def _text(value: object) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


class Block:
    """One data set: its steps, and its shape in each."""

    def __init__(self, path: Path, group) -> None:
        self.path, self.group = path, group
        self.kind = _text(group.attrs.get("Type", ""))
        self.steps = group.get("Steps")
        if self.kind not in (GRID, POLYGONS):
            raise UserError(
                f"{path}: {group.name}: found the type {self.kind!r}; allowed: {GRID}, {POLYGONS},"
                f" {', '.join(COLLECTIONS)}"
            )

    def times(self) -> list[float] | None:
        """Errors: UserError where values and number of steps differ."""
        if self.steps is None:
            return None
        values, n = np.ravel(self._all(self.steps, "Values")), int(self.steps.attrs.get("NSteps", -1))
        if n != len(values) or not 0 < n <= MOST_STEPS:
            raise UserError(f"{self.path}: {self.steps.name}: {n} steps and {len(values)} values; as many"
                            " values as steps, and one at least, are needed")  # fmt: skip
        return values.astype(float).tolist()

    def _all(self, group, name: str) -> np.ndarray:
        if name not in group:
            raise UserError(f"{self.path}: {group.name}: no {name}; VTKHDF needs it")
        return group[name][()]

    def _rows(self, group, name: str, start: int, count: int) -> np.ndarray:
        """Errors: UserError where the file has fewer."""
        if name not in group or not 0 <= start <= start + count <= len(group[name]):
            have = f"{len(group[name])} rows" if name in group else "none"
            raise UserError(
                f"{self.path}: {group.name}/{name}: {have}; rows {start} to {start + count} are needed"
            )
        return group[name][start : start + count]

    def _start(self, name: str, step: int, column: int = 0) -> int:
        """Where something of a step begins; 0 without steps, and of what a file leaves out."""
        if self.steps is None or name not in self.steps:
            return 0
        row = np.ravel(self._rows(self.steps, name, step, 1))
        return int(row[min(column, len(row) - 1)])

    def _partitions(self, step: int) -> range:
        first, count = self._start("PartOffsets", step), len(self._all(self.group, "NumberOfPoints"))
        if self.steps is not None and "NumberOfParts" in self.steps:
            count = self._start("NumberOfParts", step)
        elif self.steps is not None:  # then every step has as many
            count //= int(self.steps.attrs["NSteps"])
        return range(first, first + count)

    def _parts_before(self, group, first: int, cell: int) -> int:
        """Partitions whose offsets come before those of a step, each one more than it has cells. Of a grid
        those that the step names; of polygons those that have the cells before it, as vtkHDFReader counts.
        """
        if self.kind == GRID or not first:
            return first
        counts = self._rows(group, "NumberOfCells", 0, first)
        return int(np.count_nonzero(np.cumsum([0, *counts[:-1]]) < cell))

    def _cells(self, group, parts: range, step: int, column: int, before: np.ndarray) -> Iterator[tuple]:
        """Corners, sizes and types of each partition; before: points of those before it."""
        corner, cell = (self._start(name, step, column) for name in ("ConnectivityIdOffsets", "CellOffsets"))
        end = cell + self._parts_before(group, parts.start, cell)
        for part, points in zip(parts, before):
            cells, corners = (
                int(self._rows(group, name, part, 1)[0])
                for name in ("NumberOfCells", "NumberOfConnectivityIds")
            )
            ends = self._rows(group, "Offsets", end, cells + 1 if cells else 0).astype(np.int64)
            of = self._rows(group, "Connectivity", corner, corners).astype(np.int64) + points
            types = self._rows(group, "Types", cell, cells) if self.kind == GRID else None
            yield of, np.diff(ends), types
            corner, cell, end = corner + corners, cell + cells, end + cells + 1

    def shape(self, step: int) -> Shape:
        parts, first = self._partitions(step), self._start("PointOffsets", step)
        counts = [int(self._rows(self.group, "NumberOfPoints", part, 1)[0]) for part in parts]
        n, before = sum(counts), np.cumsum([0, *counts])[:-1]
        x = self._rows(self.group, "Points", first, n).astype(np.float64).reshape(n, 3)
        groups = {self.group: None} if self.kind == GRID else {
            self.group[name]: kind for name, kind in TOPOLOGIES.items() if name in self.group
        }  # fmt: skip
        found = [
            (of, sizes, np.full(len(sizes), kind, np.uint8) if types is None else types)
            for group, kind in groups.items()
            for of, sizes, types in self._cells(group, parts, step, _column(group), before)
        ]
        joined = map(np.concatenate, zip(*found)) if found else no_cells()
        return Shape(x, *joined, self._fields(step, first, n))

    def _fields(self, step: int, first: int, n: int) -> dict[str, np.ndarray]:
        """Of the points, those of numbers."""
        out, data = {}, self.group.get("PointData", {})
        for name in data:
            offsets = None if self.steps is None else self.steps.get("PointDataOffsets")
            start = first if offsets is None or name not in offsets else int(np.ravel(offsets[name][step])[0])
            if data[name].dtype.kind in "fiu" and start + n <= len(data[name]):
                out[name] = data[name][start : start + n].astype(np.float64).reshape(n, -1)
        return out


def _column(group) -> int:
    """Of arrays of steps that have a column for each kind of cell of polygons."""
    name = group.name.rpartition("/")[2]
    return list(TOPOLOGIES).index(name) if name in TOPOLOGIES else 0


def _blocks(path: Path, root) -> tuple[list[str], list[Block]]:
    """Names and data sets; one that is alone has no name."""
    if _text(root.attrs.get("Type", "")) not in COLLECTIONS:
        return [""], [Block(path, root)]
    groups = {name: group for name, group in root.items() if name != "Assembly" and "Type" in group.attrs}
    if not groups:
        raise UserError(f"{path}: a collection without a data set; one at least is needed")
    order = sorted(groups, key=lambda name: (int(groups[name].attrs.get("Index", 0)), name))
    return order, [Block(path, groups[name]) for name in order]


def _times(path: Path, names: list[str], blocks: list[Block]) -> list[float] | None:
    """Of all blocks. Errors: UserError where two differ."""
    times = [block.times() for block in blocks]
    for name, own in zip(names, times):
        if own != times[0]:
            raise UserError(
                f"{path}: {name}: steps at other times than those of {names[0]}; the same are needed"
            )
    return times[0]


def of_vtkhdf(path: Path) -> FilmFile:
    library = h5py(str(path))
    try:
        root = library.File(checked_file(path), "r").get("VTKHDF")
    except OSError as error:
        raise UserError(f"{path}: not an HDF5 file that can be read: {error}") from None
    if root is None:
        raise UserError(f"{path}: no group VTKHDF; an HDF5 file of VTK is needed")
    version = np.ravel(root.attrs.get("Version", 0))
    if version[0] > MOST_VERSION:
        raise UserError(f"{path}: VTKHDF of version {version.tolist()}; allowed: up to {MOST_VERSION}")
    names, blocks = _blocks(path, root)
    times = _times(path, names, blocks)
    return FilmFile(
        path,
        names,
        [f"{time!r} s" for time in times] if times else ["the only step"],
        times,
        lambda body, step: blocks[body].shape(step),
    )

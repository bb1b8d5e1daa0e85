"""What a file with a film has: bodies, frames, times, unit and upward axis; one reader a format makes it
(formats.py).
"""

import contextlib
import importlib
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from types import ModuleType

import numpy as np

from barrierbench_analysis.io.axes import OURS, Axes
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.input_file import TRAJECTORY, opened

from .joins import Join, Numbers, join_of

INSTALL = ".venv/bin/python -m pip install --requirement analysis/requirements-{}.txt"
ROUNDED = "positions are float32 in the file: what is read are the rounded ones"
# Types of VTK, of which every cell is one.
SEGMENT, TETRAHEDRON, POLYGON = 3, 10, 7
Cells = tuple[np.ndarray, np.ndarray, np.ndarray]  # as cells() makes them


@dataclass(frozen=True)
class Shape:
    """A body in one frame, in the unit and axes of the file."""

    points: np.ndarray  # [n, 3] float64
    corners: np.ndarray  # 0-based numbers of points, those of all cells in a row
    sizes: np.ndarray  # [cells] how many corners each has
    types: np.ndarray  # [cells] of VTK
    fields: dict[str, np.ndarray] = field(default_factory=dict)  # [n, components] at the points

    def has_cells_of(self, other: "Shape") -> bool:
        mine, its = ((one.corners, one.sizes, one.types) for one in (self, other))
        return all(np.array_equal(a, b) for a, b in zip(mine, its))


@contextlib.contextmanager
def readable(what: str) -> Iterator[None]:
    """Faults of libraries, which a damaged file meets in any way, as UserError."""
    try:
        yield
    except UserError:
        raise
    except (RuntimeError, ValueError, LookupError, TypeError, OSError) as error:
        why = " ".join(str(error).split()) or type(error).__name__
        raise UserError(f"{what}: cannot be read: {why}") from None


def joined(parts: list[Shape]) -> Shape:
    """One after the other, without fields."""
    before = np.cumsum([0, *(len(part.points) for part in parts)])
    corners = [part.corners + n for part, n in zip(parts, before)]
    points, sizes, types = ([getattr(part, name) for part in parts] for name in ("points", "sizes", "types"))
    return Shape(*map(np.concatenate, (points, corners, sizes, types)))


@dataclass(frozen=True)
class FilmFile:
    path: Path
    bodies: list[str]  # names; one that has none is ""
    labels: list[str]  # of the frames
    times_s: list[float] | None
    shape: Callable[[int, int], Shape]  # of a body in a frame. Errors: UserError
    axes: Axes = OURS
    notes: tuple[str, ...] = ()
    numbers: Numbers = ()  # of the vertices of each body, where the file has them
    known: dict[int, tuple[Shape, object]] = field(default_factory=dict)  # of a body, and what it was read as

    @cached_property
    def join(self) -> Join | None:
        """Which points are one vertex. Errors: as `at`."""
        if all(own is None for own in self.numbers):
            return None
        return join_of(self.numbers, [self.at(body, 0).points for body in range(len(self.bodies))])

    def at(self, body: int, frame: int) -> Shape:
        """Errors: UserError, also for what the library of the format cannot read."""
        with readable(str(Step(self, body, frame))):
            return self.shape(body, frame)

    def frame(self, number: int) -> Shape:
        """All bodies, one after the other, a vertex once. Errors: as `at`, and where its points are apart."""
        shape = joined([self.at(body, number) for body in range(len(self.bodies))])
        if self.join is None:
            return shape
        points = self.join.points(shape.points, f"{self.path} ({self.labels[number]})")
        return replace(shape, points=points, corners=self.join.vertex[shape.corners])


@dataclass(frozen=True, eq=False)
class Step:
    """A body in a frame: what stands for a mesh file where frames are files."""

    film: FilmFile
    body: int
    frame: int

    @property
    def name(self) -> str:
        name, more = self.film.bodies[self.body], self.film.labels[self.frame]
        return f"{self.film.path.name} {name} ({more})".replace("  ", " ")

    @property
    def suffix(self) -> str:
        return self.film.path.suffix

    def __str__(self) -> str:
        return f"{self.film.path.parent / self.name}"


def vtu_bytes(shape: Shape) -> bytes:
    """A file of VTK with every bit, for the program's reader."""
    arrays = (
        ("Float64", "Points", shape.points.astype("<f8")),
        ("Int64", "connectivity", shape.corners.astype("<i8")),
        ("Int64", "offsets", np.cumsum(shape.sizes).astype("<i8")),
        ("UInt8", "types", shape.types.astype("u1")),
    )
    xml, data = [], b""
    for kind, name, values in arrays:
        components = 3 if name == "Points" else 1
        xml.append(
            f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="appended"'
            f' offset="{len(data)}"/>'
        )
        data += struct.pack("<Q", values.nbytes) + values.tobytes()
    head = '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">'
    piece = f'<Piece NumberOfPoints="{len(shape.points)}" NumberOfCells="{len(shape.types)}">'
    cells = f"<Points>{xml[0]}</Points><Cells>{''.join(xml[1:])}</Cells>"
    grid = f"<UnstructuredGrid>{piece}{cells}</Piece></UnstructuredGrid>"
    return f'{head}{grid}<AppendedData encoding="raw">_'.encode() + data + b"</AppendedData></VTKFile>"


def no_cells() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners, sizes and types of none."""
    return np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0, np.uint8)


def cells(corners: np.ndarray, sizes: np.ndarray, kind: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells of one type."""
    return corners.astype(np.int64), sizes.astype(np.int64), np.full(len(sizes), kind, np.uint8)


def reversed_faces(corners: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The corners of every face in the other order, from its first one on."""
    starts = np.repeat(np.cumsum(sizes) - sizes, sizes)
    place = np.arange(len(corners)) - starts
    return corners[starts + np.where(place == 0, 0, np.repeat(sizes, sizes) - place)]


def mirrored(
    corners: np.ndarray, sizes: np.ndarray, types: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells whose points a transform with a negative determinant moved: in the other order, so that a side
    that is outside stays outside, and a volume above 0 stays above 0.
    """
    return reversed_faces(corners, sizes), sizes, types


def chains(sizes: np.ndarray, closed: bool) -> np.ndarray:
    """[n, 2] the segments of curves of so many points, one curve after the other."""
    ends = np.cumsum(sizes)
    numbers = np.arange(int(ends[-1]) if len(ends) else 0)
    following, last = numbers + 1, ends[sizes > 0] - 1
    following[last] = (ends - sizes)[sizes > 0] if closed else -1
    pairs = np.stack([numbers, following], axis=1)
    return pairs[(following >= 0) & (following != numbers)]


def package(user: str, name: str, of: str, extra: str) -> ModuleType:
    """A module of a package that is installed on demand. user: the file or option that needs it; of: the
    package at PyPI; extra: its file of requirements. Errors: UserError with the command that installs it.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        raise UserError(f"{user}: the package {of} is not installed: {INSTALL.format(extra)}") from None


def checked_file(path: Path) -> str:
    """Its name for a library that opens it. Errors: UserError for what is no file that can be read."""
    opened(path, TRAJECTORY).close()
    return str(path)

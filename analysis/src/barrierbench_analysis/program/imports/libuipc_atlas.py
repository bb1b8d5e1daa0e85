"""Attributes of a saved scene of libuipc: a geometry names its arrays by numbers in one common list."""

from dataclasses import dataclass

import numpy as np

from barrierbench_analysis.program.mesh_arrays import MeshArrays

from .card import Card, escaped
from .config import NO_SEGMENTS, NO_TETRAHEDRA, NO_TRIANGLES, cells_of

ATLAS = "/__data__/geometry_atlas/__data__"
PARTS = ("meta", "instances", "vertices", "edges", "triangles", "tetrahedra")


@dataclass
class Attributes:
    """The arrays of one collection. `place` is its pointer in the file."""

    card: Card
    place: str
    held: dict  # by key: the slot
    values: list  # of the whole file

    def at(self, key: str) -> str:
        """The pointer of an attribute."""
        return f"{self.place}/{escaped(key)}"

    def slot(self, key: str) -> dict | None:
        """Where an attribute stands in the list."""
        found = self.held.get(key)
        return found if isinstance(found, dict) and "index" in found else None

    def all(self, key: str, rest=None) -> list:
        """The values of an attribute. Errors: KeyError where it is missing and `rest` is None."""
        if (slot := self.slot(key)) is not None:
            return self.values[slot["index"]]["__data__"]["values"]
        if rest is None:
            raise KeyError(self.at(key))
        return rest

    def one(self, key: str, rest=None):
        """The first value of an attribute."""
        return self.all(key, None if rest is None else [rest])[0]

    def pointers(self, key: str) -> list[str]:
        """Of the attribute and of its values."""
        if (slot := self.slot(key)) is None:
            return []
        return [self.at(key), f"{ATLAS}/attributes/{slot['index']}"]

    def mapped(self, key: str, to: str, how: str = "") -> None:
        self.card.mapped(self.pointers(key), to, how)

    def changed(self, key: str, was, became, why: str) -> None:
        self.card.changed(self.pointers(key), was, became, why)

    def left_out(self, key: str, consequence: str) -> None:
        self.card.left_out(self.pointers(key), consequence)


class Geometry:
    """One geometry: its kind and the collections of its parts."""

    def __init__(self, atlas: "Atlas", number: int) -> None:
        data = atlas.data["geometries"][number]
        self.place = f"{ATLAS}/geometries/{number}"
        self.kind = data["__meta__"]["type"]
        for part in PARTS:
            held = (data["__data__"].get(part) or {}).get("__data__") or {}
            place = f"{self.place}/__data__/{part}/__data__"
            setattr(self, part, Attributes(atlas.card, place, held, atlas.data["attributes"]))

    def shared(self, other: "Geometry") -> list[str]:
        """Pointers of the attributes and their values that another geometry has too."""
        both = [(getattr(self, part), getattr(other, part)) for part in PARTS]
        return [pointer for a, b in both for key in a.held if key in b.held for pointer in a.pointers(key)]

    def cells(self, points: np.ndarray) -> MeshArrays:
        """The cells of the highest dimension."""
        for part, none, name in (
            (self.tetrahedra, NO_TETRAHEDRA, "tetrahedra"),
            (self.triangles, NO_TRIANGLES, "triangles"),
            (self.edges, NO_SEGMENTS, "segments"),
        ):
            found = np.reshape(part.all("topo", none), (-1, none.shape[1])).astype(np.int64)
            if len(found):
                part.mapped("topo", "/scene/bodies/N/mesh")
                return cells_of(points, **{name: found})
        return cells_of(points)


class Atlas:
    """All geometries and collections of a file."""

    def __init__(self, card: Card, data: dict) -> None:
        self.card, self.data = card, data["__data__"]["geometry_atlas"]["__data__"]

    def collection(self, name: str) -> Attributes:
        """A collection that belongs to no geometry. Errors: KeyError."""
        held = self.data["attribute_collections"][name]["__data__"]
        place = f"{ATLAS}/attribute_collections/{escaped(name)}/__data__"
        return Attributes(self.card, place, held, self.data["attributes"])

    def geometry(self, number: int) -> Geometry:
        return Geometry(self, number)

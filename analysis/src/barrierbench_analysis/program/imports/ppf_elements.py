"""Elements of a session of the ppf contact solver with their parameters as materials of this program.

Young's modulus of a session is over the density (Pa m^3/kg): times the density of a cell it is Pa of a solid,
N/m of a shell, and N/m of a rod, where N are times the length of an edge. Stiffnesses of bending are those
of energy.cu at f23b356.
"""

import numpy as np

from barrierbench_analysis.program.mesh_arrays import MeshArrays

from . import materials
from .config import NO_SEGMENTS, NO_TETRAHEDRA, NO_TRIANGLES
from .ppf_session import Session

KINDS = {"tet": "solid", "tri": "shell", "rod": "rod"}
# By the number in a file; "arap" there is the corotational energy.
MODELS = ("corotational", "stvk", "baraff_witkin", "stable_neo_hookean", "pdrd")
PDRD = 4.0
HINGE_SCALE = 1.28e-5  # m^2, BEND_SCALE
ROD_LENGTH = 1e-2  # m, REF_LENGTH
REST = {  # what the frontend takes where a parameter has no file
    "tri": {"model": 2.0, "young-mod": 1000.0, "density": 1.0, "bend": 10.0},
    "tet": {"model": 0.0, "young-mod": 500.0, "density": 100.0, "bend": 1.0},
    "rod": {"model": 0.0, "young-mod": 1e4, "density": 1.0, "bend": 0.0, "contact-offset": 1e-3},
    "static": {},
}
USUAL = {
    "poiss-rat": 0.35,
    "contact-gap": 1e-3,
    "shrink-x": 1.0,
    "shrink-y": 1.0,
    "length-factor": 1.0,
    "shrink": 1.0,
}
MAPPED = {
    "model": "material/model or solid_model",
    "density": "material",
    "young-mod": "material",
    "poiss-rat": "material",
    "contact-gap": "d_hat_m",
    "contact-offset": "offset_m",
    "friction": "friction",
    "strain-limit": "limited",
    "shrink-x": "material/shrink_warp",
    "shrink-y": "material/shrink_weft",
}
LEFT_OUT = {
    "bend-warp": "hinges bend alike in all directions",
    "bend-weft": "hinges bend alike in all directions",
    "deformation-damping": "the material has no damping",
    "bending-damping": "the material has no damping",
    "stitch-stiffness": "stitches do not act",
    "shrink": "the rest shape of a solid is that of the mesh",
    "length-factor": "rods are at rest with the lengths of the mesh",
    "pressure": "nothing is inflated",
    "plasticity": "the rest shape stays",
    "plasticity-threshold": "the rest shape stays",
    "bend-plasticity": "the rest shape stays",
    "bend-plasticity-threshold": "the rest shape stays",
}


class Elements:
    """Cells and parameters of a session."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.cells = {kind: session.array(kind).astype(np.int64) for kind in KINDS}
        self.shells = session.count("shell_count", len(self.cells["tri"]))
        self.count = {kind: len(cells) for kind, cells in self.cells.items()}
        self.count["static"] = session.count("static_tri")
        self.sides = np.zeros(0, int)  # triangles of the body that was found last, also those of a solid
        self.differs: dict[tuple[str, str], tuple[float, float, float]] = {}
        self.gaps = np.concatenate([self.all(kind, "contact-gap") for kind in ("tri", "rod")])
        self.has_friction = any(self.all(kind, "friction").any() for kind in self.count)

    def all(self, kind: str, name: str) -> np.ndarray:
        """A parameter of all elements of a kind."""
        rest = REST[kind].get(name, USUAL.get(name, 0.0))
        return self.session.parameter(kind, name, self.count[kind], rest)

    def one(self, kind: str, name: str, numbers: np.ndarray) -> float:
        """The value of a body: the mean where its elements differ, which `note` reports."""
        values = self.all(kind, name)[numbers]
        mean, differs = materials.weighted(values, np.ones(len(values)))
        if differs:
            self.differs[kind, name] = (float(values.min()), float(values.max()), mean)
        return mean

    def of(self, vertices: np.ndarray) -> tuple[str, np.ndarray, MeshArrays] | None:
        """The kind, the numbers and the cells of the elements of a body; None for one that is left out."""
        inside = {
            kind: np.flatnonzero(np.isin(cells, vertices).all(axis=1)) if len(cells) else np.zeros(0, int)
            for kind, cells in self.cells.items()
        }
        self.sides = inside["tri"]
        inside["tri"] = inside["tri"][inside["tri"] < self.shells]
        kind = next((one for one in KINDS if len(inside[one])), None)
        if kind is None or (self.all(kind, "model")[inside[kind]] == PDRD).any():
            return None
        made = {"tet": NO_TETRAHEDRA, "tri": NO_TRIANGLES, "rod": NO_SEGMENTS}
        made[kind] = np.searchsorted(vertices, self.cells[kind][inside[kind]])
        if kind == "tri":
            made["rod"] = np.searchsorted(vertices, self.cells["rod"][inside["rod"]])
        return kind, inside[kind], MeshArrays(np.zeros((0, 3)), made["tri"], made["rod"], made["tet"])

    def contact_keys(self, kind: str, numbers: np.ndarray) -> dict:
        """What a body says about contact."""
        friction = self.one(kind, "friction", numbers)
        offset = self.one(kind, "contact-offset", numbers)
        gap = self.one(kind, "contact-gap", numbers)
        return {
            "d_hat_m": gap if gap > 0 else None,
            "offset_m": offset or None,
            "friction": friction if self.has_friction else None,
        }

    def note(self) -> None:
        """Notes every file of parameters on the card."""
        card = self.session.card
        for (kind, name), (low, high, mean) in self.differs.items():
            card.changed(f"bin/param/{kind}-{name}.bin", f"{low:g} to {high:g}", mean, "a body has one value")
        for kind in self.count:
            at = f"bin/param/{kind}"
            for name, to in MAPPED.items():
                how = "times the density" if name == "young-mod" else ""
                how += " and the mean length of an edge" if (kind, name) == ("rod", "young-mod") else ""
                card.mapped(f"{at}-{name}.bin", f"/scene/bodies/N/{to}", how)
            for name, words in LEFT_OUT.items():
                card.left_out(f"{at}-{name}.bin", words)
        card.mapped(
            "bin/param/rod-bend.bin", "/scene/bodies/N/material/rod_bending_N_m2", "times the density"
        )
        card.mapped("bin/param/rod-bend-rest-from-geometry.bin", "/scene/bodies/N/material/rod_rest")
        card.left_out("bin/param/tet-bend.bin", "solids do not bend as shells do")
        card.left_out("bin/param/static-bend.bin", "colliders do not deform")
        card.changed(
            "bin/param/tri-bend.bin",
            "a stiffness by the shape of each hinge",
            "bending_J",
            "every hinge of a body has the mean stiffness",
        )
        for kind in ("tri", "tet", "static"):
            card.left_out(
                f"bin/param/{kind}-bend-rest-from-geometry.bin", "hinges are at rest in the rest shape"
            )


def material_of(
    elements: Elements, kind: str, numbers: np.ndarray, cells: MeshArrays
) -> tuple[dict, dict, float]:
    """The material of a body, what it says about contact, and its strain limit (0: none)."""
    density = elements.one(kind, "density", numbers)
    modulus = elements.one(kind, "young-mod", numbers) * density
    solid_sides = kind == "tet" and len(elements.sides)
    contact = elements.contact_keys(*(("tri", elements.sides) if solid_sides else (kind, numbers)))
    if kind == "rod":
        keys = {
            "model": "none",
            "line_density_kg_per_m": density,
            "rod_stretching_N": modulus * _rod_length(elements, cells),
            "rod_bending_N_m2": elements.one(kind, "bend", numbers) * density * ROD_LENGTH**2,
        }
        if not elements.one(kind, "bend-rest-from-geometry", numbers):
            keys["rod_rest"] = "straight"
        return keys, contact, 0.0
    shear, bulk = materials.lame(modulus, elements.one(kind, "poiss-rat", numbers))
    model = MODELS[int(elements.all(kind, "model")[numbers][0])]
    if kind == "tet":
        youngs, poisson = materials.youngs_of(shear, bulk)
        keys = {
            "solid_model": model,
            "solid_youngs_Pa": youngs,
            "solid_poisson": poisson,
            "solid_density_kg_per_m3": density,
        }
        return keys, contact, 0.0
    bend = elements.one(kind, "bend", numbers)
    keys = materials.shell(model, shear, bulk, density, bend * density * _hinges(cells))
    for name, key in (("shrink-x", "shrink_warp"), ("shrink-y", "shrink_weft")):
        if (factor := elements.one(kind, name, numbers)) != 1:
            keys[key] = factor
    if (axis := _warp(elements, numbers, cells)) is not None:
        keys["warp_axis"] = axis
    return keys, contact, elements.one(kind, "strain-limit", numbers)


def _rod_length(elements: Elements, cells: MeshArrays) -> float:
    """The mean length of the edges of a rod, m. The force of an edge of the length l_0 is
    young (density l_0) (l/l_0 - 1) (energy.cu, hook.hpp, scene.rs): the stiffness against stretching is
    young density l_0, which depends on the mesh.
    """
    ends = cells.points[cells.segments]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    mean = float(lengths.mean())
    if np.ptp(lengths) > 1e-6 * mean:
        elements.session.card.changed(
            "bin/param/rod-young-mod.bin",
            f"a stiffness of each edge, of {lengths.min():g} to {lengths.max():g} m",
            f"that of the mean length, {mean:g} m",
            "a body has one stiffness against stretching",
        )
    return mean


def _hinges(cells: MeshArrays) -> float:
    """HINGE_SCALE times the mean of length^2/(area of both triangles) over the hinges."""
    p, t = cells.points, cells.triangles
    area = np.linalg.norm(np.cross(p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]]), axis=1) / 2
    sides = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [0, 2]]]), axis=1)
    edges, which, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    both = np.bincount(which.ravel(), np.tile(area, 3), len(edges))
    length = np.linalg.norm(p[edges[:, 1]] - p[edges[:, 0]], axis=1)
    inner = count == 2
    return HINGE_SCALE * float((length[inner] ** 2 / both[inner]).mean()) if inner.any() else 0.0


def _warp(elements: Elements, numbers: np.ndarray, cells: MeshArrays) -> list[float] | None:
    """The mean direction in which u grows, where the session has texture coordinates."""
    uv = elements.session.array("uv").astype(float).reshape(-1, 3, 2)
    if not len(uv) or not np.ptp(uv[numbers], axis=(0, 1)).all():
        return None
    p, t = cells.points, cells.triangles
    sides = np.stack([p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]]], axis=2)
    flat = np.stack([uv[numbers, 1] - uv[numbers, 0], uv[numbers, 2] - uv[numbers, 0]], axis=2)
    good = np.abs(np.linalg.det(flat)) > 1e-14
    along = (sides[good] @ np.linalg.inv(flat[good]))[:, :, 0]
    mean = along.mean(axis=0) if good.any() else np.zeros(3)
    length = np.linalg.norm(mean)
    return (mean / length).tolist() if length > 0 else None

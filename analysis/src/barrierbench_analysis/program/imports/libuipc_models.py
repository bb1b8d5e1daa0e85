"""Constitutions of libuipc, by their numbers, as materials of this program."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from . import materials
from .card import Card

ORTHO, AFFINE_ARAP = 1, 2  # of affine bodies
ARAP, STABLE_NEO_HOOKEAN, NEO_HOOKEAN_SHELL, HOOKEAN_SPRING, PARTICLE = 9, 10, 11, 12, 13
KIRCHHOFF_ROD, DISCRETE_SHELL, BARAFF_WITKIN = 15, 17, 819
OTHERS = {14: "vertices are not pulled to a place", 16: "the transform is not pulled to a place"}
AT = "/scene/bodies/N/material"


@dataclass
class Material:
    """Keys of a material, the thickness on each side, m, and keys that differ between instances."""

    keys: dict
    offset: float = 0.0
    each: list[dict] = field(default_factory=list)

    def of(self, instance: int) -> dict:
        """The keys of an instance."""
        return self.keys | (self.each[min(instance, len(self.each) - 1)] if self.each else {})


def names_of(data: dict) -> dict[int, str]:
    """By the number of a geometry the name of its object."""
    objects = data["__data__"].get("object_collection", {}).get("objects", [])
    return {number: one.get("name") or "object" for one in objects for number in one.get("geometries", [])}


def material_of(card: Card, geometry, uid: int) -> Material | None:
    """The material of a geometry; None for one that is left out, with a note on the card."""
    reader = READERS.get(uid)
    if reader is None:
        words = "a particle has no cells" if uid == PARTICLE else f"the constitution {uid} is not read"
        card.left_out(geometry.place, f"{words}: the geometry is left out")
        return None
    density = float(geometry.meta.one("mass_density", 1000.0))
    made = reader(geometry, density)
    if uid in (ORTHO, AFFINE_ARAP, ARAP):
        geometry.meta.mapped("constitution_uid", f"{AT}/solid_model")
    geometry.meta.mapped("constitution_uid", f"{AT}/model or solid_model")
    geometry.meta.mapped("mass_density", AT, "a density of the cells")
    _extras(geometry, made)
    return made


def _mean(part, key: str, to: str) -> float:
    """The mean of an attribute over its cells, noted as changed where it differs."""
    values = np.ravel(part.all(key)).astype(float)
    mean, differs = materials.weighted(values, np.ones(len(values)))
    if differs:
        part.changed(key, f"{values.min():g} to {values.max():g}", mean, "a body has one material")
    part.mapped(key, to)
    return mean


def _affine(shear_of_kappa: float) -> Callable:
    """A reader of affine bodies, which become stiff solids with the same moduli at rest. A small strain e has
    the energy 4 kappa |e|^2 where it is kappa |A A^T - I|^2 (uid 1), and kappa |e|^2 where it is
    kappa |A - R|^2 (uid 2); a solid has mu |e|^2, and lambda is 0.
    """

    def read(geometry, density: float) -> Material:
        kappas = np.ravel(geometry.instances.all("kappa")).astype(float)
        each = [materials.solid("corotational", shear_of_kappa * k, 0.0, density) for k in kappas]
        youngs = [one["solid_youngs_Pa"] for one in each]
        geometry.instances.changed(
            "kappa",
            f"affine bodies of {', '.join(f'{k:g}' for k in kappas)} Pa",
            f"solids with Young's moduli {', '.join(f'{e:g}' for e in youngs)} Pa and Poisson's ratio 0",
            "this program has no affine bodies: all vertices are free",
        )
        return Material(each[0], each=each)

    return read


def _thickness(geometry) -> float:
    """The thickness on one side, m, of which a shell has twice."""
    values = np.ravel(geometry.vertices.all("thickness", [0.0])).astype(float)
    mean, differs = materials.weighted(values, np.ones(len(values)))
    if differs:
        geometry.vertices.changed("thickness", "a thickness of each vertex", mean, "a body has one offset")
    geometry.vertices.mapped("thickness", "/scene/bodies/N/offset_m")
    return mean


def _arap(geometry, density: float) -> Material:
    kappa = _mean(geometry.tetrahedra, "kappa", f"{AT}/solid_youngs_Pa")
    return Material(materials.solid("arap", kappa, 0.0, density), _thickness(geometry))


def _stable_neo_hookean(geometry, density: float) -> Material:
    """The logarithm in its energy leaves 3/4 mu and lambda - 5/8 mu as moduli at rest (Smith et al. 2018)."""
    shear = _mean(geometry.tetrahedra, "mu", f"{AT}/solid_youngs_Pa")
    bulk = _mean(geometry.tetrahedra, "lambda", f"{AT}/solid_poisson")
    geometry.meta.changed(
        "constitution_uid",
        "stable neo-Hookean with a logarithm",
        "stable_neo_hookean",
        "this one has no logarithm; its moduli at rest are those of the source",
    )
    keys = materials.solid("stable_neo_hookean", 0.75 * shear, bulk - 0.625 * shear, density)
    return Material(keys, _thickness(geometry))


def _neo_hookean_shell(geometry, density: float) -> Material:
    half = _thickness(geometry)
    shear = 2 * half * _mean(geometry.triangles, "mu", f"{AT}/youngs_N_per_m")
    bulk = 2 * half * _mean(geometry.triangles, "lambda", f"{AT}/poisson")
    geometry.meta.changed(
        "constitution_uid",
        "neo-Hookean shell",
        "corotational",
        "the nearest membrane; its moduli at rest are those of the source times twice the thickness",
    )
    return Material(materials.shell("corotational", shear, bulk, 2 * half * density), half)


def _baraff_witkin(geometry, density: float) -> Material:
    """lambda stands before the stretch along both directions, mu before the shear; each without a half."""
    half = _thickness(geometry)
    stretch = 4 * half * _mean(geometry.triangles, "lambda", f"{AT}/youngs_N_per_m")
    shear = 4 * half * _mean(geometry.triangles, "mu", f"{AT}/poisson")
    for key in ("strain_rate", "strain_limit_rate"):
        geometry.triangles.left_out(key, "the cubic part of the stretch is missing: no growth beyond rest")
        geometry.meta.left_out(key, "the cubic part of the stretch is missing: no growth beyond rest")
    geometry.meta.changed(
        "constitution_uid",
        "strain-limiting Baraff-Witkin shell",
        "baraff_witkin",
        "its directions are the x axis of the scene turned into each triangle, not those of each triangle",
    )
    return Material(materials.shell("baraff_witkin", stretch, shear, 2 * half * density), half)


def _hookean_spring(geometry, density: float) -> Material:
    radius = _thickness(geometry)
    section = np.pi * radius**2
    kappa = _mean(geometry.edges, "kappa", f"{AT}/rod_stretching_N")
    keys = {"model": "none", "rod_stretching_N": kappa * section, "line_density_kg_per_m": density * section}
    return Material(keys, radius)


def _extras(geometry, made: Material) -> None:
    """Constitutions beside the first one: bending of shells and rods, pulls."""
    for uid in np.ravel(geometry.meta.all("extra_constitution_uids", [])).astype(int):
        if uid == DISCRETE_SHELL:
            made.keys["bending_J"] = _bending(geometry)
        elif uid == KIRCHHOFF_ROD:
            # E = k pi r^4/4 |curvature|^2/L0 with L0 the sum of both edges: E I of a rod is k pi r^4/4
            modulus = _mean(geometry.vertices, "bending_stiffness", f"{AT}/rod_bending_N_m2")
            made.keys["rod_bending_N_m2"] = modulus * np.pi * made.offset**4 / 4
        else:
            geometry.meta.left_out(
                "extra_constitution_uids", OTHERS.get(int(uid), f"the constitution {uid} is not read")
            )
    geometry.meta.mapped("extra_constitution_uids", AT, "bending")


def _bending(geometry) -> float:
    """2 kappa A t L0/h of the hinges, whose mean all hinges of the body get. The energy of a hinge is
    kappa (theta - theta_0)^2 L0/h times the volume A t, where A is the area of both triangles, h = A/(3 L0),
    and t the mean of the thickness at its four vertices (V_bar in discrete_shell_bending.cu).
    """
    points = np.reshape(geometry.vertices.all("position"), (-1, 3)).astype(float)
    triangles = np.reshape(geometry.triangles.all("topo"), (-1, 3)).astype(int)
    edges = np.reshape(geometry.edges.all("topo"), (-1, 2)).astype(int)
    kappa = np.ravel(geometry.edges.all("bending_stiffness")).astype(float)
    thickness = np.ravel(geometry.vertices.all("thickness", [0.0] * len(points))).astype(float)
    opposite: dict[tuple[int, int], list[int]] = {}
    for corners in triangles.tolist():
        for a, b, c in ((0, 1, 2), (1, 2, 0), (0, 2, 1)):
            opposite.setdefault(tuple(sorted((corners[a], corners[b]))), []).append(corners[c])
    made = []
    for edge, stiffness in zip(edges.tolist(), kappa):
        tips = opposite.get(tuple(sorted(edge)), [])
        if len(tips) == 2:
            length = float(np.linalg.norm(points[edge[1]] - points[edge[0]]))
            # L0/h times A is 3 L0^2
            made.append(6 * stiffness * length**2 * float(thickness[[*edge, *tips]].mean()))
    found = float(np.mean(made)) if made else 0.0
    geometry.edges.changed(
        "bending_stiffness",
        f"{kappa.min():g} to {kappa.max():g} with the shape of each hinge",
        f"bending_J = {found:g}",
        "every hinge of a body has the mean stiffness",
    )
    return found


READERS = {
    ORTHO: _affine(4.0),
    AFFINE_ARAP: _affine(1.0),
    ARAP: _arap,
    STABLE_NEO_HOOKEAN: _stable_neo_hookean,
    NEO_HOOKEAN_SHELL: _neo_hookean_shell,
    HOOKEAN_SPRING: _hookean_spring,
    BARAFF_WITKIN: _baraff_witkin,
}

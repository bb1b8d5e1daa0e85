"""Bodies of a scene of PolyFEM: meshes, materials, velocities, and what holds and moves them."""

from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.trajectories.trajectory import surface_of

from . import materials
from .config import NotAtRest, cells_of
from .expressions import NoExpression, compiled
from .polyfem_geometry import direction, mesh_of, number_of, numbers, selected, sides_of
from .polyfem_ids import stored_id
from .polyfem_scene import Scene

SOLIDS = {
    "NeoHookean": "stable_neo_hookean",
    "SaintVenant": "stvk",
    "LinearElasticity": "corotational",
    "HookeLinearElasticity": "corotational",
    "FixedCorotational": "corotational",
}


UNREAD = " (the mesh file has no single id that is read)"


def shortest_edge(cells) -> float:
    """Of the surface and the rods of a mesh; infinite without any."""
    faces = surface_of(cells)
    ends = np.concatenate([cells.segments, *(faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0]))])
    ways = cells.points[ends[:, 1]] - cells.points[ends[:, 0]]
    return float(np.linalg.norm(ways, axis=1).min(initial=np.inf))


class Bodies:
    """The bodies and obstacles of a scene, which they join in its config."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.card = scene, scene.card
        self.config, self.units = scene.config, scene.units

    def read(self) -> None:
        """All geometries, in the order of the source."""
        found = self.scene.data.get("geometry") or []
        listed = isinstance(found, list)
        for number, one in enumerate(found if listed else [found]):
            at = f"/geometry/{number}" if listed else "/geometry"
            if not isinstance(one, dict):
                raise self.card.refuse(at, one, "an object")
            if not one.get("enabled", True):
                self.card.mapped(at, "nothing", "the source leaves it out")
                continue
            kind = one.get("type", "mesh")
            if kind in ("plane", "ground"):
                self._plane(at, one, kind)
            elif kind == "mesh":
                self._mesh(at, one)
            else:
                raise self.card.refuse(f"{at}/type", kind, "mesh, plane, ground")

    def _plane(self, at: str, one: dict, kind: str) -> None:
        gravity = np.array(self.config.scene["gravity_m_per_s2"])
        if kind == "plane":
            axis = direction(self.card, f"{at}/normal", one.get("normal"))
            point = numbers(self.card, f"{at}/point", one.get("point"), 3, 0.0)
        elif not gravity.any():
            raise self.card.refuse(f"{at}/type", kind, "plane where there is no gravity")
        else:
            axis = -gravity / np.linalg.norm(gravity)
            point = axis * self.scene.number(f"{at}/height", one.get("height"))
        place = (point * self.units.length).tolist()
        self.config.add_obstacle(kind, kind="plane", point_m=place, axis=axis.tolist())
        keys = ("type", "point", "normal", "height", "is_obstacle", "enabled")
        self.card.mapped([f"{at}/{key}" for key in keys], "/scene/obstacles/N")

    def _mesh(self, at: str, one: dict) -> None:
        given = mesh_of(self.card, at, one, self.card.source.parent, self.units.length_name)
        length, name = self.units.length, Path(one["mesh"]).stem
        cells = cells_of(given.points * length, given.triangles, given.segments, given.tetrahedra)
        n_refs = number_of(self.card, f"{at}/n_refs", one.get("n_refs", 0), whole=True)
        edge = shortest_edge(given) / 2**n_refs
        self.scene.shortest_edge = min(self.scene.shortest_edge, edge)
        self.card.mapped(f"{at}/is_obstacle", "/scene/bodies/N/kind", "rigid where it is true")
        if one.get("is_obstacle", False):
            surface = cells_of(cells.points, surface_of(cells), cells.segments)
            motion = self._obstacle_motion(at, one, name, surface)
            self.config.add_body(name, surface, kind="rigid", motion=motion)
            return
        if not len(cells.tetrahedra):
            raise self.card.refuse(
                f"{at}/mesh", one["mesh"], "a mesh of tetrahedra (no 2D scenes, hexahedra or shells)"
            )
        if n_refs:
            self.card.changed(f"{at}/n_refs", n_refs, 0, "the mesh is not refined, so the body is coarser")
        volume = self._volume_id(at, one)
        material, velocity = self._material(at, volume), self._velocity(at, volume)
        pins = self._pins(at, one, self.config.name_for(name), given, cells)
        self.config.add_body(name, cells, material=material, pins=pins or None, velocity_m_per_s=velocity)

    def _volume_id(self, at: str, one: dict) -> int | None:
        """The id of a whole body, as GeometryReader.cpp of PolyFEM has it; None where it is not known."""
        found = one.get("volume_selection")
        if isinstance(found, int):
            self.card.mapped(f"{at}/volume_selection", "/scene/bodies/N/material", "which material")
            return found
        if found is None or isinstance(found, dict) and found.keys() == {"id_offset"}:
            offset = (found or {}).get("id_offset", 0)
            whole = number_of(self.card, f"{at}/volume_selection/id_offset", offset, whole=True)
            self.card.mapped(f"{at}/volume_selection", "/scene/bodies/N/material", "which material")
            stored = stored_id(self.card.source.parent / one["mesh"])
            return None if stored is None else stored + whole
        if found is not None:
            self.card.changed(
                f"{at}/volume_selection", found, "one material", "a body of this program has one material"
            )
            ids = [
                one.get("id")
                for one in (found if isinstance(found, list) else [found])
                if isinstance(one, dict)
            ]
            return next((k for k in ids if isinstance(k, int)), None)
        return None

    def _material(self, at: str, volume: int | None) -> dict:
        """The keys of the material with this id, or of the only one."""
        listed = self.scene.data.get("materials")
        rows = listed if isinstance(listed, list) else [listed]
        for number, row in enumerate(rows):
            if not isinstance(row, dict):
                raise self.card.refuse("/materials", row, "objects with a type")
            ids = row.get("id")
            if len(rows) == 1 or volume is not None and _names(ids, volume):
                return self._solid(f"/materials/{number}" if isinstance(listed, list) else "/materials", row)
        allowed = ", ".join(str(row.get("id")) for row in rows)
        raise self.card.refuse(f"{at}/volume_selection", volume, f"{allowed}{UNREAD * (volume is None)}")

    def _solid(self, at: str, row: dict) -> dict:
        kind, card, p = row.get("type"), self.card, self.units.pressure
        if not isinstance(kind, str) or kind not in SOLIDS:
            raise card.refuse(f"{at}/type", kind, ", ".join(SOLIDS))
        if "E" in row and "nu" in row:
            poisson = self.scene.number(f"{at}/nu", row["nu"])
            if not -1 < poisson < 0.5:
                raise card.refuse(f"{at}/nu", poisson, "a number > -1 and < 0.5")
            shear, bulk = materials.lame(self.scene.number(f"{at}/E", row["E"], 0) * p, poisson)
        elif "lambda" in row and "mu" in row:
            shear, bulk = (
                self.scene.number(f"{at}/mu", row["mu"], 0) * p,
                self.scene.number(f"{at}/lambda", row["lambda"]) * p,
            )
        else:
            raise card.refuse(at, sorted(row), "numbers E and nu, or lambda and mu")
        density = self.scene.number(f"{at}/rho", row.get("rho", 1.0), 0) * self.units.density
        if "rho" not in row:
            card.default(f"{at}/rho", 1.0, "the default of the source")
        model = SOLIDS[kind]
        if kind == "SaintVenant":
            card.mapped(f"{at}/type", "/scene/bodies/N/material/solid_model")
        else:
            card.changed(
                f"{at}/type", kind, model, "the nearest model; its moduli at rest are those of the source"
            )
        keys = [f"{at}/{key}" for key in ("id", "E", "nu", "lambda", "mu", "rho")]
        card.mapped(
            keys, "/scene/bodies/N/material", "solid_youngs_Pa, solid_poisson, solid_density_kg_per_m3"
        )
        return materials.solid(model, shear, bulk, density)

    def _velocity(self, at: str, volume: int | None) -> list[float] | None:
        every = self.scene.conditions("initial_conditions", "velocity")
        if every and volume is None:
            allowed = ", ".join(str(one.get("id")) for _, one in every)
            raise self.card.refuse(f"{at}/volume_selection", None, f"{allowed}{UNREAD}")
        for place, one in every:
            if one.get("id") == volume:
                speed = self.units.length / self.units.time
                found = numbers(self.card, f"{place}/value", one.get("value"), 3, 0.0) * speed
                keys = [f"{place}/id", f"{place}/value"]
                self.card.mapped(keys, "/scene/bodies/N/velocity_m_per_s", "a speed")
                return found.tolist()
        return None

    # --- what is prescribed

    def _pins(self, at: str, one: dict, name: str, given, cells) -> list[dict]:
        """A pin for each Dirichlet condition that names sides of the body. A side has the first condition
        with its id, as in the source; a vertex of several conditions has the first one of the scene.
        """
        selection, pins, held = one.get("surface_selection"), [], {}
        if selection is None:
            return []
        sides = sides_of(self.card, f"{at}/surface_selection", selection, given)
        for place, condition in self.scene.conditions("boundary_conditions", "dirichlet_boundary"):
            named = [side for side in sides if _names(condition.get("id"), side)]
            if not named:
                continue
            every = np.unique(np.concatenate([sides.pop(side) for side in named]))
            keys = selected(f"{at}/surface_selection", selection)
            self.card.mapped(keys, "/scene/bodies/N/pins", "vertices of its sides")
            if not self._holds_all(place, condition):
                self.card.left_out(place, f"a pin holds all three coordinates, so {name} is not held here")
                continue
            vertices = np.array([v for v in every.tolist() if v not in held], int)
            if not len(vertices):
                self.card.left_out(
                    condition_keys(place), f"conditions before it hold all its vertices of {name}"
                )
                continue
            self._shared(place, condition, [held[v] for v in every.tolist() if v in held])
            motion, moves = self._moved(place, condition, f"{name}_pin{len(pins)}", cells, vertices)
            if moves:
                pins.append({"indices": vertices.tolist(), **({"motion": motion} if motion else {})})
                held |= dict.fromkeys(vertices.tolist(), condition)
        return pins

    def _holds_all(self, place: str, condition: dict) -> bool:
        axes = condition.get("dimension", [True] * 3)
        if not isinstance(axes, list):
            raise self.card.refuse(f"{place}/dimension", axes, "an array of true and false")
        return all(axes)

    def _shared(self, place: str, condition: dict, before: list[dict]) -> None:
        """Notes vertices that conditions before it hold in another way."""
        other = [b for b in before if any(b.get(k) != condition.get(k) for k in ("value", "interpolation"))]
        if other:
            self.card.changed(
                f"{place}/id",
                condition.get("id"),
                f"all its vertices but {len(before)}",
                "conditions before it hold these here; in the source the last of its sides holds a vertex",
            )

    def _obstacle_motion(self, at: str, one: dict, name: str, cells) -> dict | None:
        side = one.get("surface_selection")
        if side is None:
            return None
        if not isinstance(side, int):
            raise self.card.refuse(f"{at}/surface_selection", side, "a whole number for an obstacle")
        for key in ("obstacle_displacements", "dirichlet_boundary"):
            for place, condition in self.scene.conditions("boundary_conditions", key):
                if _names(condition.get("id"), side):
                    self.card.mapped(f"{at}/surface_selection", "/scene/bodies/N/motion", "which condition")
                    everything = np.arange(len(cells.points))
                    return self._moved(place, condition, self.config.name_for(name), cells, everything)[0]
        self.card.mapped(
            f"{at}/surface_selection", "/scene/bodies/N/kind", "no condition moves it: it stands"
        )
        return None

    def _moved(self, at: str, condition: dict, name: str, cells, vertices) -> tuple[dict | None, bool]:
        """The motion of a condition, and whether the vertices are held or moved by it."""
        value, known = condition.get("value"), condition_keys(at)
        factor = self._factor(at, condition)
        if factor is None or not isinstance(value, list) or any(isinstance(v, (list, dict)) for v in value):
            self.card.left_out(known, "values by time step, by file or by this interpolation are not read")
            return None, False
        try:
            ways = [compiled(one) for one in [*value, 0.0, 0.0][:3]]
        except NoExpression as fault:
            allowed = "numbers and expressions of x, y, z and t"
            raise UserError(f"{self.card.source}#{at}/value: found {fault}; allowed: {allowed}") from None
        unit, start = self.units, cells.points[vertices]
        rest = start / unit.length

        def places(time: float) -> np.ndarray:
            when = time / unit.time
            way = np.stack([one(rest, when) for one in ways], axis=1)
            return start + factor(when) * way * unit.length

        try:
            motion, words = self.config.motion(name, cells, vertices, places)
        except NotAtRest:
            self.card.left_out(
                known, "its value is not 0 at the time 0, where the body starts; nothing is held"
            )
            return None, False
        self.card.mapped(known, "/scene/bodies/N/pins or /motion", words)
        return motion, True

    def _factor(self, at: str, condition: dict):
        """The interpolation of a condition as a function of the time; None for one that is not read."""
        how, at = condition.get("interpolation") or {"type": "none"}, f"{at}/interpolation"
        if isinstance(how, list) and any(one != how[0] for one in how):
            return None
        how = how[0] if isinstance(how, list) else how
        if not isinstance(how, dict):
            raise self.card.refuse(at, how, "an object with a type")
        kind = how.get("type", "none")
        if kind == "none":
            return lambda t: 1.0
        if kind == "linear":
            return lambda t: t
        if kind == "piecewise_linear" and how.get("extend", "constant") == "constant":
            points, values = (self._row(f"{at}/{key}", how.get(key)) for key in ("points", "values"))
            if len(points) != len(values) or (np.diff(points) <= 0).any():
                raise self.card.refuse(at, how, "as many values as points, and points that increase")
            return lambda t: float(np.interp(t, points, values))
        return None

    def _row(self, at: str, given) -> np.ndarray:
        if not isinstance(given, list) or not given:
            raise self.card.refuse(at, given, "an array of numbers")
        return numbers(self.card, at, given, len(given), 0.0)


def condition_keys(at: str) -> list[str]:
    """What a condition may say."""
    return [f"{at}/{key}" for key in ("id", "value", "dimension", "interpolation", "time_reference")]


def _names(ids, side: int) -> bool:
    return ids == "all" or side in (ids if isinstance(ids, list) else [ids])

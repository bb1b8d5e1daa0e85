"""A scene of libuipc (the JSON file of SceneIO.save) as a config.

The form is that of src/core/core/scene_factory.cpp of spiriMirror/libuipc at 619a5412cf, energies are those
of docs/specification/constitutions.
"""

from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.program.mesh_arrays import MeshArrays
from barrierbench_analysis.program.trajectories.trajectory import surface_of

from .card import DAMAGE, Card, leaves
from .config import SceneConfig, cells_of
from .libuipc_atlas import Atlas
from .libuipc_contacts import Contacts
from .libuipc_models import AFFINE_ARAP, ORTHO, material_of, names_of

FILE = "/__data__/geometry_atlas/__data__"
LEFT = object()  # in place of the velocity of an instance that is left out
DEFAULT_STEPS = 100  # the file has no end of time
INTEGRATORS = {"bdf1": "implicit_euler", "bdf2": "bdf2"}
GEOMETRY = f"{FILE}/geometries/*/__data__"
KNOWN = (
    ("/__meta__", "the kind of the file"),
    ("/__data__/object_collection", "names of objects"),
    ("/__data__/geometry_slots", "which geometry is at rest and which one now"),
    ("/__data__/rest_geometry_slots", "which geometry is at rest and which one now"),
    ("/__data__/geometry_next_id", "a counter"),
    ("/__data__/rest_geometry_next_id", "a counter"),
    ("/__data__/subscene_tabular", "bodies of all subscenes meet"),
    (f"{FILE}/attribute_collections/subscene_models", "bodies of all subscenes meet"),
    ("/__data__/contact_tabular/default_model_user_set", "the table of contacts says it"),
    (f"{FILE}/attribute_collections/*/__meta__", "a count"),
    (
        f"{FILE}/attribute_collections/contact_models/__data__/resistance",
        "the stiffness of the barrier adapts as in IPC 2020",
    ),
    *(
        (f"{FILE}/attribute_collections/config/__data__/{key}", words)
        for key, words in (
            ("cfl~1*", "the step is not bounded by a speed"),
            ("collision_detection~1*", "the search is that of this program"),
            ("contact~1adaptive~1*", "the stiffness of the barrier adapts as in IPC 2020"),
            ("contact~1al-ipc~1*", "contact is a barrier"),
            ("contact~1d_hat_relative", "d_hat is absolute"),
            ("contact~1eps_velocity_relative", "eps_v is absolute"),
            ("diff_sim~1*", "there are no derivatives of a run"),
            ("extras~1*", "what is written is said by /output of the config"),
            ("line_search~1*", "the line search is that of this program"),
            ("linear_system~1*", "the linear solver is that of this program"),
            ("newton~1*", "the tolerances are those of this program"),
            ("sanity_check~1*", "./bench check looks for intersections"),
        )
    ),
    (f"{FILE}/geometries/*/__meta__", "the kind of the geometry"),
    *(
        (f"{GEOMETRY}/{part}/__meta__", "a count")
        for part in ("meta", "instances", "vertices", "edges", "triangles", "tetrahedra")
    ),
    *(
        (f"{GEOMETRY}/{part}/__data__/is_surf", "the surface is found from the cells")
        for part in ("vertices", "edges", "triangles", "tetrahedra")
    ),
    *(
        (f"{GEOMETRY}/{part}/__data__/is_facet", "the surface is found from the cells")
        for part in ("vertices", "edges", "triangles", "tetrahedra")
    ),
    (f"{GEOMETRY}/edges/__data__/topo", "edges of triangles and tetrahedra follow from these"),
    (f"{GEOMETRY}/triangles/__data__/topo", "triangles of tetrahedra follow from these"),
    (f"{GEOMETRY}/triangles/__data__/orient", "normals follow from the tetrahedra"),
    (f"{GEOMETRY}/triangles/__data__/parent_id", "a mark of its own"),
    (f"{GEOMETRY}/tetrahedra/__data__", "nothing is in it"),
    (f"{GEOMETRY}/vertices/__data__/volume", "masses follow from the mesh"),
    (f"{GEOMETRY}/vertices/__data__/mass", "masses follow from the mesh"),
    (f"{GEOMETRY}/vertices/__data__/is_dynamic", "all free vertices have inertia"),
    (f"{GEOMETRY}/instances/__data__/is_dynamic", "all free vertices have inertia"),
    (f"{GEOMETRY}/instances/__data__/external_kinetic", "the kinetic energy is that of this program"),
    *(
        (f"{GEOMETRY}/meta/__data__/{key}", "masses follow from the mesh")
        for key in (
            "abd_mass",
            "abd_mass_x_bar",
            "abd_mass_x_bar_x_bar",
            "inertia",
            "mass",
            "mass_center",
            "volume",
        )
    ),
    (f"{GEOMETRY}/meta/__data__/dof_count", "a mark of its own"),
    (f"{GEOMETRY}/meta/__data__/dof_offset", "a mark of its own"),
    (f"{GEOMETRY}/meta/__data__/subscene_element_id", "bodies of all subscenes meet"),
    (f"{FILE}/attributes", "values that no mapped attribute of a geometry has"),
    ("/__data__/geometry_atlas/__meta__", "the kind of the file"),
)


def recognised(data: object) -> bool:
    """Whether a JSON file looks like a saved scene of libuipc."""
    return isinstance(data, dict) and isinstance(data.get("__meta__"), dict) and "__data__" in data


class Scene:
    """One scene as it is read."""

    def __init__(self, path: Path, out: Path, steps: int | None) -> None:
        self.path, self.data = path, read_object(path)
        self.card = Card(path, "libuipc", leaves(self.data))
        kind = self.data.get("__meta__", {}).get("type")
        if kind != "SceneSnapshot":
            raise self.card.refuse("/__meta__/type", kind, "SceneSnapshot, which SceneIO.save writes")
        self.atlas = Atlas(self.card, self.data)
        self.settings = self.atlas.collection("config")
        dt = float(self.settings.one("dt"))
        self.settings.mapped("dt", "/time/dt_s")
        if not steps:
            self.card.default(
                "/time/steps", DEFAULT_STEPS, "a saved scene has no end; --steps says another one"
            )
        self.config = SceneConfig(out, dt, steps or DEFAULT_STEPS)
        self.place = "/__data__"  # what is read now
        self.sides: list[tuple[int, dict]] = []  # contact elements of bodies, then of obstacles
        self.grounds: list[tuple[int, dict]] = []

    def contact(self) -> None:
        """Settings of the run, and the table of contacts."""
        given, made = self.settings, self.config
        made.scene["gravity_m_per_s2"] = np.ravel(given.one("gravity")).tolist()
        given.mapped("gravity", "/scene/gravity_m_per_s2")
        kind = given.one("integrator/type", "bdf1")
        if kind not in INTEGRATORS:
            raise self.card.refuse(given.at("integrator/type"), kind, ", ".join(INTEGRATORS))
        given.mapped("integrator/type", "/integrator/name")
        made.settings |= {
            "integrator": {"name": INTEGRATORS[kind]},
            "formulation": {"name": "ipc2020", "d_hat_m": float(given.one("contact/d_hat"))},
            "matching": {"rule": "as_given"},
        }
        given.mapped("contact/d_hat", "/formulation/d_hat_m", "beyond the thickness of both sides")
        form = given.one("contact/constitution", "ipc")
        if form == "ipc":
            given.mapped("contact/constitution", "/formulation/name", "ipc2020")
        else:
            given.changed("contact/constitution", form, "ipc2020", "contact is a barrier of IPC here")
        self._table()
        self.speed = float(given.one("contact/eps_velocity", 0.01))
        given.mapped("contact/eps_velocity", "/friction/eps_v_m_per_s")
        given.mapped("contact/friction/enable", "/friction", "no coefficient where it is 0")
        self.friction_on = bool(given.one("contact/friction/enable", 1))
        given.mapped("contact/enable", "/scene/collisions", "all pairs are off where it is 0")

    def _table(self) -> None:
        """Friction of pairs of contact elements; pairs that do not meet."""
        table = self.atlas.collection("contact_models")
        pairs = np.reshape(table.all("topo", [[0, 0]]), (-1, 2)).astype(int)
        rates = np.ravel(table.all("friction_rate", [0.0] * len(pairs))).astype(float)
        active = np.ravel(table.all("is_enabled", [1] * len(pairs))).astype(bool)
        names = [tuple(sorted(map(int, pair))) for pair in pairs]
        self.contacts = Contacts(dict(zip(names, rates.tolist())), dict(zip(names, active.tolist())))
        table.mapped("topo", "/scene/bodies/N/friction", "which contact elements meet")
        table.mapped("is_enabled", "/scene/collisions", "pairs that are off")
        self.card.mapped(
            "/__data__/contact_tabular/contact_elements", "/scene/bodies/N/friction", "their numbers"
        )

    def bodies(self) -> None:
        """All geometries that stand in a slot, in the order of their numbers."""
        names = names_of(self.data)
        rests = {one["id"]: one["index"] for one in self.data["__data__"].get("rest_geometry_slots", [])}
        for slot in sorted(self.data["__data__"].get("geometry_slots", []), key=lambda one: one["id"]):
            geometry = self.atlas.geometry(slot["index"])
            self.place = geometry.place
            name = names.get(slot["id"], f"geometry_{slot['id']}")
            first = len(self.config.bodies)
            if geometry.kind == "ImplicitGeometry":
                self._plane(geometry, name)
            elif geometry.kind == "SimplicialComplex":
                self._complex(geometry, name)
            else:
                self.card.left_out(geometry.place, f"a geometry of the kind {geometry.kind} is not read")
            if slot["id"] in rests:
                rest = self.atlas.geometry(rests[slot["id"]])
                self._rest(geometry, rest, first)
        self.place = "/__data__"
        self._collisions()

    def _plane(self, geometry, name: str) -> None:
        uid = int(geometry.meta.one("implicit_geometry_uid", 1))
        if uid != 1:
            self.card.left_out(geometry.place, f"the implicit geometry {uid} is no half plane")
            return
        points = np.reshape(geometry.instances.all("P"), (-1, 3)).astype(float)
        normals = np.reshape(geometry.instances.all("N"), (-1, 3)).astype(float)
        element = int(geometry.meta.one("contact_element_id", 0))
        for point, normal in zip(points, normals):
            self.config.add_obstacle(name, kind="plane", point_m=(point + 0.0).tolist(), axis=normal.tolist())
            self.grounds.append((element, self.config.obstacles[-1]))
        for part, keys in (
            (geometry.instances, ("P", "N", "is_fixed")),
            (geometry.meta, ("implicit_geometry_uid", "contact_element_id")),
        ):
            for key in keys:
                part.mapped(key, "/scene/obstacles/N")

    def _rest(self, geometry, rest, first: int) -> None:
        """The rest shape: that of the geometry now, or a mesh of its own for the bodies from `first` on."""
        if geometry.kind == rest.kind == "SimplicialComplex":
            now, then = (
                np.reshape(g.vertices.all("position"), (-1, 3)).astype(float) for g in (geometry, rest)
            )
            for body in self.config.bodies[first:]:
                if body.get("kind") != "rigid" and not np.array_equal(now, then):
                    cells = geometry.cells(then)
                    body["rest_mesh"] = self.config.mesh_file(f"{body['name']}_rest", cells)
        self.card.mapped(rest.shared(geometry), "/scene/bodies/N/mesh or rest_mesh", "the rest shape")

    def _complex(self, geometry, name: str) -> None:
        uid = int(geometry.meta.one("constitution_uid", 0))
        fixed = np.ravel(geometry.instances.all("is_fixed", [0])).astype(bool)
        thin = uid in (ORTHO, AFFINE_ARAP) and not len(geometry.tetrahedra.all("topo", []))
        if thin and not fixed.all():
            words = (
                "an affine body without tetrahedra has no solid here: instances that can move are left out"
            )
            self.card.left_out(geometry.instances.pointers("kappa") if fixed.any() else geometry.place, words)
            if not fixed.any():
                return
        made = material_of(self.card, geometry, uid)
        if made is None:
            return
        points = np.reshape(geometry.vertices.all("position"), (-1, 3)).astype(float)
        cells = geometry.cells(points)
        geometry.vertices.mapped("position", "/scene/bodies/N/mesh")
        element = int(geometry.meta.one("contact_element_id", 0))
        geometry.meta.mapped("contact_element_id", "/scene/bodies/N/friction")
        transforms = np.reshape(geometry.instances.all("transform", [np.eye(4)]), (-1, 4, 4)).astype(float)
        geometry.instances.mapped(
            "transform", "/scene/bodies/N/mesh", "applied to the vertices; one body an instance"
        )
        fixed = np.resize(fixed, len(transforms))
        geometry.instances.mapped("is_fixed", "/scene/bodies/N/kind", "rigid where it is 1")
        pins, velocities = self._held(geometry), self._velocities(geometry, points, len(transforms))
        if thin:
            velocities = [None if still else LEFT for still in fixed]
        first = len(self.config.bodies)
        for number, (transform, still) in enumerate(zip(transforms, fixed)):
            if velocities[number] is LEFT:
                continue
            moved = points @ transform[:3, :3].T + transform[:3, 3]
            here = MeshArrays(moved, cells.triangles, cells.segments, cells.tetrahedra)
            keys: dict = {"kind": "rigid"}
            if still:
                here = cells_of(moved, surface_of(here), here.segments)
            else:
                keys = {"material": made.of(number), "pins": pins or None}
                keys["velocity_m_per_s"] = velocities[number]
            body = self.config.add_body(name, here, offset_m=made.offset or None, **keys)
            self.sides.append((element, body))
        if not int(geometry.meta.one("self_collision", 1)):
            for body in self.config.bodies[first:]:
                self.config.switch_off(body, body)
        geometry.meta.mapped("self_collision", "/scene/collisions", "off where it is 0")

    def _held(self, geometry) -> list[dict]:
        """A pin of the fixed vertices."""
        fixed = np.ravel(geometry.vertices.all("is_fixed", [])).astype(bool)
        geometry.vertices.mapped("is_fixed", "/scene/bodies/N/pins")
        return [{"indices": np.flatnonzero(fixed).tolist()}] if fixed.any() else []

    def _velocities(self, geometry, points: np.ndarray, count: int) -> list[list[float] | None]:
        """The velocity of each instance, m/s: the mean of its vertices."""
        given = np.reshape(geometry.vertices.all("velocity", []), (-1, 3)).astype(float)
        affine = np.reshape(geometry.instances.all("velocity", []), (-1, 4, 4)).astype(float)
        turning = bool(len(affine)) and bool(np.abs(affine[:, :3, :3]).max() > 0)
        if turning or (len(given) and np.ptp(given, axis=0).max() > 0):
            words = "a body begins with one velocity of all its vertices"
            for part in (geometry.instances, geometry.vertices):
                part.changed("velocity", "a velocity of each vertex", "their mean", words)
        for part in (geometry.instances, geometry.vertices):
            part.mapped("velocity", "/scene/bodies/N/velocity_m_per_s")
        means = np.zeros((count, 3)) + (given.mean(axis=0) if len(given) else 0.0)
        if len(affine):
            means = affine[:, :3, :3] @ points.mean(axis=0) + affine[:, :3, 3]
        return [mean.tolist() if mean.any() else None for mean in means]

    def _collisions(self) -> None:
        """Pairs of bodies whose contact elements do not meet."""
        if not int(self.settings.one("contact/enable", 1)):
            self.config.no_contact()
            return
        sides = [*self.sides, *self.grounds]
        met: list[tuple[int, int]] = []
        for number, (first, one) in enumerate(self.sides):
            for second, other in sides[number:]:
                if not self.contacts.meet(first, second):
                    self.config.switch_off(one, other)
                if self.config.can_meet(one, other):
                    met.append((first, second))
        self._frictions(met)

    def _frictions(self, met: list[tuple[int, int]]) -> None:
        """A coefficient for each body and obstacle, and how those of a pair combine."""
        table = self.atlas.collection("contact_models")
        rule, of_element, wrong = self.contacts.coefficients(met)
        if self.friction_on and any(of_element.values()):
            usual = of_element.get(0, next(iter(of_element.values())))
            self.config.settings["friction"] = {"mu": usual, "eps_v_m_per_s": self.speed}
            if rule != "min":
                self.config.settings["friction"]["combine"] = rule
            for element, side in (*self.sides, *self.grounds):
                if of_element.get(element, usual) != usual:
                    side["friction"] = of_element[element]
            if wrong:
                was, became = (
                    [f"elements {a}, {b}: {pair[k]:g}" for (a, b), pair in wrong.items()] for k in (0, 1)
                )
                words = f"no coefficients of the bodies give all pairs ({rule} of both counts)"
                table.changed("friction_rate", was, became, words)
        table.mapped(
            "friction_rate", "/friction/mu and /scene/bodies/N/friction", f"the {rule} of both counts"
        )


def read(path: Path, out: Path, steps: int | None) -> tuple[SceneConfig, Card]:
    """The config of a scene and its card. Errors: UserError with file and place."""
    scene = None
    try:
        scene = Scene(path, out, steps)
        scene.contact()
        scene.bodies()
    except UserError:
        raise
    except DAMAGE as fault:
        place = scene.place if scene else "/__data__"
        found = (
            f"a scene without {fault}" if isinstance(fault, KeyError) else f"values of another form ({fault})"
        )
        raise UserError(f"{path}#{place}: found {found}; allowed: what SceneIO.save writes") from None
    scene.card.close(KNOWN)
    return scene.config, scene.card

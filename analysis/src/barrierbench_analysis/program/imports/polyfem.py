"""A scene of PolyFEM (a JSON file) as a config."""

from pathlib import Path

from .card import Card
from .config import SceneConfig
from .polyfem_bodies import Bodies
from .polyfem_geometry import SELECTION_KEYS, numbers
from .polyfem_scene import Scene

INTEGRATORS = {"ImplicitEuler": "implicit_euler", "BDF1": "implicit_euler", "BDF2": "bdf2"}
D_HAT, PART_OF_EDGE = 1e-3, 0.8  # defaults of the source: of dhat, and of dhat_percentage
MOST_LAGGING = 20  # solves of a step where the source goes on until friction settles
KINDS_OF_TIME = "ImplicitEuler, BDF1 to BDF6, ImplicitNewmark"
CONDITION = "id value dimension interpolation time_reference"
MATERIAL = "id type E nu lambda mu rho"


def _keys(above: str, names: str, consequence: str) -> list[tuple[str, str]]:
    """The same consequence for each key of an object."""
    return [(f"{above}/{name}", consequence) for name in names.split()]


KNOWN = (
    ("/solver/rayleigh_damping", "there is no Rayleigh damping, so motions that it damps there go on here"),
    *_keys(
        "/solver",
        "linear adjoint_linear nonlinear augmented_lagrangian contact advanced max_threads",
        "the solver and its tolerances are those of this program",
    ),
    *_keys(
        "/output",
        "advanced data directory json log paraview reference restart_json stats",
        "what is written is said by /output of the config",
    ),
    *_keys(
        "/tests",
        "err_h1 err_h1_semi err_l2 err_linf err_linf_grad err_lp margin time_steps",
        "the norms of its tests are not compared",
    ),
    ("/root_path", "paths are relative to the scene file"),
    ("/input/data", "the run starts at rest, not from a saved state"),
    ("/constraints/*", "the linear constraints of a file do not act"),
    *_keys(
        "/space",
        "advanced basis_type discr_order discr_orderq poly_basis_type pressure_discr_order remesh use_p_ref",
        "elements are linear and meshes stay as they are",
    ),
    ("/time/t0", "the run starts at the time 0"),
    ("/contact/collision_mesh", "the surface of the tetrahedra touches, no mesh of its own"),
    ("/contact/adhesion", "surfaces do not stick together"),
    ("/contact/periodic", "there is no periodic cell"),
    ("/contact/dhat_percentage", "d_hat is that of /contact/dhat, or its default"),
    ("/contact/use_adaptive_dhat", "d_hat is the same everywhere, but for pairs that are closer at rest"),
    ("/contact/min_distance_ratio", "d_hat is the same everywhere, but for pairs that are closer at rest"),
    ("/contact/use_gcp_formulation", "the barrier is that of IPC 2020"),
    ("/contact/alpha_t", "the barrier is that of IPC 2020"),
    ("/contact/alpha_n", "the barrier is that of IPC 2020"),
    ("/contact/use_convergent_formulation", "pairs count as one each, not with their area"),
    ("/contact/use_area_weighting", "pairs count as one each, not with their area"),
    ("/contact/use_improved_max_operator", "pairs count as one each, not with their area"),
    ("/contact/use_physical_barrier", "the stiffness of the barrier adapts as in IPC 2020"),
    ("/boundary_conditions/neumann_boundary", "the traction does not act"),
    ("/boundary_conditions/normal_aligned_neumann_boundary", "the pressure does not act"),
    ("/boundary_conditions/pressure_boundary", "the pressure does not act"),
    ("/boundary_conditions/pressure_cavity", "the pressure does not act"),
    ("/boundary_conditions/periodic_boundary", "there is no periodic boundary"),
    *_keys(
        "/boundary_conditions/dirichlet_boundary/*",
        CONDITION,
        "no vertex of a body has this id, so it holds nothing",
    ),
    *_keys(
        "/boundary_conditions/dirichlet_boundary",
        CONDITION,
        "no vertex of a body has this id, so it holds nothing",
    ),
    *_keys(
        "/boundary_conditions/obstacle_displacements/*",
        CONDITION,
        "no obstacle has this id, so it moves nothing",
    ),
    *_keys(
        "/boundary_conditions/obstacle_displacements",
        CONDITION,
        "no obstacle has this id, so it moves nothing",
    ),
    ("/initial_conditions/solution", "bodies start at rest shape"),
    *_keys("/initial_conditions/velocity/*", "id value", "no body has this id, so it moves nothing"),
    ("/initial_conditions/acceleration", "accelerations follow from the forces"),
    ("/materials/*/phi", "the material has no damping"),
    ("/materials/*/psi", "the material has no damping"),
    *_keys("/materials/*", MATERIAL, "no body has this id, so it is the material of nothing"),
    ("/units/characteristic_length", "tolerances are those of this program"),
    ("/geometry/*/curve_selection!", "curves have no conditions"),
    *_keys("/geometry/*/curve_selection", " ".join(SELECTION_KEYS), "curves have no conditions"),
    *_keys("/geometry/*/curve_selection/*", " ".join(SELECTION_KEYS), "curves have no conditions"),
    ("/geometry/*/point_selection!", "points have no conditions of their own"),
    *_keys("/geometry/*/point_selection", " ".join(SELECTION_KEYS), "points have no conditions of their own"),
    *_keys(
        "/geometry/*/point_selection/*", " ".join(SELECTION_KEYS), "points have no conditions of their own"
    ),
    ("/geometry/*/surface_selection!", "no condition has this id"),
    *_keys("/geometry/*/surface_selection", " ".join(SELECTION_KEYS), "no condition has this id"),
    *_keys("/geometry/*/surface_selection/*", " ".join(SELECTION_KEYS), "no condition has this id"),
    ("/geometry/*/volume_selection!", "the body has one material"),
    *_keys("/geometry/*/volume_selection", " ".join(SELECTION_KEYS), "the body has one material"),
    *_keys("/geometry/*/volume_selection/*", " ".join(SELECTION_KEYS), "the body has one material"),
    *_keys(
        "/geometry/*/advanced",
        "normalize_mesh force_linear_geometry refinement_location min_component",
        "the mesh is taken as it is",
    ),
    ("/geometry/*/extract", "tetrahedra are bodies, surfaces are obstacles"),
    ("/geometry/*/n_refs", "the mesh is taken as it is"),
)


def recognised(data: object) -> bool:
    """Whether a JSON file looks like a scene of PolyFEM."""
    return isinstance(data, dict) and "geometry" in data and ("materials" in data or "common" in data)


def _settings(scene: Scene) -> None:
    """Everything but bodies."""
    _integrator(scene)
    contact, card, length = scene.section("contact"), scene.card, scene.units.length
    d_hat = _d_hat(scene) * length
    card.mapped("/contact/dhat", "/formulation/d_hat_m", "a length")
    scene.config.settings |= {
        "formulation": {"name": "ipc2020", "d_hat_m": d_hat},
        "matching": {"rule": "as_given"},
    }
    friction = scene.number("/contact/friction_coefficient", contact.get("friction_coefficient", 0.0), 0)
    card.mapped("/contact/friction_coefficient", "/friction/mu")
    speed = scene.number("/contact/epsv", contact.get("epsv", 1e-3), 0) * length / scene.units.time
    card.mapped("/contact/epsv", "/friction/eps_v_m_per_s", "a speed")
    lagging = _lagging(scene)
    _stiffness(scene)
    if friction > 0:
        scene.config.settings["friction"] = {"mu": friction, "eps_v_m_per_s": speed, **lagging}
    if not contact.get("enabled", False):
        scene.config.no_contact()
    card.mapped("/contact/enabled", "/scene/collisions", "all pairs are off where it is false")


def _d_hat(scene: Scene) -> float:
    """In the unit of the scene. A default above the shortest edge of all surfaces is a part of that edge in
    the source (NonlinearElasticVarForm.cpp).
    """
    contact, card, at = scene.section("contact"), scene.card, "/contact/dhat"
    if "dhat" in contact:
        given = scene.number(at, contact["dhat"], 0)
        if given <= 0:
            raise card.refuse(at, contact["dhat"], "a length above 0")
        return given
    part = scene.number("/contact/dhat_percentage", contact.get("dhat_percentage", PART_OF_EDGE), 0)
    if not contact.get("enabled", False) or scene.shortest_edge >= D_HAT:
        card.default(at, D_HAT, "the default of the source")
        return D_HAT
    made = part * scene.shortest_edge
    if made <= 0:
        raise card.refuse("/contact/dhat_percentage", part, "a number above 0")
    card.default(
        at,
        made,
        f"the default {D_HAT:g} of the source is above the shortest edge of the surfaces,"
        f" {scene.shortest_edge:g}, of which the source takes {part:g}",
    )
    card.mapped("/contact/dhat_percentage", "/formulation/d_hat_m", "times the shortest edge of the surfaces")
    return made


def _stiffness(scene: Scene) -> None:
    """A number is a kappa that stays; without one, or with a text, the source adapts it."""
    contact, at = scene.section("solver").get("contact"), "/solver/contact/barrier_stiffness"
    given = contact.get("barrier_stiffness", "adaptive") if isinstance(contact, dict) else "adaptive"
    if isinstance(given, str):
        scene.card.mapped(at, "/formulation/name", "kappa adapts as in IPC 2020")
    else:
        scene.card.changed(at, given, "adaptive", "kappa is fixed in the source, and adapts here")


def _lagging(scene: Scene) -> dict:
    """How often a step is solved with the friction of its last end; below 0: until it changes no more."""
    contact, at = scene.section("solver").get("contact"), "/solver/contact/friction_iterations"
    count = contact.get("friction_iterations") if isinstance(contact, dict) else None
    if count is None:
        return {}
    if not isinstance(count, int) or isinstance(count, bool):
        raise scene.card.refuse(at, count, "a whole number")
    made = min(max(count, 1), MOST_LAGGING) if count >= 0 else MOST_LAGGING
    if made == count:
        scene.card.mapped(at, "/friction/lag_iterations")
    else:
        scene.card.changed(at, count, made, "this program solves a step from 1 to a given number of times")
    return {"lag_iterations": made}


def _integrator(scene: Scene) -> None:
    time, card = scene.section("time"), scene.card
    given = time.get("integrator", "ImplicitEuler")
    name = given.get("type") if isinstance(given, dict) else given
    if not isinstance(name, str):
        raise card.refuse("/time/integrator", given, KINDS_OF_TIME)
    if name == "BDF":
        name = f"BDF{given.get('steps', 1)}"
    made = INTEGRATORS.get(name)
    newmark = isinstance(given, dict) and (given.get("gamma", 0.5), given.get("beta", 0.25)) != (
        0.5,
        0.25,
    )
    if time.get("quasistatic", False) or not time:
        made = "quasi_static"
        card.left_out("/time/integrator", "a quasi-static run has no integrator")
    elif name == "ImplicitNewmark" and not newmark:
        made = "newmark"
    elif made is None:
        made = "newmark" if name == "ImplicitNewmark" else "bdf2"
        if name not in ("ImplicitNewmark", *(f"BDF{k}" for k in range(3, 7))):
            raise card.refuse("/time/integrator", given, KINDS_OF_TIME)
        card.changed("/time/integrator", given, made, "this program has no other one of this kind")
    card.mapped("/time/integrator", "/integrator/name")
    card.mapped("/time/quasistatic", "/integrator/name", "quasi_static where it is true")
    scene.config.settings["integrator"] = {"name": made}


def _gravity(scene: Scene) -> None:
    rhs = scene.section("boundary_conditions").get("rhs", [0.0, 0.0, 0.0])
    found = numbers(scene.card, "/boundary_conditions/rhs", rhs, 3, 0.0)
    if isinstance(rhs, list) and len(rhs) == 2:
        raise scene.card.refuse("/boundary_conditions/rhs", rhs, "three numbers (a scene in 3D)")
    gravity = -found * scene.units.length / scene.units.time**2
    scene.card.mapped("/boundary_conditions/rhs", "/scene/gravity_m_per_s2", "with the opposite sign")
    scene.config.scene["gravity_m_per_s2"] = (gravity + 0.0).tolist()


def read(path: Path, out: Path, steps: int | None) -> tuple[SceneConfig, Card]:
    """The config of a scene and its card. Errors: UserError with file and place."""
    scene = Scene(path, out, steps)
    _gravity(scene)
    Bodies(scene).read()
    _settings(scene)
    scene.card.close(KNOWN)
    return scene.config, scene.card

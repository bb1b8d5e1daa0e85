"""A scene for MuJoCo: a flex a body, and a point on three slides a vertex, so that masses are ours."""

import sys
from pathlib import Path
from xml.sax.saxutils import quoteattr

import mujoco
import numpy as np

HERE = Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[1]))
import common  # noqa: E402

HEAVY = 1e6  # times the mass of the scene: a given vertex, which no force moves within a step
PLANE_HALF_M = 10.0
AXES, UNITS = "xyz", ((1, 0, 0), (0, 1, 0), (0, 0, 1))
CURVED = 1e-6  # angle at rest, rad: less is a straight rod whose coordinates are rounded


def words(values):
    return " ".join(f"{v:.17g}" if isinstance(v, float) else str(v) for v in values)


def point(k, x, mass, given):
    """A vertex: a mass without size on three slides; gravity does not act on a given one."""
    slides = "".join(
        f'<joint name="{axis}{k}" type="slide" axis="{words(way)}"/>' for axis, way in zip(AXES, UNITS)
    )
    around = words(3 * [mass * 1e-4])
    inertia = f'<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{around}"/>'
    site = f'<site name="s{k}"/>'
    return (
        f'<body name="v{k}" pos="{words(x.tolist())}" gravcomp="{int(given)}">{slides}{inertia}{site}</body>'
    )


def spring(a, b, stiffness, length):
    """A tendon between two vertices: k/2 (l - l0)^2, implicit under the discrete integrator."""
    sites = f'<site site="s{a}"/><site site="s{b}"/>'
    return f'<spatial stiffness="{stiffness:.17g}" springlength="{length:.17g}">{sites}</spatial>'


def bend(rest, corner, stiffness, name):
    """Three fixed tendons, one an axis, whose length is the difference u of both segments over their lengths: the
    energy k/2 |u|^2 is k/2 (2 sin(angle/2))^2 where segments keep their lengths, ours k/2 angle^2. Without twist.
    """
    before, after = rest[corner[1]] - rest[corner[0]], rest[corner[2]] - rest[corner[1]]
    a, b = np.linalg.norm(before), np.linalg.norm(after)
    if np.linalg.norm(after / b - before / a) > CURVED:
        raise common.Refused(f"body {name}: is curved at rest; rods that are straight there can bend")
    parts = list(zip(corner, (1 / a, -(1 / a + 1 / b), 1 / b)))
    return "".join(
        f'<fixed stiffness="{stiffness:.17g}" springlength="0">'
        + "".join(f'<joint joint="{axis}{v}" coef="{share:.17g}"/>' for v, share in parts)
        + "</fixed>"
        for axis in AXES
    )


def rod_tendons(scene, body, settings):
    """Stretching and bending of a rod."""
    rod, first = body["rod"], body["first_vertex"]
    segments = scene.segments_of(body) + first
    length = np.linalg.norm(scene.rest[segments[:, 1]] - scene.rest[segments[:, 0]], axis=1)
    stretching = rod["stretching_N"] * settings["stretch_factor"]
    out = [
        spring(a, b, stretching / one, one) for (a, b), one in zip(segments.tolist(), length.tolist())
    ]
    bending = rod["bending_N_m2"] * settings["bending_factor"]
    for corner in common.corners_of(segments).tolist() if bending > 0 else ():
        a, v, b = scene.rest[corner]
        mean = (np.linalg.norm(v - a) + np.linalg.norm(b - v)) / 2
        out.append(bend(scene.rest, corner, bending / mean, body["name"]))
    return "".join(out)


def rod_surface(scene, body, settings):
    """What of a rod meets others: a flex of capsules without any stiffness."""
    first = body["first_vertex"]
    names = " ".join(f"v{first + k}" for k in range(body["vertices"]))
    ignored = 'contype="0" conaffinity="0"' if settings["contact"] == "none" else ""
    return (
        f'<flex name={quoteattr(body["name"])} dim="1" radius="{common.reach(body, settings["radius_m"]):.17g}"'
        f' body="{names}" element="{words(scene.segments_of(body).ravel().tolist())}">'
        f'<contact selfcollide="auto" condim="1" {ignored}/></flex>'
    )


def flex(scene, body, settings):
    """E and t with E t = Y and E t^3/(12 (1 - nu^2)) = D, the stiffness of hinges times a factor."""
    youngs, poisson = common.plane_stress(body["membrane"])
    youngs *= settings["stretch_factor"]
    rigidity = body["hinge_J"] * settings["bending_factor"]
    thickness = np.sqrt(12 * (1 - poisson**2) * rigidity / youngs) if rigidity > 0 else 1e-4
    kind = "both" if rigidity > 0 else "stretch"
    first, triangles = body["first_vertex"], scene.triangles_of(body)
    names = " ".join(f"v{first + k}" for k in range(body["vertices"]))
    ignored = 'contype="0" conaffinity="0"' if settings["contact"] == "none" else ""
    radius = common.reach(body, settings["radius_m"])
    return (
        f'<flex name={quoteattr(body["name"])} dim="2" radius="{radius:.17g}" body="{names}"'
        f' element="{words(triangles.ravel().tolist())}">'
        f'<elasticity young="{youngs / thickness:.17g}" poisson="{poisson:.17g}" thickness="{thickness:.17g}"'
        f' damping="{settings["damping_s"]:.17g}" elastic2d="{kind}"/>'
        f'<contact selfcollide="auto" condim="1" passive="true" {ignored}/></flex>'
    )


def geom(o, settings):
    """Frictionless; only planes and spheres that are stayed out of."""
    ignored = 'contype="0" conaffinity="0"' if settings["contact"] == "none" else ""
    if o["kind"] == "plane":
        z = np.array(o["axis"], float)
        return (
            f'<geom type="plane" size="{PLANE_HALF_M} {PLANE_HALF_M} 1" pos="{words(o["point_m"])}"'
            f' zaxis="{words(z.tolist())}" condim="1" {ignored}/>'
        )
    if o["kind"] == "sphere" and not o["inside"]:
        size, at = o["radius_m"], words(o["point_m"])
        return f'<geom type="sphere" size="{size:.17g}" pos="{at}" condim="1" {ignored}/>'
    raise common.Refused(f"obstacle {o['name']}: {o['kind']} is not mapped; planes and spheres are")


def model_of(scene, settings, dt_s):
    bare = [body["name"] for body in scene.bodies if "membrane" not in body and "rod" not in body]
    if bare:
        raise common.Refused(f"body {bare[0]}: has no membrane; a flex needs one")
    common.require(scene, rods=True)
    rods = [body for body in scene.bodies if "rod" in body]
    sheets = [body for body in scene.bodies if "rod" not in body]
    if rods and settings["contact"] == "ipc":
        raise common.Refused("contact ipc is of triangles; rods need --engine-set contact=penalty")
    mass = np.where(scene.mass > 0, scene.mass, 0)
    given = np.zeros(len(mass), bool)
    given[scene.given] = True
    mass[given] = HEAVY * mass.sum()
    points = "".join(point(k, scene.rest[k], mass[k], given[k]) for k in range(len(mass)))
    ipc = "enable" if settings["contact"] == "ipc" else "disable"
    xml = (
        f'<mujoco><option timestep="{dt_s:.17g}" integrator="discrete" solver="{settings["solver"]}"'
        f' iterations="{settings["iterations"]}" tolerance="{settings["tolerance"]:.17g}"'
        f' gravity="{words(scene.gravity.tolist())}"><flag ipc="{ipc}"/></option><size memory="2G"/>'
        f"<worldbody>{''.join(geom(o, settings) for o in scene.obstacles)}{points}</worldbody>"
        f"<deformable>{''.join(flex(scene, body, settings) for body in sheets)}"
        f"{''.join(rod_surface(scene, body, settings) for body in rods)}</deformable>"
        f"<tendon>{''.join(rod_tendons(scene, body, settings) for body in rods)}</tendon></mujoco>"
    )
    try:
        return mujoco.MjModel.from_xml_string(xml)
    except ValueError as error:
        raise common.Refused(f"MuJoCo: {error}") from error


def simulate(scene, settings, frames, notes):
    model = model_of(scene, settings, frames.dt_s)
    data = mujoco.MjData(model)
    notes["version"] = mujoco.__version__
    data.qpos[:] = (scene.x - scene.rest).ravel()  # slides are 0 where bodies are: at rest
    data.qvel[:] = scene.v.ravel()
    rows = (3 * scene.given[:, None] + np.arange(3)).ravel()
    frames.add(scene.x)
    off = 0.0
    for k in range(scene.steps):
        with frames.stepping():
            for sub in range(frames.substeps):
                target = scene.given_at(k + (sub + 1) / frames.substeps) - scene.rest[scene.given]
                data.qvel[rows] = (target.ravel() - data.qpos[rows]) / frames.dt_s
                mujoco.mj_step(model, data)
                frames.iterations.append(float(data.solver_niter[0]))
                if len(rows):
                    off = max(off, float(np.abs(data.qpos[rows] - target.ravel()).max()))
        if not frames.add(scene.rest + data.qpos.reshape(-1, 3)):
            break
    notes["given_vertices_off_m"] = off
    numbers = {str(mujoco.mjtWarning(i).name): int(w.number) for i, w in enumerate(data.warning) if w.number}
    notes["warnings"] = numbers


if __name__ == "__main__":
    common.run(HERE, simulate)

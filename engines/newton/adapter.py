"""A scene for newton on the CPU: a cloth mesh a body, stepped by VBD or by XPBD."""

import sys
from pathlib import Path

import numpy as np
import warp as wp

wp.config.quiet = True
import newton  # noqa: E402

HERE = Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[1]))
import common  # noqa: E402

UNTURNED = wp.quat(0.0, 0.0, 0.0, 1.0)
DEFAULT_UP = np.array([0.0, 0.0, 1.0])  # normal of newton's planes


def add_body(builder, scene, body, settings):
    """At rest, so that rest shapes are ours; the start is set when the model is made."""
    if "membrane" not in body:
        raise common.Refused(f"body {body['name']}: has no membrane; a cloth needs one")
    first, n = body["first_vertex"], body["vertices"]
    membrane, factor = body["membrane"], settings["stretch_factor"]
    youngs, _ = common.plane_stress(membrane)
    begin = len(builder.edge_indices)
    builder.add_cloth_mesh(
        pos=wp.vec3(0.0),
        rot=UNTURNED,
        scale=1.0,
        vel=wp.vec3(0.0),
        vertices=[wp.vec3(*p) for p in scene.rest[first : first + n].tolist()],
        indices=scene.triangles_of(body).ravel().tolist(),
        density=1.0,
        tri_ke=membrane["lame_mu_N_per_m"] * factor,
        tri_ka=membrane["lame_lambda_N_per_m"] * factor,
        tri_kd=settings["damping"],
        edge_ke=0.0,
        edge_kd=0.0,
        add_springs=settings["solver"] == "xpbd",
        spring_ke=youngs * factor,
        spring_kd=0.0,
        particle_radius=common.reach(body, settings["radius_m"]),
    )
    stiffness = body["hinge_J"] * settings["bending_factor"]
    for k in range(begin, len(builder.edge_indices)):
        builder.edge_bending_properties[k] = (stiffness / hinge_unit(builder, k, settings), 0.0)


def hinge_unit(builder, k, settings):
    """By what a solver multiplies the stiffness of hinge k: VBD by the length of its edge, m; XPBD, whose gradient of
    the angle is that of the edge's length in the place of one over a height, by twice the mean area of its triangles, m^2.
    """
    if settings["solver"] == "vbd":
        return builder.edge_rest_length[k]
    indices = builder.edge_indices[k]
    if min(indices) < 0:  # at the rim: no hinge
        return 1.0
    a, b, c, d = (np.array(builder.particle_q[i]) for i in indices)
    areas = [np.linalg.norm(np.cross(c - end, d - end)) for end in (a, b)]
    return float(np.mean(areas))


def add_obstacle(builder, o, friction):
    free = newton.ModelBuilder.ShapeConfig(mu=friction)
    if o["kind"] == "sphere" and not o["inside"]:
        at = wp.transform(wp.vec3(*o["point_m"]), UNTURNED)
        builder.add_shape_sphere(body=-1, xform=at, radius=o["radius_m"], cfg=free)
    elif o["kind"] == "plane":
        normal = np.array(o["axis"], float)
        if not np.allclose(normal, DEFAULT_UP):
            raise common.Refused(f"obstacle {o['name']}: only planes with the normal +z are mapped")
        at = wp.transform(wp.vec3(*o["point_m"]), UNTURNED)
        builder.add_shape_plane(body=-1, xform=at, width=0.0, length=0.0, cfg=free)
    else:
        raise common.Refused(f"obstacle {o['name']}: {o['kind']} is not mapped; planes and spheres are")


def model_of(scene, settings):
    builder = newton.ModelBuilder(gravity=tuple(scene.gravity.tolist()))
    for body in scene.bodies:
        add_body(builder, scene, body, settings)
    if settings["contact"]:
        for o in scene.obstacles:
            add_obstacle(builder, o, scene.friction)
    for k, mass in enumerate(scene.mass.tolist()):
        builder.particle_mass[k] = mass
    for k in scene.given.tolist():
        builder.particle_mass[k] = 0.0
        builder.particle_flags[k] = int(builder.particle_flags[k]) & ~int(newton.ParticleFlags.ACTIVE)
    if settings["solver"] == "vbd":
        builder.color(include_bending=True)
    model = builder.finalize(device="cpu")
    model.soft_contact_ke = settings["contact_N_per_m"]
    model.soft_contact_kd = settings["contact_damping"]
    model.soft_contact_mu = model.particle_mu = scene.friction
    return model


def solver_of(model, scene, settings):
    if settings["solver"] == "xpbd":
        return newton.solvers.SolverXPBD(model, iterations=settings["iterations"])
    margin = settings["margin_m"] or 2 * max(common.reach(body) for body in scene.bodies)
    return newton.solvers.SolverVBD(
        model,
        iterations=settings["iterations"],
        particle_enable_self_contact=settings["contact"],
        particle_self_contact_margin=margin,
        particle_self_contact_gap=0.75 * margin,
        particle_vertex_contact_buffer_size=64,
        particle_edge_contact_buffer_size=128,
    )


class Stepper:
    """One model with its states; `step` takes it to where given vertices are."""

    def __init__(self, scene, settings, dt_s):
        self.scene, self.dt_s = scene, dt_s
        self.model = model_of(scene, settings)
        self.solver = solver_of(self.model, scene, settings)
        self.old, self.new = self.model.state(), self.model.state()
        for state in (self.old, self.new):
            state.particle_q.assign(scene.x.astype(np.float32))
            state.particle_qd.assign(scene.v.astype(np.float32))
        self.control = self.model.control()
        self.pipeline = newton.CollisionPipeline(self.model)
        self.contacts = self.pipeline.contacts()

    def positions(self):
        return self.old.particle_q.numpy().astype(float)

    def step(self, target):
        if len(target):
            for state in (self.old, self.new):  # on the CPU numpy() is the memory itself
                state.particle_q.numpy()[self.scene.given] = target
        self.old.clear_forces()
        self.pipeline.collide(self.old, self.contacts)
        self.solver.step(self.old, self.new, self.control, self.contacts, self.dt_s)
        self.old, self.new = self.new, self.old


def simulate(scene, settings, frames, notes):
    common.require(scene, friction=True)
    notes["version"] = newton.__version__
    Stepper(scene, settings, frames.dt_s).step(scene.given_at(0))  # kernels are compiled here
    stepper = Stepper(scene, settings, frames.dt_s)
    frames.add(scene.x)
    for k in range(scene.steps):
        with frames.stepping():
            for sub in range(frames.substeps):
                stepper.step(scene.given_at(k + (sub + 1) / frames.substeps))
                frames.iterations.append(settings["iterations"])
        x = stepper.positions()
        if len(scene.given):
            off = float(np.abs(x[scene.given] - scene.given_at(k + 1)).max())
            notes["given_vertices_off_m"] = max(off, notes.get("given_vertices_off_m", 0.0))
        if not frames.add(x):
            return


if __name__ == "__main__":
    common.run(HERE, simulate)

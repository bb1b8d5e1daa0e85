"""A session folder of the ppf contact solver as a config (Ando 2024: the cubic barrier)."""

from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.mesh_arrays import MeshArrays

from .card import DAMAGE, Card
from .config import NotAtRest, SceneConfig
from .ppf_elements import KINDS, Elements, material_of
from .ppf_obstacles import Obstacles
from .ppf_session import Session, is_number

FORMULATION = "cubic_dynamic_lagged"
SHAPES = {"cubic": "cubic", "quad": "quadratic", "log": "log"}
NOT_HERE = "the solver and its tolerances are those of this program"
KNOWN = (
    *(
        (f"param.toml#/param/{key}", NOT_HERE)
        for key in (
            "min_newton_steps max_newton_steps target_toi line_search_max_t cg_max_iter cg_tol ccd_eps"
            " max_dx"
            " eiganalysis_eps csrmat_max_nnz precond schwarz_levels constraint_tol"
            " ccd_reduction ccd_max_iter"
        ).split()
    ),
    *(
        (f"param.toml#/param/{key}", "what is written is said by /output of the config")
        for key in (
            "keep_states keep_verts auto_save save_state_on_finish checkpoints fake_crash_frame"
        ).split()
    ),
    ("param.toml#/param/playback", "time runs at its own speed"),
    ("param.toml#/param/inactive_momentum", "bodies have inertia"),
    ("param.toml#/param/constraint_ghat", "obstacles have the d_hat of the bodies"),
    (
        "param.toml#/param/friction_eps",
        "friction has a speed below which contacts creep: /friction/eps_v_m_per_s",
    ),
    ("param.toml#/param/stitch_length_factor", "stitches do not act"),
    ("param.toml#/param/stitch_stiffness", "stitches do not act"),
    ("param.toml#/param/air_density", "the air does not drag"),
    ("param.toml#/param/air_friction", "the air does not drag"),
    ("param.toml#/param/isotropic_air_friction", "the air does not drag"),
    ("param.toml#/param/wind", "there is no wind"),
    ("param.toml#/param/include_face_mass", "the surface of a solid has no mass of its own"),
    ("param.toml#/param/fix_xz", "vertices move along x and z"),
    *(
        (f"info.toml#/static_transform/{key}", "colliders with keyframes stand still")
        for key in "object_count total_keyframes keyframe_counts vert_counts vert_offsets".split()
    ),
    *(
        (f"info.toml#/count/{key}", "a count")
        for key in (
            "pin_block wall sphere stitch rod_vert_start rod_vert_end shell_vert_start shell_vert_end"
            " rod_count"
            " has_rest_vert_anim rest_vert_anim_frames has_bend_rest_vert"
        ).split()
    ),
    *(
        (f"bin/{name}.bin", words)
        for name, words in (
            ("color", "a colour"),
            ("static_color", "a colour"),
            ("collider_vert", "a mark of its own"),
            ("stitch_ind", "stitches do not act"),
            ("stitch_w", "stitches do not act"),
            ("stitch_stiffness", "stitches do not act"),
            ("translation_lock", "bodies move along all axes"),
            ("rotation_lock", "bodies turn about all axes"),
            ("rotation_lock_mode", "bodies turn about all axes"),
            ("rest_vert_anim", "the rest shape stays"),
            ("rest_vert_times", "the rest shape stays"),
            ("bend_rest_vert", "hinges are at rest in the rest shape"),
            ("bend_rest_vert_mask", "hinges are at rest in the rest shape"),
            ("pdrd_body", "the body is left out"),
            ("pdrd_vert_index", "the body is left out"),
            ("pdrd_vert_list", "the body is left out"),
            ("pdrd_rest_centered", "the body is left out"),
            ("static_local_vert", "colliders with keyframes stand still"),
            ("static_transform_time", "colliders with keyframes stand still"),
            ("static_transform_translation", "colliders with keyframes stand still"),
            ("static_transform_quaternion", "colliders with keyframes stand still"),
            ("static_transform_scale", "colliders with keyframes stand still"),
            ("static_transform_interp", "colliders with keyframes stand still"),
            ("static_transform_handles", "colliders with keyframes stand still"),
        )
    ),
    ("map.pickle", "names of the frontend"),
    ("map.cbor", "names of the frontend"),
    ("surface_map.pickle", "names of the frontend"),
    ("surface_map.cbor", "names of the frontend"),
    ("session.pickle", "the frontend's own state"),
    ("fixed_session.pickle", "the frontend's own state"),
    ("command.sh", "how the solver is started"),
    ("command.ps1", "how the solver is started"),
    ("command.bat", "how the solver is started"),
)


def recognised(data: object) -> bool:
    """Whether a path is a session folder."""
    return isinstance(data, Path) and (data / "info.toml").exists() and (data / "param.toml").exists()


class Scene:
    """One session as it is read."""

    def __init__(self, folder: Path, out: Path, steps: int | None) -> None:
        if not recognised(folder):
            raise UserError(
                f"{folder}: found no session of ppf; allowed: a folder with info.toml and param.toml"
            )
        self.session = Session(folder)
        self.card = self.session.card
        dt, frames, fps = (self._number(*one) for one in (("dt", 1e-3), ("frames", 300), ("fps", 60.0)))
        count = max(1, int(np.ceil(frames / fps / dt - 1e-9)))
        self.card.mapped(
            [self.session.at(key) for key in ("dt", "frames", "fps")], "/time/dt_s and /time/steps"
        )
        if steps:
            self.card.default("--steps", steps, f"the source has {count} steps")
        self.config = SceneConfig(out, dt, steps or count)
        self.scaling = self._number("world_scaling", 1.0)
        self.card.mapped(self.session.at("world_scaling"), "the mesh files", "applied to the vertices")
        self.elements = Elements(self.session)

    def _number(self, key: str, rest: float) -> float:
        found = self.session.value(key, rest)
        if not is_number(found) or not found > 0:
            raise self.card.refuse(self.session.at(key), found, "a number above 0")
        return float(found)

    def settings(self) -> None:
        """Everything but bodies."""
        session, made, card = self.session, self.config, self.card
        gravity = session.value("gravity", [0.0, -9.8, 0.0])
        if not isinstance(gravity, list) or len(gravity) != 3 or not all(map(is_number, gravity)):
            raise card.refuse(session.at("gravity"), gravity, "three numbers")
        made.scene["gravity_m_per_s2"] = [float(g) for g in gravity]
        card.mapped(session.at("gravity"), "/scene/gravity_m_per_s2")
        if rows := session.dynamic.get("gravity"):
            del made.scene["gravity_m_per_s2"]
            made.scene["gravity_schedule"] = [{"time_s": t, "gravity_m_per_s2": g} for t, *g in rows]
            card.mapped("dyn_param.txt#/gravity", "/scene/gravity_schedule")
        for key in session.dynamic:
            card.left_out(f"dyn_param.txt#/{key}", "this parameter stays as it is at the start")
        barrier = session.value("barrier", "cubic")
        if barrier not in tuple(SHAPES):
            raise card.refuse(session.at("barrier"), barrier, ", ".join(SHAPES))
        card.changed(
            session.at("barrier"),
            f"{barrier}, its stiffness anew in every iteration",
            f"{FORMULATION}, its stiffness anew in every step",
            "Newton's method goes on to its tolerance, and a stiffness of each iteration does not settle",
        )
        shape = {} if barrier == "cubic" else {"shape": SHAPES[barrier]}
        d_hat = float(np.median(self.elements.gaps)) if len(self.elements.gaps) else 1e-3
        made.settings |= {
            "formulation": {"name": FORMULATION, "d_hat_m": d_hat, **shape},
            "matching": {"rule": "as_given"},
        }
        mode = session.value("friction_mode", "min")
        if mode not in ("min", "max", "mean"):
            raise card.refuse(session.at("friction_mode"), mode, "min, max, mean")
        card.mapped(session.at("friction_mode"), "/friction/combine")
        if self.elements.has_friction:
            made.settings["friction"] = {"mu": 0.0, "combine": mode}
        if self.limits:
            limit = max(self.limits)
            made.settings["strain_limit"] = {"limit": limit}
            if len(set(self.limits)) > 1:
                card.changed(
                    "bin/param/tri-strain-limit.bin", self.limits, limit, "there is one limit for all bodies"
                )
        if session.value("disable_contact", False):
            made.no_contact()
        card.mapped(session.at("disable_contact"), "/scene/collisions", "all pairs are off where it is true")

    # --- bodies

    def bodies(self) -> None:
        """One body for each displacement group, then colliders, walls and spheres."""
        session, self.limits = self.session, []
        shift = session.array("displacement")
        groups = session.array("vert_dmap").astype(int)
        self.points = session.array("vert") * self.scaling
        self.shifts = shift[groups] * self.scaling if len(groups) else np.zeros((0, 3))
        for group in np.unique(groups):
            self._body(int(group), np.flatnonzero(groups == group))
        for name in ("displacement", "vert_dmap", "vert", "rod", "tri", "tet", "rest_vert", "rest_vert_mask"):
            self.card.mapped(f"bin/{name}.bin", "/scene/bodies/N/mesh or rest_mesh")
        self.card.mapped("bin/uv.bin", "/scene/bodies/N/material/warp_axis", "the mean direction of u")
        self.card.mapped("info.toml#/count/shell_count", "/scene/bodies/N/mesh", "which triangles are shells")
        self.card.mapped("info.toml#/count/has_rest_vert", "/scene/bodies/N/rest_mesh")
        self._velocity_note()
        self._pins_note()
        Obstacles(session, self.config, self.elements, self.scaling).read(shift)
        self.elements.note()

    def _body(self, group: int, vertices: np.ndarray) -> None:
        found = self.elements.of(vertices)
        if found is None:
            self.card.left_out("bin/pdrd_body.bin", "the body is left out: it is rigid and moves freely")
            return
        kind, numbers, cells = found
        here = MeshArrays(
            (self.points + self.shifts)[vertices], cells.triangles, cells.segments, cells.tetrahedra
        )
        material, keys, limit = material_of(self.elements, kind, numbers, here)
        if limit:
            self.limits.append(limit)
        name = f"{KINDS[kind]}_{group}"
        velocity = self.session.array("vel")[vertices].astype(float) * self.scaling
        mean = velocity.mean(axis=0) if len(velocity) else np.zeros(3)
        self.config.add_body(
            name,
            here,
            rest_mesh=self._rest(name, vertices, here),
            material=material,
            velocity_m_per_s=mean.tolist() if mean.any() else None,
            limited=None if limit or kind != "tri" else False,
            pins=self._pins(name, vertices, here, material) or None,
            **keys,
        )

    def _rest(self, name: str, vertices: np.ndarray, cells: MeshArrays) -> dict | None:
        """The rest mesh of a body that has one of its own."""
        rest, mask = self.session.array("rest_vert"), self.session.array("rest_vert_mask")
        if not len(rest) or not len(mask) or not mask[vertices].any():
            return None
        points = np.where(mask[vertices, None] > 0, rest[vertices] * self.scaling, self.points[vertices])
        made = MeshArrays(points, cells.triangles, cells.segments, cells.tetrahedra)
        return self.config.mesh_file(f"{name}_rest", made)

    def _velocity_note(self) -> None:
        velocity, groups = self.session.array("vel"), self.session.array("vert_dmap")
        if any(
            len(v) and np.ptp(v, axis=0).any() for v in (velocity[groups == g] for g in np.unique(groups))
        ):
            self.card.changed(
                "bin/vel.bin", "a velocity of each vertex", "their mean", "a body begins with one velocity"
            )
        self.card.mapped("bin/vel.bin", "/scene/bodies/N/velocity_m_per_s", "a speed")

    def _pins(self, name: str, vertices: np.ndarray, cells: MeshArrays, material: dict) -> list[dict]:
        pins = []
        for pin in range(self.session.count("pin_block")):
            indices = self.session.numbers(f"pin-ind-{pin}", "<u8", 1)[:, 0].astype(int)
            which = np.flatnonzero(np.isin(indices, vertices))
            if len(which):
                local = np.searchsorted(vertices, indices[which])
                pins += self._pin(f"{name}_pin{pin}", pin, which, indices[which], local, cells)
        return pins

    def _pin(self, name: str, pin: int, which, indices, local, cells) -> list[dict]:
        """One pin: held, moved by its operations, pulled, for a time."""
        at = f"pin-{pin}"
        given = self.session.table(at)
        operations = self.session.operations(pin, self.scaling)
        if operations and all(one.given.get("type") == "torque" for one in operations):
            for one in operations:
                self.card.left_out(one.keys, "the torque does not act: the vertices are free")
            return []
        bad = [one for one in operations if not one.is_read]
        for one in bad:
            self.card.left_out(
                one.keys, f"the operation {one.given.get('type')} does not act: the vertices are held"
            )
        if bad:
            for one in operations:
                words = (
                    "the operation does not act, as another one of its pin is not read: the vertices are held"
                )
                self.card.left_out(one.keys, words)
        made: dict = {"indices": local.tolist()}
        if operations and not bad:
            start, shift = self.points[indices], self.shifts[indices]

            def places(time: float) -> np.ndarray:
                points = start
                for one in operations:
                    points = one.applied(points, which, time)
                return points + shift

            try:
                motion, words = self.config.motion(name, cells, local, places)
            except NotAtRest:
                raise self.card.refuse(
                    operations[0].place, "a jump at the time 0", "a motion that starts at rest"
                ) from None
            if motion:
                made["motion"] = motion
            for one in operations:
                self.card.mapped(one.keys, "/scene/bodies/N/pins/N/motion", words)
        if "unpin_time" in given:
            made["release_s"] = self.session.number(at, "unpin_time")
        if self.session.number(at, "pull", 0.0) > 0:
            self.card.left_out(
                f"info.toml#/{at}/pull",
                "the pull does not act: its stiffness is a part of mass/dt^2, and the vertices are free",
            )
            return []
        return [made]

    def _pins_note(self) -> None:
        for pin in range(self.session.count("pin_block")):
            self.card.mapped(f"bin/pin-ind-{pin}.bin", "/scene/bodies/N/pins/N/indices")
            self.card.mapped(f"info.toml#/pin-{pin}/unpin_time", "/scene/bodies/N/pins/N/release_s")
            keys = ("operation_count", "pin", "pull", "pin_group_id")
            self.card.mapped([f"info.toml#/pin-{pin}/{key}" for key in keys], "/scene/bodies/N/pins")
            self.card.left_out(f"bin/pin-pullw-{pin}.bin", "the pull does not act")
            for number in range(self.session.count("operation_count", of=f"pin-{pin}")):
                self.card.mapped(f"bin/pin-{pin}-op-{number}.bin", "/scene/bodies/N/pins/N/motion")


def read(folder: Path, out: Path, steps: int | None) -> tuple[SceneConfig, Card]:
    """The config of a session and its card. Errors: UserError with file and place."""
    try:
        scene = Scene(folder, out, steps)
        scene.bodies()
        scene.settings()
    except UserError:
        raise
    except DAMAGE as fault:
        raise UserError(
            f"{folder}/info.toml: found tables and arrays that do not fit together ({fault});"
            " allowed: what session.build() writes"
        ) from None
    scene.card.close(KNOWN)
    return scene.config, scene.card

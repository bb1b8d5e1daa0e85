"""Colliders, walls and spheres of a session of the ppf contact solver."""

import numpy as np

from .config import SceneConfig, cells_of
from .ppf_elements import Elements
from .ppf_session import Session


class Obstacles:
    """What no force moves. It joins the config."""

    def __init__(self, session: Session, config: SceneConfig, elements: Elements, scaling: float) -> None:
        self.session, self.card, self.config = session, session.card, config
        self.elements, self.scaling = elements, scaling

    def read(self, shift: np.ndarray) -> None:
        """All of them. shift: of each displacement group."""
        self._statics(shift)
        self._walls()
        self._spheres()

    def _statics(self, shift: np.ndarray) -> None:
        """Colliders: rigid bodies that stand."""
        session = self.session
        groups = session.array("static_vert_dmap").astype(int)
        points = session.array("static_vert") * self.scaling
        triangles = session.array("static_tri").astype(np.int64)
        for group in np.unique(groups):
            vertices = np.flatnonzero(groups == group)
            faces = np.flatnonzero(np.isin(triangles, vertices).all(axis=1)) if len(triangles) else []
            here = points[vertices] + shift[group] * self.scaling
            corners = np.searchsorted(vertices, triangles[faces])
            keys = self.elements.contact_keys("static", faces) if len(faces) else {}
            self.config.add_body(f"collider_{group}", cells_of(here, corners), kind="rigid", **keys)
        for name in ("static_vert_dmap", "static_vert", "static_tri"):
            self.card.mapped(f"bin/{name}.bin", "/scene/bodies/N", "a rigid body")

    def _walls(self) -> None:
        for number in range(self.session.count("wall")):
            given = self.session.table(f"wall-{number}")
            places = self.session.numbers(f"wall-pos-{number}", "<f8", 3) * self.scaling
            times = self.session.numbers(f"wall-timing-{number}", "<f8", 1)[:, 0]
            if len(places):
                self.config.add_obstacle(
                    f"wall_{number}",
                    kind="plane",
                    point_m=places[0].tolist(),
                    axis=[self.session.number(f"wall-{number}", key) for key in ("nx", "ny", "nz")],
                    motion=_keyframes(places, times, given.get("transition", "linear")),
                    friction=self.session.number(f"wall-{number}", "friction", 0.0) or None,
                )
            self._obstacle_note("wall", number, ("nx", "ny", "nz"))

    def _spheres(self) -> None:
        for number in range(self.session.count("sphere")):
            at, given = f"info.toml#/sphere-{number}", self.session.table(f"sphere-{number}")
            places = self.session.numbers(f"sphere-pos-{number}", "<f8", 3) * self.scaling
            radius = (
                self.session.numbers(f"sphere-radius-{number}", "<f4", 1)[:, 0].astype(float) * self.scaling
            )
            times = self.session.numbers(f"sphere-timing-{number}", "<f8", 1)[:, 0]
            if given.get("hemisphere", False):
                self.card.changed(f"{at}/hemisphere", True, False, "the obstacle is the whole sphere")
            if len(radius) and np.ptp(radius) > 0:
                self.card.changed(
                    f"bin/sphere-radius-{number}.bin",
                    radius.tolist(),
                    float(radius[0]),
                    "an obstacle keeps its radius",
                )
            if len(places):
                self.config.add_obstacle(
                    f"sphere_{number}",
                    kind="sphere",
                    point_m=places[0].tolist(),
                    radius_m=float(radius[0]),
                    inside=True if given.get("invert", False) else None,
                    motion=_keyframes(places, times, given.get("transition", "linear")),
                    friction=self.session.number(f"sphere-{number}", "friction", 0.0) or None,
                )
            self._obstacle_note("sphere", number, ("hemisphere", "invert"))

    def _obstacle_note(self, kind: str, number: int, more: tuple[str, ...]) -> None:
        at = f"info.toml#/{kind}-{number}"
        self.card.mapped(
            [f"{at}/{key}" for key in ("keyframe", "transition", "friction", *more)], "/scene/obstacles/N"
        )
        self.card.left_out(f"{at}/contact-gap", "a contact has the d_hat of its body")
        self.card.left_out(f"{at}/active-duration", "the obstacle acts all the time")
        self.card.left_out(f"{at}/thickness", "the obstacle has no depth beyond which it lets go")
        for part in ("pos", "timing", "radius"):
            self.card.mapped(f"bin/{kind}-{part}-{number}.bin", "/scene/obstacles/N")


def _keyframes(places: np.ndarray, times: np.ndarray, transition: str) -> dict | None:
    """The motion of an obstacle between its places."""
    if len(places) < 2:
        return None
    keys = [{"time_s": float(t), "translate_m": (p - places[0]).tolist()} for t, p in zip(times, places)]
    return {"keyframes": keys, **({"smooth": True} if transition == "smooth" else {})}

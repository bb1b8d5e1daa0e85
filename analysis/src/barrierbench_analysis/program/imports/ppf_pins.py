"""Operations on pinned vertices in a session of the ppf contact solver (pin_apply.rs at f23b356)."""

from dataclasses import dataclass

import numpy as np

from .motions import turned_about

READ = ("move_by", "move_to", "spin", "scale")
KEYS = (
    "type t_start t_end transition center_mode center_x center_y center_z axis_x axis_y axis_z"
    " angular_velocity factor axis_component magnitude hint_vertex keyframe_count rest_tx rest_ty rest_tz"
    " bezier_h_rx bezier_h_ry bezier_h_lx bezier_h_ly"
).split()
NEEDED = {
    "move_by": ("t_start", "t_end"),
    "move_to": ("t_start", "t_end"),
    "spin": ("t_start", "t_end", "angular_velocity"),
    "scale": ("t_start", "t_end", "factor"),
}
TEXTS = ("type", "transition", "center_mode")
TRANSITIONS = ("linear", "smooth")  # bezier has handles of its own


@dataclass
class Operation:
    """One operation. rows: of move_by the ways, of move_to the goals, of all pinned vertices."""

    place: str
    given: dict
    rows: np.ndarray | None
    scaling: float

    @property
    def keys(self) -> list[str]:
        """Places of what an operation may say."""
        return [f"{self.place}/{key}" for key in KEYS]

    @property
    def is_read(self) -> bool:
        """Whether its motion can be written."""
        return self.given.get("type") in READ and self.given.get("transition", "linear") in TRANSITIONS

    def progress(self, time: float) -> float:
        """The part of the operation that is done, from 0 to 1."""
        start, end = float(self.given.get("t_start", 0.0)), float(self.given.get("t_end", 0.0))
        if time < start:
            return 0.0
        if time >= end:
            return 1.0
        part = (time - start) / (end - start)
        return part * part * (3 - 2 * part) if self.given.get("transition") == "smooth" else part

    @property
    def axis(self) -> np.ndarray:
        """The axis of a spin, of any length."""
        return self._point("axis")

    def _point(self, name: str) -> np.ndarray:
        return np.array([float(self.given.get(f"{name}_{axis}", 0.0)) for axis in "xyz"])

    def applied(self, points: np.ndarray, which: np.ndarray, time: float) -> np.ndarray:
        """Where the points are after it. which: their numbers among the pinned vertices."""
        kind = self.given["type"]
        if kind == "spin":
            start, end = float(self.given["t_start"]), float(self.given["t_end"])
            angle = np.deg2rad(float(self.given["angular_velocity"])) * max(0.0, min(time, end) - start)
            if angle <= 0:  # as apply_pin_op of the source: it turns by positive angles only
                return points
            axis = self.axis
            return turned_about(
                points, self.scaling * self._point("center"), axis / np.linalg.norm(axis), angle
            )
        done = self.progress(time)
        if kind == "scale":
            center = self.scaling * self._point("center")
            return center + (1 + (float(self.given["factor"]) - 1) * done) * (points - center)
        if kind == "move_by":
            return points + done * self.rows[which]
        return (1 - done) * points + done * self.rows[which]

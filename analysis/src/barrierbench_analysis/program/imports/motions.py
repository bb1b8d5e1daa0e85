"""Places over time as a motion of this program: a translation, a rotation, or else a film."""

from collections.abc import Callable

import numpy as np

CLOSE = 1e-9  # of the size of what moves
At = Callable[[float], np.ndarray]


class NotAtRest(ValueError):
    """What moves is not where the body starts at the time 0."""


def motion_of(start: np.ndarray, at: At, times: np.ndarray) -> tuple[dict | None, str]:
    """The motion that takes the points `start` [n, 3], m, to at(t) at all times, s, and what it is in words.
    (None, ""): they stay. (None, words): only a film says it. Errors: NotAtRest.
    """
    places = np.array([at(time) for time in times])
    near = CLOSE * max(float(np.ptp(places, axis=(0, 1)).max()), 1e-9)
    if np.abs(places[0] - start).max() > near:
        raise NotAtRest
    moves = places - start
    if np.abs(moves).max() <= near:
        return None, ""
    if np.abs(moves - moves[:, :1]).max() <= near:
        return _translation(moves[:, 0], times, near)
    if (turn := _rotation(start, places, times, near)) is not None:
        return turn, "a rotation at a constant rate"
    return None, "a film of one frame a step"


def _translation(way: np.ndarray, times: np.ndarray, near: float) -> tuple[dict, str]:
    """Of all points the same: a velocity where it is constant, else keyframes where its slope changes."""
    velocity = way[-1] / times[-1]
    if np.abs(way - times[:, None] * velocity).max() <= near:
        return {"velocity_m_per_s": velocity.tolist()}, "a translation at a constant velocity"
    slopes = np.diff(way, axis=0) / np.diff(times)[:, None]
    bends = np.abs(np.diff(slopes, axis=0)).max(axis=1) * np.diff(times)[1:] > near
    kept = np.flatnonzero(np.concatenate([[True], bends, [True]]))
    keys = [{"time_s": float(times[k]), "translate_m": way[k].tolist()} for k in kept]
    return {"keyframes": keys}, "a translation through keyframes"


def _rotation(start: np.ndarray, places: np.ndarray, times: np.ndarray, near: float) -> dict | None:
    """A turn about a fixed axis at a constant rate, found from the first step and held against all others."""
    turned = _rigid(start, places[1])
    if turned is None:
        return None
    rotation, way = turned
    skew = np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    angle = np.arctan2(np.linalg.norm(skew), np.trace(rotation) - 1)
    if angle < 1e-12:
        return None
    axis = skew / np.linalg.norm(skew)
    center = np.linalg.lstsq(np.eye(3) - rotation, way, rcond=1e-9)[0]
    rate = angle / times[1]
    for time, place in zip(times, places):
        if np.abs(turned_about(start, center, axis, rate * time) - place).max() > 1e3 * near:
            return None
    return {
        "center_m": center.tolist(),
        "axis": axis.tolist(),
        "angular_velocity_rad_per_s": float(rate),
    }


def _rigid(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """The rotation R and the way s with end = R start + s in the least squares (Kabsch 1976)."""
    if len(start) < 3:
        return None
    middle, goal = start.mean(axis=0), end.mean(axis=0)
    u, _, vt = np.linalg.svd((start - middle).T @ (end - goal))
    flip = np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T)) or 1])
    rotation = vt.T @ flip @ u.T
    return rotation, goal - rotation @ middle


def turned_about(points: np.ndarray, center: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """Points turned about an axis of length 1 through a centre by an angle, rad."""
    arms = points - center
    along = (arms @ axis)[:, None] * axis
    return center + np.cos(angle) * (arms - along) + np.sin(angle) * np.cross(axis, arms) + along

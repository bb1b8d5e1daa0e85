"""The unit and the upward axis of coordinates in a file, and how they become ours: metres, z up."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Axes:
    """A right-handed system of coordinates."""

    unit_m: float = 1.0
    up: str = "z"  # or y

    def metres(self, points: np.ndarray) -> np.ndarray:
        """Points [n, 3] of the file, in m and with z up. To turn them changes no bit; a unit other than 1
        rounds."""
        if self.unit_m != 1.0:
            with np.errstate(over="ignore"):  # who reads them reports what is not finite
                points = points * self.unit_m
        return points if self.up == "z" else np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)

    def of_metres(self, points: np.ndarray) -> np.ndarray:
        """The other way: what a file with these axes has for points in m with z up."""
        points = points if self.up == "z" else np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)
        return points if self.unit_m == 1.0 else points / self.unit_m


OURS = Axes()


def chosen(of_file: Axes, unit_m: float | None, up: str | None) -> Axes:
    """The axes of the file, or those that a user states in their place."""
    return Axes(of_file.unit_m if unit_m is None else unit_m, of_file.up if up is None else up)


def sentence(axes: Axes) -> str | None:
    """What was done to coordinates with these axes; None where they are ours."""
    done = []
    if axes.unit_m != 1.0:
        done.append(f"multiplied by {axes.unit_m:g} (m per unit) and rounded")
    if axes.up != "z":
        done.append(f"turned from {axes.up} up to z up")
    return f"coordinates were {' and '.join(done)}" if done else None

"""Shadows of one light with a soft edge, that is wider the further the thing that throws them is away.

Percentage-closer soft shadows (Fernando 2005): of every point, the mean distance of what is in front of it
within the widest edge gives the width of the edge there, and the share of the light is that of samples in
it.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from barrierbench_analysis.figures.surfaces.rasterizer import Camera, DepthBuffer

MOST_PIXELS = 1400  # of the map, each way
SPAN = 5.0  # metres of the map for a metre of reach
LIGHT_SIZE = 0.22  # width of the edge for a metre between a thing and its shadow
WIDEST, SLIMMEST = 0.06, 0.004  # half widths of an edge for a metre of reach
BIAS = 0.004  # metres for a metre of reach: what is in front by less is the surface itself
SAMPLES, TURNS = 20, 5  # of a disc, and discs of neighbouring points
STEEPEST = 4.0  # tangent of the steepest surface whose slope is taken into account
GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))
AT_ONCE = 32768  # points whose light is asked for together: what is known of them stays in the cache


class Seen(NamedTuple):
    """Points [n] by the light's camera: pixels, depth, and m of depth for a m across their surface."""

    x: np.ndarray
    y: np.ndarray
    depth: np.ndarray
    slope_x: np.ndarray
    slope_y: np.ndarray


@dataclass(frozen=True)
class ShadowMap:
    """What the light sees."""

    camera: Camera  # orthographic
    depth: np.ndarray  # [pixels, pixels], metres, larger is nearer
    reach: float

    def lit(self, x: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """[n] share of the light, 0 to 1, that reaches points x [n, 3] m with unit normals [n, 3].

        Cost: up to 2 SAMPLES look-ups a point.
        """
        share = np.empty(len(x))
        span = AT_ONCE * TURNS
        parts = [slice(at + k, at + span, TURNS) for at in range(0, len(x), span) for k in range(TURNS)]
        discs = _discs()

        def light(part: slice) -> None:  # neighbours look at different samples
            share[part] = self._lit(x[part], normal[part], discs[part.start % TURNS])

        with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as threads:  # numpy leaves the interpreter free
            list(threads.map(light, parts))
        return share

    def _lit(self, x: np.ndarray, normal: np.ndarray, samples: np.ndarray) -> np.ndarray:
        """samples: [SAMPLES, 2] of the disc that is looked at."""
        seen = self.camera.project(x)
        local = normal @ self.camera.axes().T
        away = np.where(np.abs(local[:, 2:]) < 1e-3, 1e-3, local[:, 2:])
        slope = np.clip(local[:, :2] / away, -STEEPEST, STEEPEST)  # m of depth for a m across the map
        points = Seen(*seen.T.copy(), *slope.T.copy())
        widest = WIDEST * self.reach
        over, count = np.zeros(len(x)), np.zeros(len(x), int)
        for offset in samples:
            gap, nearer = self._before(points, *(widest * offset))
            over[nearer] += gap[nearer]
            count += nearer
        some = np.flatnonzero(count > 0)
        width = LIGHT_SIZE * over[some] / count[some]
        width = np.clip(width, SLIMMEST * self.reach, widest)
        dark = np.zeros(len(x))
        points = Seen(*(field[some] for field in points))
        sums = np.zeros(len(some), int)
        for offset in samples:
            sums += self._before(points, width * offset[0], width * offset[1])[1]
        dark[some] = sums
        return 1 - dark / SAMPLES

    def _before(self, seen: Seen, across, down) -> tuple[np.ndarray, np.ndarray]:
        """[n] by how much (m) what the map has at an offset (m, of all or of each) is in front of the plane
        of the surface, and whether it is something else than that.
        """
        size = len(self.depth)
        column = np.floor(seen.x + across * self.camera.scale).astype(np.int32)
        row = np.floor(seen.y + down * self.camera.scale).astype(np.int32)
        inside = (column >= 0) & (column < size) & (row >= 0) & (row < size)
        there = np.where(inside, self.depth.ravel().take(row * size + column, mode="clip"), -np.inf)
        gap = there - (seen.depth + (seen.slope_x * across + seen.slope_y * down))
        bias = BIAS * self.reach
        steep = max(bias, 0.6 / self.camera.scale)  # a point is within half a pixel of where the map was made
        return gap, gap > bias + steep * (np.abs(seen.slope_x) + np.abs(seen.slope_y))


def _discs() -> np.ndarray:
    """[TURNS, SAMPLES, 2] samples that are even over the unit disc (Vogel's spiral), turned."""
    k = np.arange(SAMPLES)
    r, angle = np.sqrt((k + 0.5) / SAMPLES), k * GOLDEN_ANGLE + 2 * np.pi / TURNS * np.arange(TURNS)[:, None]
    return np.stack([r * np.cos(angle), r * np.sin(angle)], axis=2)


def shadow_map(
    points: np.ndarray,
    triangles: np.ndarray,
    others: Callable[[Camera, int], list[np.ndarray]],
    to_light: np.ndarray,
    center: np.ndarray,
    reach: float,
    pixels: int = MOST_PIXELS,
) -> ShadowMap:
    """Of triangles and of what `others` draws: depths [pixels, pixels] by a camera. to_light: unit vector."""
    eye, up, middle = center + 10 * reach * to_light, np.array([0.0, 1.0, 0.0]), (pixels / 2, pixels / 2)
    camera = Camera(eye, center, up, pixels / (SPAN * reach), middle, False)
    buffer = DepthBuffer(pixels, pixels)
    buffer.draw(camera.project(points), triangles)
    for depth in others(camera, pixels):
        buffer.depth = np.maximum(buffer.depth, depth)
    return ShadowMap(camera, buffer.depth, reach)

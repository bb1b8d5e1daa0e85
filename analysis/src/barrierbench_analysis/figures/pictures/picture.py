"""A picture of surfaces and analytic obstacles: one light with soft shadows, a sky, smooth normals; without
a display.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb

from barrierbench_analysis.figures.surfaces.obstacle_rays import Hits, hits, signed_gap
from barrierbench_analysis.figures.surfaces.rasterizer import Camera, DepthBuffer, corner_normals

from .soft_shadow import MOST_PIXELS, ShadowMap, shadow_map

OBSTACLE_COLOR = "#C9C9C9"
OVERSAMPLING = 2  # pixels of the depth buffer for a pixel of the picture, each way
LIGHT = np.array([0.35, -0.5, 1.0]) / np.linalg.norm([0.35, -0.5, 1.0])  # direction towards it
AMBIENT, LAMP = 0.58, 0.6  # brightness away from the light of what looks upwards, and what the light adds
BELOW = 0.7  # share of AMBIENT for what looks downwards
LINE_ALPHA, LINE_PIXELS = 0.28, 1.2  # sides of the triangles of bodies
SHOWN = 1.6  # half side of the square that is shown of a plane, for a metre of reach
FADES = 0.45  # share of that from which on a plane fades into the white round it


@dataclass
class Surfaces:
    """All that is drawn: points (m), triangles, the colour of every corner of a triangle, and the
    obstacles."""

    points: np.ndarray  # [n, 3]
    triangles: np.ndarray  # [m, 3]
    corner_colors: np.ndarray  # [m, 3, 3] r g b in 0..1
    n_lined: int  # the first so many triangles have their sides drawn
    obstacles: list[dict]  # of scene.json


def camera_of(focus: np.ndarray, planar: bool, view: tuple[float, float], size: tuple[int, int]) -> Camera:
    """A camera in direction `view` (azimuth, elevation in degrees) that has all points of `focus` in the
    picture.
    """
    center = (focus.min(axis=0) + focus.max(axis=0)) / 2
    reach = float(np.linalg.norm(focus - center, axis=1).max())
    azimuth, elevation = np.radians(view)
    direction = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    up = np.array([0.0, 0.0, 1.0])
    if planar:
        direction, up = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
    elif abs(direction[2]) > 0.999:
        up = np.array([0.0, 1.0, 0.0])
    eye = center + 4 * reach * direction
    width, height = (OVERSAMPLING * s for s in size)
    unit = Camera(eye, center, up, 1.0, (0.0, 0.0), not planar).project(focus)[:, :2]
    low, high = unit.min(axis=0), unit.max(axis=0)
    scale = 0.92 * float(np.min(np.array([width, height]) / np.maximum(high - low, 1e-9)))
    middle = scale * (low + high) / 2
    return Camera(eye, center, up, scale, (width / 2 - middle[0], height / 2 - middle[1]), not planar)


def _shadows(surfaces: Surfaces, center: np.ndarray, reach: float, pixels: int) -> ShadowMap:
    """Of all surfaces, and of the obstacles that bodies are not inside of; `pixels` of the picture's longer
    side.
    """

    def others(camera: Camera, pixels: int) -> list[np.ndarray]:
        solid = [o for o in surfaces.obstacles if not o.get("inside")]
        rays = camera.rays(pixels, pixels) if solid else ()
        return [hits(o, camera, rays, center, SHOWN * reach).depth_image() for o in solid]

    of_map = min(MOST_PIXELS, 4 * pixels)
    return shadow_map(surfaces.points, surfaces.triangles, others, LIGHT, center, reach, of_map)


def _lines(buffer: DepthBuffer, projected: np.ndarray, surfaces: Surfaces, pixel: tuple) -> np.ndarray:
    """Share of each pixel that a side of a body's triangle covers, about."""
    owner, weights = buffer.owner[pixel], buffer.weights[pixel]
    p = projected[surfaces.triangles[owner]][..., :2]
    opposite = np.linalg.norm(p[:, (2, 0, 1)] - p[:, (1, 2, 0)], axis=-1)
    area = np.abs(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))
    distance = (weights * (area[:, None] / np.maximum(opposite, 1e-9))).min(axis=1)
    near = np.clip(1.5 - distance / (LINE_PIXELS * OVERSAMPLING / 2), 0, 1)
    return LINE_ALPHA * near * (owner < surfaces.n_lined)


def _shade(
    color: np.ndarray, x: np.ndarray, normal: np.ndarray, camera: Camera, shadows: ShadowMap
) -> np.ndarray:
    """[n, 3] colours under the light, and under a sky that is brightest above."""
    normal = normal * np.sign(np.einsum("nc,nc->n", normal, camera.eye - x))[:, None]  # towards the camera
    light = np.clip(normal @ LIGHT, 0, None)
    facing = np.flatnonzero(light > 0)
    light[facing] *= shadows.lit(x[facing], normal[facing])
    sky = AMBIENT * (BELOW + (1 - BELOW) * (1 + normal[:, 2]) / 2)
    return np.minimum(color * (sky + LAMP * light)[:, None], 1)


def _faded(color: np.ndarray, x: np.ndarray, center: np.ndarray, reach: float) -> np.ndarray:
    """Colours of a plane, white where it ends."""
    far = np.linalg.norm(x - center, axis=1) / (SHOWN * reach)
    t = np.clip((far - FADES) / (1 - FADES), 0, 1)[:, None]
    return color + (1 - color) * t * t * (3 - 2 * t)


def _draw_obstacles(
    image: np.ndarray,
    buffer: DepthBuffer,
    surfaces: Surfaces,
    camera: Camera,
    shadows: ShadowMap,
    center: np.ndarray,
) -> None:
    """Where an obstacle is nearer than all that was drawn before; those pixels of the buffer become the
    obstacle's.
    """
    height, width = buffer.owner.shape
    rays = camera.rays(width, height) if surfaces.obstacles else ()
    for obstacle in surfaces.obstacles:
        hit: Hits = hits(obstacle, camera, rays, center, SHOWN * shadows.reach)
        nearer = hit.depth > buffer.depth[hit.mask]
        front = tuple(index[nearer] for index in np.nonzero(hit.mask))
        x = hit.points[nearer]
        grey = np.broadcast_to(np.array(to_rgb(OBSTACLE_COLOR)), x.shape)
        shaded = _shade(grey, x, hit.normals[nearer], camera, shadows)
        plane = obstacle["kind"] == "plane"
        image[front] = _faded(shaded, x, center, shadows.reach) if plane else shaded
        buffer.depth[front], buffer.owner[front] = hit.depth[nearer], -1


def _fill_obstacles(image: np.ndarray, surfaces: Surfaces, camera: Camera) -> None:
    """Planar scenes: what the obstacles forbid, under the bodies, so that what enters them is seen."""
    height, width = image.shape[:2]
    x = camera.rays(width, height)[0].copy()
    x[..., 2] = 0
    for obstacle in surfaces.obstacles:
        image[signed_gap(obstacle, x) < 0] = to_rgb(OBSTACLE_COLOR)


def picture(
    surfaces: Surfaces, camera: Camera, size: tuple[int, int], planar: bool, center: np.ndarray, reach: float
) -> np.ndarray:
    """[height, width, 3] in 0..1: shaded by one light, with shadows; planar scenes flat."""
    buffer = DepthBuffer(size[0] * OVERSAMPLING, size[1] * OVERSAMPLING)
    projected = camera.project(surfaces.points)
    buffer.draw(projected, surfaces.triangles)
    image = np.ones((*buffer.owner.shape, 3))
    if planar:
        _fill_obstacles(image, surfaces, camera)
    else:
        shadows = _shadows(surfaces, center, reach, max(size))
        _draw_obstacles(image, buffer, surfaces, camera, shadows, center)
    pixel = np.nonzero(buffer.owner >= 0)
    owner, weights = buffer.owner[pixel], buffer.weights[pixel]
    color = np.einsum("nk,nkc->nc", weights, surfaces.corner_colors[owner])
    if not planar:
        x = np.einsum("nk,nkc->nc", weights, surfaces.points[surfaces.triangles[owner]])
        normal = np.einsum("nk,nkc->nc", weights, corner_normals(surfaces.points, surfaces.triangles)[owner])
        color = _shade(color, x, normal, camera, shadows)
    image[pixel] = color * (1 - _lines(buffer, projected, surfaces, pixel))[:, None]
    height, width = size[1], size[0]
    return image.reshape(height, OVERSAMPLING, width, OVERSAMPLING, 3).mean(axis=(1, 3)).clip(0, 1)

"""A still of one step of a run, without a display: ./bench render RUN [--step N] [--color
gap|stretch|load|body].
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_rgb
from matplotlib.patches import Patch

from . import style
from .captions import caption
from .errors import UserError, tells
from .frames import Frame, frame_of, frame_paths, points_of_bodies, read_scene, scene_at
from .front.arguments import parser_of
from .obstacle_rays import Hits, hits, primitive_gaps, signed_gap
from .rasterizer import Camera, DepthBuffer, corner_normals
from .record_file import read_record
from .records import run_row

BODY_COLORS = (
    "#0072B2",
    "#E69F00",
    "#009E73",
    "#CC79A7",
    "#56B4E9",
    "#D55E00",
    "#F0E442",
    "#999999",
)  # Okabe-Ito
OBSTACLE_COLOR = "#C9C9C9"
OVERSAMPLING = 2  # pixels of the depth buffer for a pixel of the picture, each way
LIGHT = np.array([0.35, -0.5, 1.0]) / np.linalg.norm([0.35, -0.5, 1.0])  # direction towards it
AMBIENT, SHADOWED = 0.45, 0.55  # brightness away from the light; share of the light that a shadow leaves
LINE_ALPHA, LINE_PIXELS = 0.28, 1.2  # sides of the triangles of bodies


@dataclass(frozen=True)
class Coloring:
    """A field of a frame as colours: where it stands, how it is called, its unit factor and its colour
    map."""

    element: str  # vertex or triangle
    key: str
    label: str
    factor: float
    colors: str
    top: float | None  # end of the scale; None: the largest value of the frame


COLORINGS = {
    "gap": Coloring(
        "vertex", "gap_rel", r"smallest gap of a vertex / $\hat d$ (1: no contact)", 1, "YlGnBu_r", 1
    ),
    "load": Coloring("vertex", "load_N", "contact load of a vertex (N)", 1, "magma_r", None),
    "stretch": Coloring("triangle", "stretch", "stretch of a triangle (%)", 100, "YlOrRd", None),
}


@dataclass
class Surfaces:
    """All that is drawn: points (m), triangles, the colour of every corner of a triangle, and the
    obstacles."""

    points: np.ndarray  # [n, 3]
    triangles: np.ndarray  # [m, 3]
    corner_colors: np.ndarray  # [m, 3, 3] r g b in 0..1
    n_body_triangles: int
    obstacles: list[dict]  # of scene.json


def _values(frame: Frame, coloring: Coloring) -> np.ndarray:
    """[m, 3]: the field at the corners of every triangle. Raises UserError when the frame has none."""
    fields = frame.of_vertices if coloring.element == "vertex" else frame.of_triangles
    if coloring.key not in fields:
        raise UserError(
            f"this frame has no {coloring.key}: nothing is solved before the first step; choose a step or"
            " --color body"
        )
    values = np.asarray(fields[coloring.key], float) * coloring.factor
    return values[frame.triangles] if coloring.element == "vertex" else np.repeat(values[:, None], 3, axis=1)


def _scale(values: np.ndarray, coloring: Coloring) -> Normalize:
    top = coloring.top if coloring.top is not None else float(values.max(initial=0.0))
    return Normalize(0, top if top > 0 else 1)


def _body_colors(frame: Frame, color: str) -> tuple[np.ndarray, Normalize | None]:
    """[m, 3, 3] colours of the corners, and the scale behind them (None for bodies)."""
    if color == "body":
        palette = np.array([to_rgb(c) for c in BODY_COLORS])
        return np.repeat(palette[frame.of_triangles["body"] % len(palette)][:, None, :], 3, axis=1), None
    coloring = COLORINGS[color]
    values = _values(frame, coloring)
    scale = _scale(values, coloring)
    return plt.get_cmap(coloring.colors)(scale(values))[..., :3], scale


def _rod_tubes(frame: Frame, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Three-sided tubes around the edges, so that rods have pixels."""
    points, triangles = [], []
    for a, b in frame.vertices[frame.edges]:
        axis = (b - a) / max(np.linalg.norm(b - a), 1e-300)
        u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        u /= np.linalg.norm(u)
        v = np.cross(axis, u)
        first = 6 * len(points)
        points.append(
            [end + radius * (np.cos(t) * u + np.sin(t) * v) for end in (a, b) for t in (0, 2.0944, 4.18879)]
        )
        for k in range(3):
            i, j = first + k, first + (k + 1) % 3
            triangles += [[i, j, i + 3], [j, j + 3, i + 3]]
    return np.array(points).reshape(-1, 3), np.array(triangles, int).reshape(-1, 3)


def _assemble(frame: Frame, scene: dict, color: str, reach: float) -> tuple[Surfaces, Normalize | None]:
    colors, scale = _body_colors(frame, color)
    points, triangles, corners = [frame.vertices], [frame.triangles], [colors]
    if len(frame.edges):
        tube, sides = _rod_tubes(frame, 0.006 * reach)
        body = frame.of_vertices["body"][frame.edges[:, 0]].repeat(6)
        palette = np.array([to_rgb(c) for c in BODY_COLORS])
        rgb = palette[body % len(palette)][:, None, :] if color == "body" else np.zeros(3)
        triangles.append(sides + len(frame.vertices))
        points.append(tube)
        corners.append(np.broadcast_to(rgb, (len(sides), 3, 3)))
    return (
        Surfaces(
            np.concatenate(points),
            np.concatenate(triangles),
            np.concatenate(corners),
            len(frame.triangles),
            scene["obstacles"],
        ),
        scale,
    )


def _shadow(
    surfaces: Surfaces, at: np.ndarray, center: np.ndarray, reach: float, pixels: int = 900
) -> np.ndarray:
    """True for the points `at` that a triangle or an obstacle hides from the light."""
    camera = Camera(
        center + 10 * reach * LIGHT,
        center,
        np.array([0.0, 1.0, 0.0]),
        pixels / (5 * reach),
        (pixels / 2, pixels / 2),
        False,
    )
    buffer = DepthBuffer(pixels, pixels)
    buffer.draw(camera.project(surfaces.points), surfaces.triangles)
    for obstacle in surfaces.obstacles:
        if not obstacle.get("inside"):
            buffer.depth = np.maximum(
                buffer.depth, hits(obstacle, camera, pixels, pixels, center, 1.6 * reach).depth
            )
    seen = camera.project(at)
    column, row = np.floor(seen[:, 0]).astype(int), np.floor(seen[:, 1]).astype(int)
    inside = (column >= 0) & (column < pixels) & (row >= 0) & (row < pixels)
    hidden = np.zeros(len(at), bool)
    hidden[inside] = buffer.depth[row[inside], column[inside]] > seen[inside, 2] + 0.02 * reach
    return hidden


def _lines(buffer: DepthBuffer, projected: np.ndarray, surfaces: Surfaces, pixel: tuple) -> np.ndarray:
    """Share of each pixel that a side of a body's triangle covers, about."""
    owner, weights = buffer.owner[pixel], buffer.weights[pixel]
    p = projected[surfaces.triangles[owner]][..., :2]
    opposite = np.linalg.norm(p[:, (2, 0, 1)] - p[:, (1, 2, 0)], axis=-1)
    area = np.abs(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))
    distance = (weights * (area[:, None] / np.maximum(opposite, 1e-9))).min(axis=1)
    near = np.clip(1.5 - distance / (LINE_PIXELS * OVERSAMPLING / 2), 0, 1)
    return LINE_ALPHA * near * (owner < surfaces.n_body_triangles)


def _shade(
    color: np.ndarray, x: np.ndarray, normal: np.ndarray, camera: Camera, shadow: np.ndarray
) -> np.ndarray:
    """[n, 3] colours under the light."""
    normal = normal * np.sign(np.einsum("nc,nc->n", normal, camera.eye - x))[:, None]  # towards the camera
    light = np.clip(normal @ LIGHT, 0, None) * np.where(shadow, SHADOWED, 1)
    return color * (AMBIENT + (1 - AMBIENT) * light)[:, None]


def _draw_obstacles(
    image: np.ndarray,
    buffer: DepthBuffer,
    surfaces: Surfaces,
    camera: Camera,
    center: np.ndarray,
    reach: float,
) -> None:
    """Where an obstacle is nearer than all that was drawn before; those pixels of the buffer become the
    obstacle's.
    """
    height, width = buffer.owner.shape
    for obstacle in surfaces.obstacles:
        hit: Hits = hits(obstacle, camera, width, height, center, 1.6 * reach)
        front = hit.depth > buffer.depth
        x = hit.points[front]
        grey = np.broadcast_to(np.array(to_rgb(OBSTACLE_COLOR)), x.shape)
        image[front] = _shade(grey, x, hit.normals[front], camera, _shadow(surfaces, x, center, reach))
        buffer.depth[front], buffer.owner[front] = hit.depth[front], -1


def _fill_obstacles(image: np.ndarray, surfaces: Surfaces, camera: Camera) -> None:
    """Planar scenes: what the obstacles forbid, under the bodies, so that what enters them is seen."""
    height, width = image.shape[:2]
    x = camera.rays(width, height)[0].copy()
    x[..., 2] = 0
    for obstacle in surfaces.obstacles:
        image[signed_gap(obstacle, x) < 0] = to_rgb(OBSTACLE_COLOR)


def _picture(
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
        _draw_obstacles(image, buffer, surfaces, camera, center, reach)
    pixel = np.nonzero(buffer.owner >= 0)
    owner, weights = buffer.owner[pixel], buffer.weights[pixel]
    color = np.einsum("nk,nkc->nc", weights, surfaces.corner_colors[owner])
    if not planar:
        x = np.einsum("nk,nkc->nc", weights, surfaces.points[surfaces.triangles[owner]])
        normal = np.einsum("nk,nkc->nc", weights, corner_normals(surfaces.points, surfaces.triangles)[owner])
        color = _shade(color, x, normal, camera, _shadow(surfaces, x, center, reach))
    image[pixel] = color * (1 - _lines(buffer, projected, surfaces, pixel))[:, None]
    height, width = size[1], size[0]
    return image.reshape(height, OVERSAMPLING, width, OVERSAMPLING, 3).mean(axis=(1, 3)).clip(0, 1)


def _at_obstacles(frame: Frame, scene: dict) -> str:
    """A sentence for the caption: how far the drawn surface enters obstacles, or how far it stays outside."""
    found = []  # gap, body, obstacle
    bodies = np.asarray(frame.of_vertices.get("body", np.zeros(len(frame.vertices), int)))
    for primitives in (frame.triangles, frame.edges):
        for obstacle in scene["obstacles"] if len(primitives) else []:
            gaps, body = primitive_gaps(obstacle, frame.vertices[primitives]), bodies[primitives[:, 0]]
            found += [
                (float(gaps[body == b].min()), scene["bodies"][b], obstacle["name"]) for b in np.unique(body)
            ]
    if not found:
        return ""
    entered = sorted(f for f in found if f[0] < 0)
    if entered:
        return (
            "Inside an obstacle: "
            + "; ".join(f"{body} in {name} by {-1e3 * gap:.3g} mm" for gap, body, name in entered)
            + " (flat triangles without their thickness)."
        )
    gap, body, name = min(found)
    return (
        f"No triangle is inside an obstacle: the closest is {1e3 * gap:.3g} mm away ({body} from {name},"
        " without thickness)."
    )


def _round_obstacles(scene: dict) -> np.ndarray:
    """Ends of the spheres, so that they are in the picture; planes and cylinders have none."""
    spheres = [o for o in scene["obstacles"] if o["kind"] == "sphere" and not o["inside"]]
    return np.array(
        [
            np.array(o["point_m"]) + s * o["radius_m"] * np.eye(3)[k]
            for o in spheres
            for k in range(3)
            for s in (-1, 1)
        ]
    ).reshape(-1, 3)


def _camera(focus: np.ndarray, planar: bool, view: tuple[float, float], size: tuple[int, int]) -> Camera:
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


def _annotate(fig, scene: dict, frame: Frame, color: str, scale: Normalize | None) -> None:
    """Legend of the bodies, or the bar of the colours."""
    axis = fig.axes[0]
    names = ", ".join(o["name"] for o in scene["obstacles"])
    patches = [Patch(color=OBSTACLE_COLOR, label=f"{names} (analytic)")] if names else []
    if scale is None:
        patches = [
            Patch(color=BODY_COLORS[i % len(BODY_COLORS)], label=name)
            for i, name in enumerate(scene["bodies"])
        ] + patches
    else:
        coloring = COLORINGS[color]
        fig.colorbar(
            ScalarMappable(scale, coloring.colors), ax=axis, label=coloring.label, shrink=0.7, pad=0.01
        )
    shown = (
        patches
        if len(patches) <= 12
        else patches[:11] + [Patch(color="none", label=f"and {len(patches) - 11} more")]
    )
    axis.legend(handles=shown, loc="upper left", frameon=False, fontsize=7)


def _when(record: dict, step: int) -> str:
    if step < 0:
        return "start"
    return next(
        (f"end of step {step}, t = {s['t_s']:g} s" for s in record["steps"] if s["step"] == step),
        f"end of step {step}",
    )


def render(
    run: str | Path,
    step: int | None = None,
    color: str = "body",
    out: str | Path | None = None,
    view: tuple[float, float] = (-60.0, 22.0),
    size: tuple[int, int] = (1000, 720),
) -> Path:
    """Writes a PNG of one frame and its caption; returns the PNG.

    run: folder of run.json. step: a step with a frame, -1 for the start; None: the last one. view: azimuth
    and elevation of the camera, degrees. size: pixels of the picture without legend. Raises UserError,
    RecordError.
    """
    run = Path(run).parent if Path(run).name == "run.json" else Path(run)
    record = read_record(run / "run.json")
    paths, scene = frame_paths(record, run), read_scene(record, run)
    step = max(paths) if step is None else step
    if step not in paths:
        raise UserError(
            f"{run}: no frame of step {step}; there are {', '.join(map(str, paths))} (-1: the start)"
        )
    frame = frame_of(record, run, step)
    scene = scene_at(scene, frame)
    focus = np.concatenate([points_of_bodies(scene, frame.vertices), _round_obstacles(scene)])
    camera = _camera(focus, scene["planar"], view, size)
    reach = float(np.linalg.norm(focus - camera.target, axis=1).max())
    surfaces, scale = _assemble(frame, scene, color, reach)
    picture = _picture(surfaces, camera, size, scene["planar"], camera.target, reach)
    fig, axis = plt.subplots(
        figsize=(style.WIDE_IN, style.WIDE_IN * size[1] / size[0] + 0.2), layout="constrained"
    )
    axis.imshow(picture, interpolation="antialiased")
    axis.set_axis_off()
    what = f"{record['labels']['scene']}, {record['labels']['formulation']}, {_when(record, step)}"
    axis.set_title(what)
    _annotate(fig, scene, frame, color, scale)
    name = "start" if step < 0 else f"step_{step:06}"
    path = Path(out) if out else run / f"{name}_{color}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    fig.savefig(path, metadata={"Software": None})
    plt.close(fig)
    colored = "bodies in one colour each" if color == "body" else f"colour: {COLORINGS[color].label}"
    path.with_suffix(".txt").write_text(
        caption(
            f"{what}. Shown: {colored}; analytic obstacles grey, at their true size; sides of triangles as"
            f" thin lines. {_at_obstacles(frame, scene)}".rstrip(),
            [run_row(record)],
        )
    )
    return path


@tells("render")
def main(arguments: list[str]) -> int:
    parser = parser_of("render")
    parser.add_argument("run", type=Path, metavar="RUN", help="folder of run.json")
    parser.add_argument("--step", type=int, help="a step with a frame, -1: the start (default: the last)")
    parser.add_argument(
        "--color", choices=["body", *COLORINGS], default="body", help="what colours mean (default: body)"
    )
    parser.add_argument("--out", type=Path, help="the PNG (default: RUN/step_NNNNNN_COLOR.png)")
    parser.add_argument(
        "--view",
        type=float,
        nargs=2,
        default=(-60.0, 22.0),
        metavar=("AZIMUTH", "ELEVATION"),
        help="direction to the camera, degrees (default: -60 22)",
    )
    parser.add_argument(
        "--size",
        type=int,
        nargs=2,
        default=(1000, 720),
        metavar=("WIDTH", "HEIGHT"),
        help="pixels (default: 1000 720)",
    )
    given = parser.parse_args(arguments)
    if min(given.size) < 16 or max(given.size) > 8000:
        raise UserError("--size: from 16 to 8000 pixels")
    print(render(given.run, given.step, given.color, given.out, tuple(given.view), tuple(given.size)))
    return 0

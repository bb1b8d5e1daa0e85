"""The pixels of a frame of a run: surfaces, rods and obstacles before a camera that holds them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.colors import Normalize

from barrierbench_analysis.figures.surfaces.grid_splines import GridSplines
from barrierbench_analysis.figures.surfaces.obstacle_mesh import obstacle_mesh
from barrierbench_analysis.figures.surfaces.rod_tubes import tubes
from barrierbench_analysis.figures.surfaces.sequence import finer_frame
from barrierbench_analysis.io.frames import (
    Frame,
    frame_of,
    frame_paths,
    points_of_bodies,
    read_scene,
    scene_at,
    without_bodies,
)

from . import vtk_picture
from .coloring import colors_of_corners, palette
from .picture import Surfaces, camera_of, picture

RENDERERS = ("own", "vtk")
THINNEST = 0.006  # radius of a rod for a metre of reach: thinner ones would have no pixels


@dataclass(frozen=True)
class Look:
    """How a still is drawn."""

    color: str = "body"
    view: tuple[float, float] = (-60.0, 22.0)  # azimuth and elevation of the camera, degrees
    size: tuple[int, int] = (1000, 720)  # pixels of the picture without legend
    subdivide: int = 0  # how often triangles are cut, for a surface that is curved between the vertices
    bare: bool = False  # the picture alone, without title and legend
    hidden: tuple[str, ...] = ()  # bodies that are not drawn
    bicubic: tuple[int, int] | None = None  # points along columns and rows of grids; None: as they are
    renderer: str = RENDERERS[0]


def _assemble(
    frame: Frame,
    scene: dict,
    color: str,
    reach: float,
    radii: np.ndarray | None = None,
    times: int = 0,
    top: float | None = None,
) -> tuple[Surfaces, Normalize | None]:
    """radii: [n] m of rods, at their vertices. times: how often the frame was subdivided; sides of its
    triangles are drawn where it was not. top: as colors_of_corners.
    """
    colors, scale = colors_of_corners(frame, color, top)
    points, triangles, corners = [frame.vertices], [frame.triangles], [colors]
    if len(frame.edges):
        radii = np.maximum(0 if radii is None else radii, np.full(len(frame.vertices), THINNEST * reach))
        made, sides, of = tubes(frame.vertices, frame.edges, radii, 2**times)
        rgb = palette(frame.of_vertices["body"][of])[:, None, :] if color == "body" else np.zeros(3)
        triangles.append(sides + len(frame.vertices))
        points.append(made)
        corners.append(np.broadcast_to(rgb, (len(sides), 3, 3)))
    lined, joined = 0 if times else len(frame.triangles), map(np.concatenate, (points, triangles, corners))
    return Surfaces(*joined, lined, scene["obstacles"]), scale


def _rod_radii(record: dict, scene: dict, frame: Frame) -> np.ndarray:
    """[n] m: the offset of the body of each vertex, at which its contact begins; 0 where it has none."""
    given = record["config"]["scene"].get("bodies") or []
    offsets = {body.get("name"): body.get("offset_m") or 0.0 for body in given}
    of_bodies = np.array([offsets.get(name, 0.0) for name in scene["bodies"]] or [0.0])
    return of_bodies[np.minimum(frame.of_vertices["body"], len(of_bodies) - 1)]


def _round_obstacles(scene: dict) -> np.ndarray:
    """Points of the spheres, so that they are in the picture; planes and cylinders have none."""
    spheres = [o for o in scene["obstacles"] if o["kind"] == "sphere" and not o["inside"]]
    return np.concatenate([np.zeros((0, 3)), *(obstacle_mesh(o, np.zeros(3), 0.0)[0] for o in spheres)])


def _points_drawn(frame: Frame, scene: dict, look: Look) -> np.ndarray:
    """[n, 3] m: the vertices that the picture has to hold."""
    points = points_of_bodies(scene, frame.vertices)
    if not look.hidden:
        return points
    shown = without_bodies(frame, scene, look.hidden)
    used = np.unique(np.concatenate([shown.triangles.ravel(), shown.edges.ravel()]).astype(int))
    return points[used[used < len(points)]]


@dataclass(frozen=True)
class Shared:
    """What the frames of a film have in common."""

    focus: np.ndarray  # [n, 3] m: points that the picture has to hold
    top: float | None  # end of the scale of the colours


def focus_of(frame: Frame, scene: dict, look: Look) -> np.ndarray:
    """[n, 3] m: the points of a frame that the picture has to hold."""
    return np.concatenate([_points_drawn(frame, scene, look), _round_obstacles(scene)])


def drawn(
    frame: Frame, scene: dict, look: Look, radii: np.ndarray | None, shared: Shared | None = None
) -> tuple[np.ndarray, Normalize | None]:
    """[height, width, 3] pixels of a frame in its scene, and the scale of the colours. radii: as
    _assemble.
    """
    focus = focus_of(frame, scene, look) if shared is None else shared.focus
    camera = camera_of(focus, scene["planar"], look.view, look.size)
    reach = float(np.linalg.norm(focus - camera.target, axis=1).max())
    top = None if shared is None else shared.top
    surfaces, scale = _assemble(
        frame, scene, look.color, reach, radii, look.subdivide or look.bicubic is not None, top
    )
    draw = picture if look.renderer == "own" else vtk_picture.picture
    return draw(surfaces, camera, look.size, scene["planar"], camera.target, reach), scale


def drawn_of_run(
    record: dict, run: Path, step: int, look: Look, shared: Shared | None = None
) -> tuple[np.ndarray, Normalize | None, Frame, dict]:
    """As `drawn`, of the frame of a step, with that frame and its scene."""
    whole = frame_of(record, run, step)
    scene = scene_at(read_scene(record, run), whole)
    frame = whole
    if look.subdivide or look.bicubic:
        start = frame_of(record, run, min(frame_paths(record, run)))
        if look.bicubic:
            frame = GridSplines(record, scene, start, look.bicubic, look.hidden).finer(frame)
        else:
            frame = finer_frame(start, frame, len(scene["bodies"]), look.subdivide)
        if shared is None:
            shared = Shared(focus_of(whole, scene, look), None)
    frame = without_bodies(frame, scene, look.hidden)
    return *drawn(frame, scene, look, _rod_radii(record, scene, frame), shared), whole, scene

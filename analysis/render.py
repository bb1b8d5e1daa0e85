"""A still of one step of a run, without a display: ./bench render RUN [--step N] [--color
gap|stretch|load|body].
"""

from __future__ import annotations

import argparse
import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize

from . import style
from .captions import caption
from .coloring import COLORINGS, annotate, colors_of_corners, palette
from .errors import UserError, tells
from .frames import Frame, frame_of, frame_paths, points_of_bodies, read_scene, scene_at, without_bodies
from .frames_out.obstacle_mesh import obstacle_mesh
from .frames_out.sequence import finer_frame
from .front.arguments import color_argument, finite_number, parser_of
from .obstacle_rays import primitive_gaps
from .picture import Surfaces, camera_of, picture
from .picture_file import MEANS, picture_file
from .progress import say_where
from .record_file import read_record
from .rod_tubes import tubes
from .run_rows import run_row
from .titles import broken
from .whole_file import write_whole, write_whole_bytes

MOST_TIMES = 4  # 4^4 = 256 triangles for one
BAR_IN = 1.2  # inches beside a picture that a bar of colours takes
THINNEST = 0.006  # radius of a rod for a metre of reach: thinner ones would have no pixels


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
    return (
        Surfaces(
            np.concatenate(points),
            np.concatenate(triangles),
            np.concatenate(corners),
            0 if times else len(frame.triangles),
            scene["obstacles"],
        ),
        scale,
    )


def _rod_radii(record: dict, scene: dict, frame: Frame) -> np.ndarray:
    """[n] m: the offset of the body of each vertex, at which its contact begins; 0 where it has none."""
    given = record["config"]["scene"].get("bodies") or []
    offsets = {body.get("name"): body.get("offset_m") or 0.0 for body in given}
    of_bodies = np.array([offsets.get(name, 0.0) for name in scene["bodies"]] or [0.0])
    return of_bodies[np.minimum(frame.of_vertices["body"], len(of_bodies) - 1)]


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
    """Points of the spheres, so that they are in the picture; planes and cylinders have none."""
    spheres = [o for o in scene["obstacles"] if o["kind"] == "sphere" and not o["inside"]]
    return np.concatenate([np.zeros((0, 3)), *(obstacle_mesh(o, np.zeros(3), 0.0)[0] for o in spheres)])


def title_of(record: dict) -> str:
    """What a run is called above its pictures: as tables call it, or by scene and formulation."""
    labels = record["labels"]
    return labels.get("note") or f"{labels['scene']}, {labels['formulation']}"


def when(record: dict, step: int) -> str:
    if step < 0:
        return "start"
    return next(
        (f"end of step {step}, t = {s['t_s']:g} s" for s in record["steps"] if s["step"] == step),
        f"end of step {step}",
    )


@dataclass(frozen=True)
class Look:
    """How a still is drawn."""

    color: str = "body"
    view: tuple[float, float] = (-60.0, 22.0)  # azimuth and elevation of the camera, degrees
    size: tuple[int, int] = (1000, 720)  # pixels of the picture without legend
    subdivide: int = 0  # how often triangles are cut, for a surface that is curved between the vertices
    bare: bool = False  # the picture alone, without title and legend
    hidden: tuple[str, ...] = ()  # bodies that are not drawn


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
    surfaces, scale = _assemble(frame, scene, look.color, reach, radii, look.subdivide, top)
    return picture(surfaces, camera, look.size, scene["planar"], camera.target, reach), scale


def drawn_of_run(
    record: dict, run: Path, step: int, look: Look, shared: Shared | None = None
) -> tuple[np.ndarray, Normalize | None, Frame, dict]:
    """As `drawn`, of the frame of a step, with that frame and its scene."""
    whole = frame_of(record, run, step)
    scene = scene_at(read_scene(record, run), whole)
    frame = whole
    if look.subdivide:
        start = frame_of(record, run, min(frame_paths(record, run)))
        frame = finer_frame(start, frame, len(scene["bodies"]), look.subdivide)
        if shared is None:
            shared = Shared(focus_of(whole, scene, look), None)
    frame = without_bodies(frame, scene, look.hidden)
    return *drawn(frame, scene, look, _rod_radii(record, scene, frame), shared), whole, scene


def save_bare(path: Path, pixels: np.ndarray) -> None:
    """Errors: OSError. Whole or not there."""
    out = io.BytesIO()
    plt.imsave(out, pixels, format="png", metadata={"Software": None}, pil_kwargs={"optimize": True})
    write_whole_bytes(path, out.getvalue())


def save_annotated(file, pixels: np.ndarray, title: str, annotate: Callable) -> None:
    """A PNG, into a file by name or open. A title that is wider than the picture is broken."""
    height, width = pixels.shape[:2]
    fig, axis = plt.subplots(figsize=(style.WIDE_IN, style.WIDE_IN * height / width), layout="constrained")
    axis.imshow(pixels, interpolation="antialiased")
    axis.set_axis_off()
    annotate(fig)
    room = style.WIDE_IN - (BAR_IN if len(fig.axes) > 1 else 0.2)
    text = broken(fig, title, room, plt.rcParams["axes.titlesize"])
    fig.set_figheight(fig.get_figheight() + 0.2 + 0.15 * text.count("\n"))
    axis.set_title(text)
    fig.savefig(file, format="png", metadata={"Software": None})
    plt.close(fig)


def shown(look: Look) -> str:
    """The sentence of the caption on what is seen."""
    colored = (
        "bodies in one colour each" if look.color == "body" else f"colour: {COLORINGS[look.color].label}"
    )
    surface = (
        f"triangles cut {look.subdivide} times, curved between the vertices of the simulation"
        if look.subdivide
        else "sides of triangles as thin lines"
    )
    hidden = f"; not drawn: {', '.join(look.hidden)}" if look.hidden else ""
    return f"Shown: {colored}; analytic obstacles grey, at their true size; {surface}{hidden}."


def render(
    run: str | Path,
    step: int | None = None,
    out: str | Path | None = None,
    look: Look | None = None,
    title: str = "",
) -> Path:
    """Writes a PNG of one frame and its caption; returns the PNG.

    run: folder of run.json. step: a step with a frame, -1 for the start; None: the last one. out: as
    picture_file takes it. title: what is shown, instead of scene and formulation. Raises UserError,
    RecordError.
    """
    run, look = Path(run).parent if Path(run).name == "run.json" else Path(run), look or Look()
    record = read_record(run / "run.json")
    paths = frame_paths(record, run)
    step = max(paths) if step is None else step
    if step not in paths:
        raise UserError(
            f"{run}: no frame of step {step}; there are {', '.join(map(str, paths))} (-1: the start)"
        )
    name = f"{'start' if step < 0 else f'step_{step:06}'}_{look.color}.png"
    path = picture_file(out or run, name)
    say_where(f"render: drawing {path.name}")
    pixels, scale, frame, scene = drawn_of_run(record, run, step, look)
    say_where("")
    what = f"{title or title_of(record)}, {when(record, step)}"
    path.parent.mkdir(parents=True, exist_ok=True)
    if look.bare:
        save_bare(path, pixels)
    else:
        out = io.BytesIO()
        save_annotated(out, pixels, what, lambda fig: annotate(fig, scene, frame, look.color, scale))
        write_whole_bytes(path, out.getvalue())
    text = f"{what}. {shown(look)} {_at_obstacles(frame, scene)}".rstrip()
    write_whole(path.with_suffix(".txt"), caption(text, [run_row(record)]))
    return path


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "render",
        "A config in the place of RUN: its start is drawn, nothing is run.",
        "./bench render results/runs/drape --color gap --out drape.gif",
        "./bench render configs/scenes/sheets_on_ball.json --out start.png",
    )
    parser.add_argument("run", type=Path, metavar="RUN", help="folder of run.json; or a config")
    parser.add_argument("--step", type=int, help="a step with a frame, -1: the start (default: the last)")
    color_argument(parser, ["body", *COLORINGS], "body", "what colors mean")
    parser.add_argument(
        "--out",
        type=Path,
        help=f"{MEANS}; FILE.gif or FILE.mp4: all frames in motion (default: RUN/step_NNNNNN_COLOR.png;"
        " NAME_start.png of a config NAME.json)",
    )
    parser.add_argument(
        "--fps",
        type=finite_number,
        metavar="N",
        help="frames a second of a GIF or MP4 (default: for 5 s)",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="/POINTER=VALUE",
        dest="overrides",
        help="override of a config, e.g. /scene/n=8",
    )
    look_arguments(parser)
    given = parser.parse_args(arguments)
    if min(given.size) < 16 or max(given.size) > 8000:
        raise UserError("--size: from 16 to 8000 pixels")
    return given


def look_arguments(parser: argparse.ArgumentParser) -> None:
    """How a picture is drawn, beside its colours."""
    parser.add_argument(
        "--view",
        type=finite_number,
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
    parser.add_argument(
        "--subdivide",
        type=int,
        choices=range(1, MOST_TIMES + 1),
        default=0,
        metavar="N",
        help=f"cut every triangle into 4, N times (1 to {MOST_TIMES}), for a surface that is curved between"
        " its vertices and smooth at rods; gaps are judged without",
    )
    parser.add_argument("--bare", action="store_true", help="the picture alone, without title and legend")
    parser.add_argument(
        "--hide", nargs="+", default=(), metavar="BODY", help="bodies that are not drawn, such as a container"
    )


def _is_film(out: Path | None) -> bool:
    return out is not None and out.suffix.lower() in (".gif", ".mp4")


def written(given: argparse.Namespace) -> Path:
    """What was asked for. Errors: UserError, RecordError."""
    look = Look(
        given.color, tuple(given.view), tuple(given.size), given.subdivide, given.bare, tuple(given.hide)
    )
    is_config = given.run.is_file() and given.run.name != "run.json"
    if given.fps is not None and not (_is_film(given.out) and 0 < given.fps <= 240):
        raise UserError(
            f"--fps: found {given.fps:g}; allowed: above 0, at most 240, for a GIF or MP4 (--out)"
        )
    if given.step is not None and (is_config or _is_film(given.out)):
        raise UserError("--step: is of one still of a run, not of a config, GIF or MP4")
    if given.overrides and not is_config:
        raise UserError("--set: is of a config; a run is drawn as it was")
    if is_config:
        from .preview import preview  # these two draw with what is above

        return preview(given.run, given.out, look, given.overrides)
    if _is_film(given.out):
        from .animation import animate

        return animate(given.run, given.out, look, given.fps)
    return render(given.run, given.step, given.out, look)


@tells("render")
def main(arguments: list[str]) -> int:
    print(written(parse(arguments)))
    return 0

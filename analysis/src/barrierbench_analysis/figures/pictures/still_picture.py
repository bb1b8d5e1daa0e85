"""A still of one step of a run as a PNG with its title, its legend and its caption, without a display."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.captions import caption
from barrierbench_analysis.figures.surfaces.obstacle_rays import primitive_gaps
from barrierbench_analysis.figures.titles import broken
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import Frame, frame_paths
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import bytes_of, write_whole, write_whole_bytes
from barrierbench_analysis.program.progress import say_where
from barrierbench_analysis.tables.run_rows import run_row

from .coloring import COLORINGS, annotate
from .frame_pixels import Look, drawn_of_run

BAR_IN = 1.2  # inches beside a picture that a bar of colours takes


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


def bare(pixels: np.ndarray) -> bytes:
    """A PNG of the picture alone."""
    options = {"format": "png", "metadata": {"Software": None}, "pil_kwargs": {"optimize": True}}
    return bytes_of(lambda out: plt.imsave(out, pixels, **options))


def annotated(pixels: np.ndarray, title: str, annotate: Callable) -> bytes:
    """A PNG with title and legend. A title that is wider than the picture is broken."""
    height, width = pixels.shape[:2]
    fig, axis = plt.subplots(figsize=(style.WIDE_IN, style.WIDE_IN * height / width), layout="constrained")
    axis.imshow(pixels, interpolation="antialiased")
    axis.set_axis_off()
    annotate(fig)
    room = style.WIDE_IN - (BAR_IN if len(fig.axes) > 1 else 0.2)
    text = broken(fig, title, room, plt.rcParams["axes.titlesize"])
    fig.set_figheight(fig.get_figheight() + 0.2 + 0.15 * text.count("\n"))
    axis.set_title(text)
    made = bytes_of(lambda out: fig.savefig(out, format="png", metadata={"Software": None}))
    plt.close(fig)
    return made


def png(look: Look, pixels: np.ndarray, title: str, annotate: Callable) -> bytes:
    """As the look has it."""
    return bare(pixels) if look.bare else annotated(pixels, title, annotate)


def shown(look: Look) -> str:
    """The sentence of the caption on what is seen."""
    colored = (
        "bodies in one colour each" if look.color == "body" else f"colour: {COLORINGS[look.color].label}"
    )
    surface = "sides of triangles as thin lines"
    if look.subdivide:
        surface = f"triangles cut {look.subdivide} times, curved between the vertices of the simulation"
    if look.bicubic:
        surface = "grids with {} x {} points on cubic splines through the vertices of the simulation".format(
            *look.bicubic
        )
    hidden = f"; not drawn: {', '.join(look.hidden)}" if look.hidden else ""
    by = "; drawn by VTK" if look.renderer == "vtk" else ""
    return f"Shown: {colored}; analytic obstacles grey, at their true size; {surface}{hidden}{by}."


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
    legend = partial(annotate, scene=scene, frame=frame, color=look.color, scale=scale)
    write_whole_bytes(path, png(look, pixels, what, legend))
    text = f"{what}. {shown(look)} {_at_obstacles(frame, scene)}".rstrip()
    write_whole(path.with_suffix(".txt"), caption(text, [run_row(record)]))
    return path


# --- picture file


SUFFIX = ".png"
MEANS = f"a file that ends in {SUFFIX} (it is added to a name without an ending), or a folder that is there"


def picture_file(out: str | Path, name: str) -> Path:
    """The very file that will be written. name: what it is called in a folder that is there. Errors:
    UserError for another ending, since a picture of another kind would bear it.
    """
    out = Path(out)
    if out.is_dir():
        return out / name
    if not out.suffix:
        return out.with_name(out.name + SUFFIX)
    if out.suffix.lower() != SUFFIX:
        raise UserError(f"--out {out}: found the ending {out.suffix}; allowed: {MEANS}")
    return out

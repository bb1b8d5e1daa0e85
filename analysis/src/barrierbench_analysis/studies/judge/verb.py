"""./bench judge TRAJECTORY: one record (judgement.json), one page (judgement.html), exit 0 clean, 1 not."""

import argparse
import json
import shlex
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.whole_file import check_can_be_written, write_whole
from barrierbench_analysis.program.arguments import axes_arguments, number_type, parser_of
from barrierbench_analysis.program.trajectories.readers import read_trajectory
from barrierbench_analysis.program.trajectories.trajectory import MOST_METRES, Trajectory, checked, with_parts

from .about import About, about_of, with_cells
from .ask import audited, subject_of
from .energy import Motion, energy_of, words
from .physics import Physics, finite_or_none
from .verdict import findings, meaning, verdict_of
from .weld import seam_note, welded

CLEAN, NOT_CLEAN = 0, 1
FILES = ("judgement.json", "judgement.html")  # record and page
WIDE_M = 100.0  # beyond it a note asks for the unit: millimetres look like that
DOC = """TRAJECTORY: a folder of numbered frames (OBJ, PLY, STL, VTU, VTP, VTK, MSH, VTM), a .pvd collection,
.pc2, .mdd, .npz, USD, Alembic (.abc), VTKHDF, or a run of barrierbench. What its files do not say (obstacles,
rods, thickness, densities): --about FILE (configs/schema/judge.schema.json). Every frame is judged by exact
signs, and the straight line from each frame to the next as a motion. Exit 0: clean, 1: not, 2: cannot be
judged."""


def parse(argv: list[str]) -> argparse.Namespace:
    parser = parser_of(
        "judge", DOC, "./bench judge out/frames --about scene.json --reference results/runs/drape"
    )
    parser.add_argument("trajectory", type=Path)
    parser.add_argument("--about", type=Path, metavar="FILE.json")
    parser.add_argument(
        "--topology",
        type=Path,
        metavar="MESH",
        help="for frames without cells (.pc2, .mdd, .npz): a mesh file of the same vertices",
    )
    parser.add_argument(
        "--displacement",
        metavar="FIELD",
        help="field of points that is added to points at rest (default: one of a usual name, where the points"
        " of all frames are the same); none: the points alone",
    )
    parser.add_argument(
        "--weld",
        type=number_type("a number from 0", lambda value: value >= 0),
        metavar="M",
        help="vertices of the first frame that are so close (0: in one place) are one",
    )
    parser.add_argument(
        "--reference", type=Path, metavar="TRAJECTORY", help="another one of the same vertices: how far apart"
    )
    axes_arguments(parser, "TRAJECTORY")
    parser.add_argument(
        "--reach",
        type=number_type(
            f"a number above 0, at most {MOST_METRES:g}", lambda value: 0 < value <= MOST_METRES
        ),
        metavar="M",
        help="gaps above it are not measured (default: a tenth of the mean edge)",
    )
    parser.add_argument(
        "--states-only", action="store_true", help="what happens between frames does not decide"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("judgement"),
        help="folder of judgement.json and .html (default: judgement)",
    )
    return parser.parse_args(argv)


def read(options: argparse.Namespace) -> tuple[Trajectory, About]:
    """The trajectory with all that is known of it. Errors: UserError."""
    found = read_trajectory(
        options.trajectory, options.topology, options.displacement, options.scale, options.up
    )
    found, _ = welded(found, options.weld)
    data, found = with_cells(found, options.about)
    topology, notes = with_parts(checked(found).topology)
    found = replace(found, topology=topology, notes=found.notes + notes)
    if topology.polygons:
        cut = "polygons of more than three corners were cut into triangles, by the places of the first frame"
        found = replace(found, notes=(*found.notes, f"{topology.polygons} {cut}"))
    return found, about_of(data, options.about, found)


def times_of(trajectory: Trajectory, about: About) -> np.ndarray | None:
    if about.dt_s is not None:
        return about.dt_s * np.arange(len(trajectory.labels))
    return None if trajectory.times_s is None else np.array(trajectory.times_s)


class Watch:
    """What is measured of the frames while they go to the program."""

    def __init__(self, trajectory: Trajectory, about: About, reference: Trajectory | None):
        self.trajectory, self.about = trajectory, about
        self.physics: Physics | None = None
        self.motion: Motion | None = None
        self.rows: list[dict] = []
        self.reference = reference.frames() if reference else None
        self.largest_m = 0.0
        self.unknown = 0  # frames of the reference that are not finite
        self.first: np.ndarray | None = None
        self.moves = False

    @np.errstate(all="ignore")
    def __call__(self, number: int, x: np.ndarray) -> None:
        t = self.trajectory
        if self.physics is None:
            times, rest = times_of(t, self.about), x if self.about.rest_m is None else self.about.rest_m
            self.physics = Physics(t.topology, self.about, rest, times)
            self.motion = Motion(self.physics.mass, self.about, times)
            self.largest_m = float(np.ptp(x, axis=0).max())
            self.first = np.array(x)
        self.moves = self.moves or not np.array_equal(x, self.first, equal_nan=True)
        row = self.physics.of(number, x)
        self.motion.add(number, x)
        if self.reference is not None and (other := next(self.reference, None)) is not None:
            apart = np.linalg.norm(x - other, axis=1)
            row["apart_max_m"] = finite_or_none(apart.max())
            row["apart_rms_m"] = finite_or_none(np.sqrt((apart**2).mean()))
            self.unknown += not np.isfinite(other).all()
        self.rows.append(row)


def reference_of(options: argparse.Namespace, trajectory: Trajectory) -> Trajectory | None:
    if options.reference is None:
        return None
    found = read_trajectory(options.reference, None, options.displacement)  # its vertices alone are read
    found, _ = welded(found, options.weld)
    n, m = trajectory.topology.n_vertices, found.topology.n_vertices
    if n != m:
        raise UserError(f"{options.reference}: {m} vertices; the trajectory has {n}")
    if len(found.labels) != len(trajectory.labels):
        have = f"{len(found.labels)} frames; the trajectory has {len(trajectory.labels)}"
        raise UserError(f"{options.reference}: {have}")
    return found


def notes_of(trajectory: Trajectory, watch: Watch) -> list[str]:
    """What a reader has to know beside the verdict: of the files, of their unit, of the reference."""
    notes = [*trajectory.notes, *trajectory.heard]
    if watch.first is not None:
        notes += seam_note(trajectory.topology, watch.first)
    if watch.largest_m > WIDE_M:
        notes.append(f"the first frame is {watch.largest_m:g} m wide: if its unit is mm, --scale 0.001")
    if watch.unknown:
        notes.append(f"{watch.unknown} frames of the reference hold numbers that are none")
    return notes


def judged(options: argparse.Namespace) -> dict:
    """The record. Errors: UserError."""
    start = time.perf_counter()
    trajectory, about = read(options)
    watch = Watch(trajectory, about, reference_of(options, trajectory))
    first = next(trajectory.frames())
    subject = subject_of(trajectory, about, first, options.reach)
    for name in FILES:
        check_can_be_written(options.out / name)
    frames, total, reading_s = audited(trajectory, about, subject, watch)
    for frame, row, label in zip(frames, watch.rows, trajectory.labels):
        frame |= row | {"label": label}
        volumes = frame.pop("volume_rel", {})  # the program says which bodies are closed
        if closed := {name: volumes[name] for name in total["closed_bodies"] if name in volumes}:
            frame["volume_rel"] = closed
    times = times_of(trajectory, about)
    return {
        "schema": "barrierbench.judgement/1",
        "verdict": verdict_of(total, frames, options.states_only),
        "states_only": options.states_only,
        "trajectory": {
            "source": trajectory.source,
            "format": trajectory.format,
            "frames": len(frames),
            "first": trajectory.labels[0],
            "last": trajectory.labels[-1],
            "bodies": list(trajectory.topology.names),
            "times_s": None if times is None else times.tolist(),
            "frame_numbers": trajectory.frame_numbers,
            "displacement": trajectory.displacement,
            "moves": watch.moves if len(frames) > 1 else None,
        },
        "reach_m": subject["reach_m"],
        "total": total,
        "energy": energy_of(trajectory.topology, about, watch.motion, frames),
        "findings": findings(frames, trajectory.labels, options.states_only),
        "frames": frames,
        "notes": notes_of(trajectory, watch),
        "reading_s": reading_s,
        "whole_s": time.perf_counter() - start,
    }


def still(record: dict) -> str:
    """For the first line: a film in which nothing moves shows nothing of what a program did."""
    if record["trajectory"]["moves"] is not False:
        return ""
    return f" (no vertex moves in {record['trajectory']['frames']} frames)"


def summary(record: dict) -> str:
    """What is printed: verdict, what was judged, the first findings."""
    total = record["total"]
    closed = len(total["closed_bodies"])
    lines = [
        f"{record['verdict']}{still(record)}: {meaning(record)}",
        f"judged: {total['frames']} frames of {total['triangles']} triangles, {total['edges']} edges, "
        f"{total['vertices']} vertices and {total['obstacles']} obstacles; {total['state_pairs']} pairs in"
        f" states, {total['motion_pairs']} in motions; {total['sides_asked']} vertices against {closed}"
        " closed bodies",
    ]
    rows = record["findings"]
    for row in rows[:5]:
        depth = f", {row['depth_m']:.3g} m deep" if row["depth_m"] else ""
        lines.append(
            f"{row['frame']}: {row['count']} {row['what']}{': ' + row['pair'] if row['pair'] else ''}{depth}"
        )
    if len(rows) > 5:
        lines.append(f"and {len(rows) - 5} more rows")
    lines += words(record["energy"])
    return "\n".join([*lines, *(f"note: {note}" for note in record["notes"])])


@reported("judge")
def main(argv: list[str]) -> int:
    options = parse(argv)
    record = judged(options) | {"command": shlex.join(["./bench", "judge", *argv])}
    text = json.dumps(record, indent=1, allow_nan=False)
    json_file, page_file = (options.out / name for name in FILES)
    write_whole(json_file, text + "\n")
    print(summary(record), flush=True)
    from .page import page_of  # takes a second to load: what was found is printed before

    write_whole(page_file, page_of(record))
    print(page_file, file=sys.stderr)
    return CLEAN if record["verdict"] == "clean" else NOT_CLEAN

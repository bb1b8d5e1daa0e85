"""An experiment: a cloth that tears along edges chosen before the run.

The mesh is cut along its weak edges into two lips a small slit apart, stitches that break join them, two legs
are pulled apart, and the front of the tear and the force are drawn. No fracture criterion of the cloth is
modelled. README.md says more.
"""

import argparse
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.frames import frame_paths, frames_of
from barrierbench_analysis.io.record_file import read_record

SIZE = (0.2, 0.1)  # m, of the cloth along x and y
SLIT = 5e-4  # m, between the lips at rest
D_HAT = 1e-3  # m
SEAM_N_PER_M = 12.0  # strength of cloth along an edge of weight 1, per length of it
STITCH_N_PER_M2 = 2e4  # stiffness of the stitches, per length of the line
PULL_N_PER_M = 2.0  # of each pulled vertex
SPEED, DT = 0.1, 0.01  # m/s of each leg, s
EXPERIMENT = (
    "EXPERIMENT: the tear follows edges that are chosen before the run; no fracture criterion is modelled"
)


@dataclass
class Mesh:
    vertices: np.ndarray  # [n, 3] m
    triangles: np.ndarray  # [m, 3]


@dataclass
class Cut:
    mesh: Mesh  # upper lips are the first vertices' own, lower lips come last
    upper: np.ndarray  # [k] vertices along the line
    lower: np.ndarray  # [k] their doubles
    length: np.ndarray  # [k] m, of the line that each stands for
    weight: np.ndarray  # [k] of the line there


def grid(columns: int, rows: int) -> Mesh:
    """Of so many vertices along x and y, round the origin."""
    x, y = (
        np.linspace(-side / 2, side / 2, count) for side, count in zip(SIZE, (columns, rows), strict=True)
    )
    vertices = np.array([(a, b, 0.0) for b in y for a in x])
    at = np.arange(columns * rows).reshape(rows, columns)
    quads = [at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]]
    a, b, c, d = (q.ravel() for q in quads)
    return Mesh(vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))


def edges(mesh: Mesh) -> np.ndarray:
    """[e, 2] ascending, each once."""
    pairs = np.concatenate([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def edge_weights(mesh: Mesh, strong: float | None) -> np.ndarray:
    """[e] 1: cloth that does not tear. Below: the line y = 0, weaker; from x = `strong` (m) on less so."""
    ends = mesh.vertices[edges(mesh)]
    on_line = (abs(ends[:, :, 1]) < 1e-9).all(axis=1)
    middle = ends[:, :, 0].mean(axis=1)
    weak = np.where(middle > strong, 0.9, 0.3) if strong is not None else np.full(len(ends), 0.3)
    return np.where(on_line, weak, 1.0)


def line_of(weak: np.ndarray) -> np.ndarray:
    """Vertices of the weak edges [e, 2], from one end of their path to the other."""
    neighbours: dict[int, list[int]] = {}
    for a, b in weak.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    ends = sorted(v for v, near in neighbours.items() if len(near) == 1)
    if len(ends) != 2 or max(map(len, neighbours.values())) > 2:
        raise SystemExit(
            f"weak edges: found {len(ends)} ends; allowed: one path with two ends, without branches"
        )
    path = [ends[0]]
    while len(path) < len(neighbours):
        path.append(next(v for v in neighbours[path[-1]] if v not in path[-2:]))
    return np.array(path)


def cut(mesh: Mesh, weights: np.ndarray) -> Cut:
    """Along the edges whose weight is below 1, from border to border: every vertex there gets a double, and
    the two are moved apart by a slit.
    """
    pairs = edges(mesh)
    weak = weights < 1
    path = line_of(pairs[weak])
    of_edge = {tuple(pair): weight for pair, weight in zip(pairs.tolist(), weights, strict=True)}
    along = [tuple(sorted((int(a), int(b)))) for a, b in zip(path, path[1:], strict=False)]
    sides = np.linalg.norm(np.diff(mesh.vertices[path], axis=0), axis=1)
    parts = np.array([side * of_edge[edge] for side, edge in zip(sides, along, strict=True)])
    length = (np.append(sides, 0) + np.append(0, sides)) / 2
    weight = (np.append(parts, 0) + np.append(0, parts)) / 2 / length
    double = np.arange(len(mesh.vertices))
    double[path] = len(mesh.vertices) + np.arange(len(path))
    vertices = np.concatenate([mesh.vertices, mesh.vertices[path]])
    below = mesh.vertices[mesh.triangles][:, :, 1].mean(axis=1) < 0
    triangles = np.where(below[:, None], double[mesh.triangles], mesh.triangles)
    vertices[path, 1] += SLIT / 2
    vertices[double[path], 1] -= SLIT / 2
    return Cut(Mesh(vertices, triangles), path, double[path], length, weight)


def write_mesh(mesh: Mesh, path: Path) -> None:
    lines = ["v " + " ".join(map(repr, map(float, v))) for v in mesh.vertices]
    lines += ["f " + " ".join(str(v + 1) for v in t) for t in mesh.triangles]
    path.write_text("\n".join(lines) + "\n")


def stitch_strengths(made: Cut) -> np.ndarray:
    """[k] N."""
    return SEAM_N_PER_M * made.length * made.weight


def legs(made: Cut) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of the left side above and below the line, without the lips."""
    x, y = made.mesh.vertices[:, 0], made.mesh.vertices[:, 1]
    left = x < x.min() + 1e-9
    return np.flatnonzero(left & (y > SLIT)), np.flatnonzero(left & (y < -SLIT))


def config_of(made: Cut, steps: int) -> dict:
    strengths = stitch_strengths(made)
    pins = []
    for leg, way in zip(legs(made), (1, -1), strict=True):
        motion = {"velocity_m_per_s": [0, 0, way * SPEED]}
        pins.append({"indices": leg.tolist(), "pull_N_per_m": PULL_N_PER_M, "motion": motion})
    cloth = {
        "name": "cloth",
        "mesh": {"file": "cloth.obj"},
        "material": {"youngs_N_per_m": 100.0, "bending_J": 1e-5, "density_kg_per_m2": 0.2},
        "weights": [{"name": "seam", "file": "seam.txt"}],
        "pins": pins,
    }
    stitches = {
        "a": "cloth", "a_vertices": made.upper.tolist(), "b": "cloth", "b_vertices": made.lower.tolist(),
        "stiffness_N_per_m": STITCH_N_PER_M2 * made.length.max(), "rest_length_m": SLIT,
        "strength_N": strengths.max(), "weights": "seam",
    }  # fmt: skip
    return {
        "schema": "barrierbench.config/1",
        "name": EXPERIMENT,
        "scene": {"gravity_m_per_s2": [0, 0, 0], "bodies": [cloth], "stitches": [stitches]},
        "formulation": {"name": "log", "d_hat_m": D_HAT},
        "time": {"dt_s": DT, "steps": steps},
        "passes": {"time": True},
        "output": {"frames_every": 1},
    }


def write_scene(made: Cut, folder: Path, steps: int) -> Path:
    """Mesh, weights and config."""
    folder.mkdir(parents=True, exist_ok=True)
    write_mesh(made.mesh, folder / "cloth.obj")
    strengths, weights = stitch_strengths(made), np.ones(len(made.mesh.vertices))
    weights[made.upper] = strengths / strengths.max()
    (folder / "seam.txt").write_text("\n".join(repr(float(w)) for w in weights) + "\n")
    path = folder / "tearing.json"
    path.write_text(json.dumps(config_of(made, steps), indent=1) + "\n")
    return path


@dataclass
class Tear:
    t: np.ndarray  # [s] s, at the ends of steps
    broken: np.ndarray  # [s, k] whether each stitch is broken once the step is over
    force: np.ndarray  # [s] N, with which the upper leg is pulled
    x: np.ndarray  # [s, n, 3] m

    def front(self, made: Cut) -> np.ndarray:
        """[s] m from the left side: how far every stitch is broken."""
        until = np.where(self.broken.all(axis=1), len(made.upper), np.argmin(self.broken, axis=1))
        return np.append(0, np.cumsum(made.length))[until]


def read_tear(made: Cut, folder: Path) -> Tear:
    """What frames say: a stitch is broken from the first step end on at which its tension was beyond its
    strength. Ends where the record counts others.
    """
    record = read_record(folder / "run.json")
    if record["status"]["outcome"] != "ok":
        raise SystemExit(
            f"{folder}: found the outcome {record['status']['outcome']}: {record['status']['detail']}"
        )
    config = record["config"]["scene"]["stitches"][0]
    steps = [step for step in frame_paths(record, folder) if step >= 0]
    x = np.array([frame.vertices for frame in frames_of(record, folder, steps)])
    t = np.array([record["steps"][step]["t_s"] for step in steps])
    tension = config["stiffness_N_per_m"] * (
        np.linalg.norm(x[:, made.lower] - x[:, made.upper], axis=2) - SLIT
    )
    broken = np.maximum.accumulate(tension > stitch_strengths(made), axis=0)
    counted = [record["steps"][step]["broken_stitches"] for step in steps]
    if (off := np.flatnonzero(broken.sum(axis=1) != counted)).size:
        raise SystemExit(
            f"{folder}: {counted[off[0]]} broken stitches after step {steps[off[0]]}, not those of the frames"
        )
    upper = legs(made)[0]
    force = PULL_N_PER_M * (SPEED * t[:, None] - x[:, upper, 2]).sum(axis=1)
    return Tear(t, broken, force, x)


def draw_state(axis, made: Cut, tear: Tear, step: int) -> None:
    x = tear.x[step]
    half = SPEED * tear.t[-1]
    axis.plot_trisurf(
        *x.T, triangles=made.mesh.triangles, color="0.85", edgecolor="0.45", linewidth=0.1, shade=False
    )
    for pair in np.stack([made.upper, made.lower], 1)[~tear.broken[step]]:
        axis.plot(*x[pair].T, color="tab:red", linewidth=2)
    axis.set(title=f"t = {tear.t[step]:.2f} s", xlim=(-0.1, 0.1), ylim=(-0.05, 0.05), zlim=(-half, half))
    axis.set_box_aspect((0.2, 0.1, 2 * half), zoom=1.15)
    axis.view_init(elev=20, azim=-60)
    axis.set_axis_off()


def draw(made: Cut, tear: Tear, path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure = plt.figure(figsize=(10, 6.5))
    grid_of = figure.add_gridspec(2, 4, height_ratios=(1.2, 1))
    through = int(np.argmax(tear.broken.all(axis=1))) or len(tear.t) - 1
    for i, (values, label) in enumerate(
        [
            (1e3 * tear.front(made), "front of the tear (mm from the left side)"),
            (tear.force, "force on the upper leg (N)"),
        ]
    ):
        axis = figure.add_subplot(grid_of[0, 2 * i : 2 * i + 2])
        axis.plot(tear.t, values)
        axis.set(xlabel="t (s)", ylabel=label)
        axis.axvline(tear.t[through], color="0.7", linestyle=":")
    for i, step in enumerate((through // 4, through // 2, 3 * through // 4, through)):
        draw_state(figure.add_subplot(grid_of[1, i], projection="3d"), made, tear, step)
    figure.suptitle(EXPERIMENT + "\nred: stitches that hold; dotted: all are broken", fontsize=9)
    figure.tight_layout()
    figure.savefig(path, dpi=120)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, help="folder of the scene, the run and the figure")
    parser.add_argument("--columns", type=int, default=41, help="vertices along the line (default: 41)")
    parser.add_argument("--rows", type=int, default=21, help="vertices across it, odd (default: 21)")
    parser.add_argument("--steps", type=int, default=260, help=f"of {DT} s (default: 260)")
    parser.add_argument(
        "--strong-from-m", type=float, help="x from which the line has three times the strength"
    )
    parser.add_argument("--program", type=Path, default=Path("build/release/experiments/barrierbench"))
    given = parser.parse_args()
    whole = grid(given.columns, given.rows)
    made = cut(whole, edge_weights(whole, given.strong_from_m))
    config, run = write_scene(made, given.out, given.steps), given.out / "run"
    subprocess.run([given.program, "run", config, "--out", run], check=True)
    tear = read_tear(made, run)
    draw(made, tear, given.out / "tearing.png")
    last = tear.broken[-1].sum()
    print(
        f"{last} of {len(made.upper)} stitches are broken at {tear.t[-1]:.2f} s,"
        f" largest force {tear.force.max():.3g} N"
    )


if __name__ == "__main__":
    main()

"""The stages of our contact pipeline beside those of the IPC Toolkit (ipctk), on one surface in motion.

Ours run in the program contact_stages, the toolkit's in this process: stage by stage in turn, so that what
else the machine does meets both. Prints a table of the shortest times and their ratios, since other work can
only lengthen a sample; every sample is kept as JSON beside it.
"""

import argparse
import datetime
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import finite_number, parser_of

from .toolkit_meshes import generated_sheets, read_ply, write_problem

DATA = Path(os.environ.get("BARRIERBENCH_DATA", ROOT / "data"))
PROGRAM = ROOT / "build/release/experiments/microbenchmarks/contact_stages"

STAGES = {  # in the order of one Newton iteration
    "candidates_standing": "candidates, standing",
    "rows": "rows with d < d_hat",
    "gradient_and_hessian": "projected Hessian with grad^2 d, gradient, assembled",
    "energies": "energies",
    "candidates_motion": "candidates, motion",
    "step_bound": "step bound of these",
    "motion_to_bound": "candidates as far as the motion goes, and its step bound",
}


class Ours:
    """contact_stages, asked line by line."""

    def __init__(self, program: Path, problem: Path, threads: int):
        self.process = subprocess.Popen(
            [program, problem, str(threads)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def run(self, stage: str) -> dict:
        self.process.stdin.write(stage + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise UserError(f"contact_stages ended in stage {stage} (exit code {self.process.wait()})")
        return json.loads(line)

    def close(self) -> None:
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()


class Toolkit:
    """The same stages by ipctk; energies and gradients are those of ours (its potential over d_hat^2)."""

    def __init__(self, x0, x1, faces, d_hat: float, threads: int):
        import ipctk
        import numpy as np

        ipctk.set_num_threads(threads)
        self.kit, self.norm = ipctk, np.linalg.norm
        self.mesh = ipctk.CollisionMesh(x0, ipctk.edges(faces), faces)
        self.x0, self.x1, self.d_hat = np.asfortranarray(x0), np.asfortranarray(x1), d_hat
        self.potential = ipctk.BarrierPotential(d_hat, 1.0)

    def candidates_standing(self):
        self.standing = self.kit.Candidates()
        self.standing.build(self.mesh, self.x0, self.d_hat / 2, self.kit.LBVH())
        return len(self.standing), 0

    def rows(self):
        self.collisions = self.kit.NormalCollisions()
        self.collisions.collision_set_type = self.kit.NormalCollisions.CollisionSetType.IPC
        self.collisions.use_area_weighting = False
        self.collisions.build(self.standing, self.mesh, self.x0, self.d_hat)
        return len(self.collisions), 0

    def gradient_and_hessian(self):
        gradient = self.potential.gradient(self.collisions, self.mesh, self.x0)
        self.potential.hessian(self.collisions, self.mesh, self.x0, self.kit.PSDProjectionMethod.CLAMP)
        return len(self.collisions), self.norm(gradient) / self.d_hat**2

    def energies(self):
        return len(self.collisions), self.potential(self.collisions, self.mesh, self.x0) / self.d_hat**2

    def candidates_motion(self):
        self.moving = self.kit.Candidates()
        self.moving.build(self.mesh, self.x0, self.x1, self.d_hat / 2, self.kit.LBVH())
        return len(self.moving), 0

    def step_bound(self):
        alpha = self.moving.compute_collision_free_stepsize(
            self.mesh, self.x0, self.x1, narrow_phase_ccd=self.kit.AdditiveCCD()
        )
        return len(self.moving), alpha

    def motion_to_bound(self):
        """It has no such thing: the last two again."""
        self.candidates_motion()
        return self.step_bound()

    def run(self, stage: str) -> dict:
        start = time.perf_counter()
        items, value = getattr(self, stage)()
        seconds = time.perf_counter() - start
        if stage == "rows":
            items = self.pairs()
        return {"stage": stage, "s": seconds, "items": items, "value": value}

    def pairs(self) -> int:
        """The toolkit merges the pairs of one feature into a collision whose weight is their number."""
        return round(sum(self.collisions[k].weight for k in range(len(self.collisions))))


def disagreement(ours: dict, theirs: dict) -> str | None:
    """What differs between two answers of one stage although it must not; what a stage handles may differ
    where each code has its own rule for candidates, and a step bound is conservative in its own way.
    """
    stage = ours["stage"]
    if stage == "rows" and ours["items"] != theirs["items"]:
        return f"{ours['items']} pairs, toolkit {theirs['items']}"
    if stage in ("gradient_and_hessian", "energies"):
        if not abs(ours["value"] - theirs["value"]) <= 1e-9 * abs(theirs["value"]):
            return f"{stage}: {ours['value']}, toolkit {theirs['value']}"
    if stage in ("step_bound", "motion_to_bound") and not 0.8 * theirs["value"] <= ours["value"] <= 1:
        return f"step bound {ours['value']}, toolkit {theirs['value']}"
    return None


def compare(ours: Ours, toolkit: Toolkit, rounds: int) -> dict[str, dict[str, list[dict]]]:
    """All answers by stage and side; the first round warms up and is dropped."""
    answers = {stage: {"ours": [], "toolkit": []} for stage in STAGES}
    for turn in range(rounds + 1):
        for stage in STAGES:
            sides = [("ours", ours), ("toolkit", toolkit)]
            pair = {name: side.run(stage) for name, side in (sides if turn % 2 == 0 else sides[::-1])}
            wrong = disagreement(pair["ours"], pair["toolkit"])
            if wrong:
                raise UserError(f"the two disagree: {wrong}")
            for name, answer in pair.items():
                if turn > 0:
                    answers[stage][name].append(answer)
    return answers


def rows_of_table(answers) -> list[dict]:
    out = []
    for stage, sides in answers.items():
        row = {"stage": stage}
        for name, side in sides.items():
            row[f"{name}_s"] = min(answer["s"] for answer in side)
            row |= {f"{name}_{key}": side[-1][key] for key in ("items", "value")}
        out.append({**row, "ratio": row["toolkit_s"] / row["ours_s"]})
    return out


def table_text(rows: list[dict]) -> str:
    cells = []
    for row in rows:
        times = [f"{row[side]:.3g} s" for side in ("ours_s", "toolkit_s")]
        items = f"{row['ours_items']}, {row['toolkit_items']}"
        cells.append([STAGES[row["stage"]], *times, f"{row['ratio']:.1f}x", items])
    return "\n".join(markdown(["stage", "ours", "toolkit", "ratio", "items: ours, toolkit"], cells))


def load_mesh(name: str, size: int, d_hat: float):
    """(name, start, end, triangles); the generated sheets where the data folder has no cloth."""
    if name == "cloth_ball":
        meshes = DATA / "meshes"
        if (meshes / "cloth_ball92.ply").is_file() and (meshes / "cloth_ball93.ply").is_file():
            x0, faces = read_ply(meshes / "cloth_ball92.ply")
            x1, _ = read_ply(meshes / "cloth_ball93.ply")
            return "cloth_ball92 -> 93", x0, x1, faces
        print(
            f"compare-toolkit: no cloth_ball92.ply and cloth_ball93.ply in {meshes} (BARRIERBENCH_DATA): "
            "three generated sheets instead",
            file=sys.stderr,
        )
    x0, x1, faces = generated_sheets(size, d_hat)
    return f"three sheets of {size + 1}^2", x0, x1, faces


def arguments(argv: list[str] | None) -> argparse.Namespace:
    parser = parser_of("study compare-toolkit", __doc__)
    parser.add_argument(
        "--mesh",
        choices=["cloth_ball", "sheets"],
        default="cloth_ball",
        help="cloth_ball needs the optional data folder (BARRIERBENCH_DATA)",
    )
    parser.add_argument("--size", type=int, default=120, help="cells along a generated sheet")
    parser.add_argument("--d-hat", type=finite_number, default=1e-2, help="m")
    parser.add_argument("--rounds", type=int, default=5, help="timed after one that warms up")
    parser.add_argument("--threads", type=int, default=1, help="of both")
    parser.add_argument(
        "--out", type=Path, default=ROOT / "results/runs/compare_toolkit", help="folder of the JSON"
    )
    parser.add_argument("--program", type=Path, default=PROGRAM, help=argparse.SUPPRESS)
    args = parser.parse_args(argv)
    if args.rounds < 1 or args.size < 2 or args.threads < 1 or not args.d_hat > 0:
        raise UserError("--rounds and --threads at least 1, --size at least 2, --d-hat above 0")
    return args


def measured(args: argparse.Namespace, x0, x1, faces) -> tuple[dict, float]:
    """All answers by stage and side, and the load of the machine when it began. Raises UserError where the
    two disagree.
    """
    with tempfile.TemporaryDirectory() as folder:
        problem = Path(folder) / "problem.bin"
        write_problem(problem, x0, x0, x1, faces, args.d_hat)
        ours = Ours(args.program, problem, args.threads)
        load = os.getloadavg()[0]
        answers = compare(ours, Toolkit(x0, x1, faces, args.d_hat, args.threads), args.rounds)
        ours.close()
    return answers, load


@reported("study compare-toolkit")
def main(argv: list[str]) -> int:
    args = arguments(argv)
    try:
        import ipctk
    except ImportError:
        raise UserError(
            "the Python package ipctk is not installed (analysis/requirements-oracle.txt)"
        ) from None
    name, x0, x1, faces = load_mesh(args.mesh, args.size, args.d_hat)
    answers, load = measured(args, x0, x1, faces)
    rows = rows_of_table(answers)
    now = datetime.datetime.now(datetime.timezone.utc)
    record = {
        "mesh": name,
        "vertices": len(x0),
        "triangles": len(faces),
        "d_hat_m": args.d_hat,
        "threads": args.threads,
        "rounds": args.rounds,
        "ipctk": ipctk.__version__,
        "date": now.isoformat(timespec="seconds"),
        "machine": platform.machine(),
        "cores": os.cpu_count(),
        "load_at_start": load,
        "table": rows,
        "answers": answers,
    }
    args.out.mkdir(parents=True, exist_ok=True)
    path = args.out / f"{now:%Y-%m-%dT%H%M%SZ}.json"
    write_whole(path, json.dumps(record, indent=1) + "\n")
    print(
        f"{name}, {len(x0)} vertices, d_hat {args.d_hat} m, {args.threads} thread(s), shortest of"
        f" {args.rounds}; ipctk {ipctk.__version__}"
    )
    print(table_text(rows))
    print(f"compare-toolkit: all samples in {path}", file=sys.stderr)
    return 0

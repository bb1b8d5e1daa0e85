"""The corpus of hard systems: the verb `bench study matrix-corpus` makes results/matrices and its table from
configs/matrices/corpus.json.

Every system is that of one Newton iteration of a small run, written by /output/matrices; only its `cause` is
added here. The table replays all of them (`barrierbench matrix`); it has no times, so that it is the same on
every machine with the same libraries.
"""

from __future__ import annotations

import json
import math
import shutil
import sys
import tempfile
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, passed_on, tells
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.io.whole_file import copy_whole, write_whole
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.program.start import started

MOST_BYTES = 8 << 20
DIRECT = ["cholmod", "lagged_cholesky"]
PCG = ["none", "jacobi", "block_jacobi", "ic0", "schwarz", "mas"]
RESIDENT = ["pcg_resident block_jacobi", "pcg_resident multilevel_schwarz"]
SOLVERS = DIRECT + PCG + RESIDENT
HEAD = """# Hard systems as data

Linear systems A x = b of Newton's method that are hard for different reasons, from small runs of this program. `NAME.mtx` is the matrix (Matrix
Market, symmetric, lower triangle, every double exact); `NAME.json` beside it has the right-hand side, the blocks (the degrees of freedom of a vertex),
the vertex coordinates, where the system comes from, the condition numbers that the run estimated, and the cause. `scipy.io.mmread` reads
the matrices.

```sh
./bench data matrices results/matrices/*.mtx --json replay.json   # every solver, preconditioner and estimator, with times
./bench study matrix-corpus                                      # makes all of this folder again, this page included
./bench study matrix-corpus --table                              # this page alone, from the files that are here
```

A dump of a run of your own: `--set /passes/diagnose=true --set /output/matrices=true`, then `./bench data matrices results/runs/NAME/matrices/*.mtx`. A matrix
without a side-car will do: blocks of 3 if that divides its rows, and b = A * ones.
"""


def read_corpus(path: Path) -> dict:
    """Errors: UserError, also for two systems of one name."""
    spec = read_spec(path, "matrix_corpus")
    names = [system["name"] for system in spec["systems"]]
    if len(set(names)) != len(names):
        raise UserError(f"{path}#/systems: a name twice in {', '.join(sorted(names))}")
    return spec


def run(system: dict, common: dict, folder: Path, out: Path) -> None:
    """The run of a system into `out`; its outcome may be any."""
    config = folder / system["base"] if "base" in system else out.parent / f"{system['name']}.json"
    if "config" in system:
        config.write_text(json.dumps(system["config"]))
    words = ["run", str(config), "--out", str(out), "--progress", "none"]
    for pointer, value in {**common, **system.get("set", {})}.items():
        words += ["--set", f"{pointer}={json.dumps(value)}"]
    done = started(*words)
    if done.returncode != 0:
        raise UserError(f"{system['name']}: {done.stderr.strip()}", passed_on(done.returncode))


def unscaled_cond(side_car: dict) -> float:
    """1e14 where there is none: singular or not positive definite."""
    return next(
        (
            1e14 if c["cond"] is None else c["cond"]
            for c in side_car.get("cond", [])
            if c["scaling"] == "none"
        ),
        -math.inf,
    )


def pick(system: dict, matrices: Path) -> Path:
    """The side-car of the iteration that the corpus keeps."""
    exact = system["form"] == "exact"
    found = [path for path in sorted(matrices.glob("*.json")) if path.stem.endswith("_exact") == exact]
    if system["pick"] == "with_exact":
        found = [path for path in found if path.with_name(f"{path.stem}_exact.json").is_file()]
    if not found:
        raise UserError(f"{system['name']}: no matrix of form {system['form']} in its run")
    if system["pick"] == "largest_cond":
        return max(found, key=lambda path: unscaled_cond(read_object(path)))
    return found[0]


def keep(system: dict, side_car: Path, out: Path) -> None:
    copy_whole(side_car.with_suffix(".mtx"), out / f"{system['name']}.mtx")
    kept = read_object(side_car)
    kept["matrix"]["file"] = f"{system['name']}.mtx"
    kept["cause"] = f"{system['cause']}: {system['why']}"
    order = [key for key in kept if key not in ("block_start", "block_vertex", "coordinates_m", "rhs")]
    order += [key for key in ("block_start", "block_vertex", "coordinates_m", "rhs") if key in kept]
    lines = [f"  {json.dumps(key)}: {json.dumps(kept[key], ensure_ascii=False)}" for key in order]
    write_whole(out / f"{system['name']}.json", "{\n" + ",\n".join(lines) + "\n}\n")


def make(spec_file: Path, out: Path) -> None:
    spec = read_corpus(spec_file)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        for system in spec["systems"]:
            folder = Path(scratch) / system["name"]
            run(system, spec["set"], spec_file.parent, folder)
            side_car = pick(system, folder / "matrices")
            keep(system, side_car, out)
            shutil.rmtree(folder)
            print(f"{system['name']}: {side_car.stem}", file=sys.stderr)
    for stale in out.iterdir():
        if stale.suffix in (".mtx", ".json") and stale.stem not in {
            system["name"] for system in spec["systems"]
        }:
            stale.unlink()


def replay(out: Path) -> list[dict]:
    """The matrices of `barrierbench matrix --json`, by name."""
    files = sorted(out.glob("*.mtx"))
    if not files:
        raise UserError(f"{out}: no matrices")
    with tempfile.TemporaryDirectory() as scratch:
        answer = Path(scratch) / "replay.json"
        done = started("matrix", *map(str, files), "--json", str(answer))
        if done.returncode != 0:
            raise UserError(done.stderr.strip(), passed_on(done.returncode))
        return read_object(answer)["matrices"]


def cond_text(estimate: dict) -> str:
    if estimate["cond"] is None:
        return estimate["status"].replace("_", " ")
    return ("" if estimate["status"] == "ok" else "> ") + f"{estimate['cond']:.2e}"


def solve_text(solve: dict) -> str:
    """Iterations, or what went wrong; the residual of a direct solver that is above 1e-8."""
    if solve["status"] != "ok":
        return solve["status"].replace("_", " ")
    if solve["solver"] != "pcg" and solve["residual"] > 1e-8:
        return f"residual {solve['residual']:.0e}"
    return str(solve["iterations"]) if solve["iterations"] else "ok"


def solver_name(solve: dict) -> str:
    """As the table names it: pcg by its preconditioner, a direct solver by itself, another one by both."""
    if solve["solver"] == "pcg":
        return solve["preconditioner"]
    return (
        solve["solver"]
        if solve["preconditioner"] == "none"
        else f"{solve['solver']} {solve['preconditioner']}"
    )


def table(matrices: list[dict]) -> str:
    rows = []
    for one in matrices:
        by_spectra = {e["scaling"]: cond_text(e) for e in one["estimates"] if e["tier"] == 2}
        solves = {solver_name(s): solve_text(s) for s in one["solves"]}
        cause, _, why = one["cause"].partition(": ")
        rows.append(
            [
                f"`{Path(one['file']).stem}`",
                f"**{cause}**: {why}",
                f"{one['rows']}",
                f"{one['entries']}",
                *(by_spectra[s] for s in ("none", "jacobi", "block_jacobi")),
                *(solves[s] for s in SOLVERS),
            ]
        )
    head = ["system", "cause", "rows", "entries", "cond", "Jacobi", "block Jacobi"]
    head += [f"pcg {s}" if s in PCG else s for s in SOLVERS]
    return "\n".join(table_lines(head, rows))


def write_readme(out: Path) -> None:
    matrices = replay(out)
    size = sum(path.stat().st_size for path in out.iterdir() if path.suffix in (".mtx", ".json"))
    if size > MOST_BYTES:
        raise UserError(f"{out}: {size} bytes; at most {MOST_BYTES} go into the repository")
    notes = (
        f"\n{len(matrices)} systems, {size / 2**20:.1f} MiB. cond: by spectra, unscaled and scaled; `>` is a"
        " lower bound. Solvers: PCG iterations to a residual of 1e-8, at most 10000, `ok` for none, or how"
        " the solve ended.\n"
    )
    write_whole(out / "README.md", f"{HEAD}{notes}\n{table(matrices)}\n")


@tells("study matrix-corpus")
def main(argv: list[str]) -> int:
    parser = parser_of("study matrix-corpus")
    parser.add_argument("--spec", type=Path, default=ROOT / "configs/matrices/corpus.json")
    parser.add_argument("--out", type=Path, default=ROOT / "results/matrices")
    parser.add_argument("--table", action="store_true", help="only README.md, from the files that are there")
    args = parser.parse_args(argv)
    if not args.table:
        make(args.spec, args.out)
    write_readme(args.out)
    return 0

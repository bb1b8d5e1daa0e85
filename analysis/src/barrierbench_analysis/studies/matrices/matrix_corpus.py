"""The corpus of hard systems: the verb `bench study matrix-corpus` makes results/matrices and its table from
configs/matrices/corpus.json.

Every system is that of one Newton iteration of a small run, written by /output/matrices; only its `cause` is
added here. The table replays all of them (`barrierbench matrix`); it has no times, so that it is the same on
every machine with the same libraries.
"""

import json
import math
import shutil
import sys
import tempfile
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec, require_names_once
from barrierbench_analysis.io.template import filled
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.io.whole_file import copy_whole, write_whole
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.program.start import finished, settings_words

MOST_BYTES = 8 << 20
DIRECT = ["cholmod", "lagged_cholesky"]
PCG = ["none", "jacobi", "block_jacobi", "ic0", "schwarz", "mas"]
RESIDENT = ["pcg_resident block_jacobi", "pcg_resident multilevel_schwarz"]
SOLVERS = DIRECT + PCG + RESIDENT
PAGE = ROOT / "configs" / "matrices" / "page.md"  # template of README.md


def read_corpus(path: Path) -> dict:
    """Errors: UserError, also for two systems of one name."""
    spec = read_spec(path, "matrix_corpus")
    require_names_once(path, "systems", [system["name"] for system in spec["systems"]])
    return spec


def run(system: dict, common: dict, folder: Path, out: Path) -> None:
    """The run of a system into `out`; its outcome may be any."""
    config = folder / system["base"] if "base" in system else out.parent / f"{system['name']}.json"
    if "config" in system:
        config.write_text(json.dumps(system["config"]))
    words = ["run", str(config), "--out", str(out), "--progress", "none"]
    settings = {**common, **system.get("set", {})}
    finished(*words, *settings_words(settings), what=f"{system['name']}: ")


def unscaled_cond(side_car: dict) -> float:
    """1e14 where there is none: singular or not positive definite."""
    found = [one["cond"] for one in side_car.get("cond", []) if one["scaling"] == "none"]
    return -math.inf if not found else 1e14 if found[0] is None else found[0]


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
    names = {system["name"] for system in spec["systems"]}
    for file in out.iterdir():
        if file.suffix in (".mtx", ".json") and file.stem not in names:
            file.unlink()


def replay(out: Path) -> list[dict]:
    """The matrices of `barrierbench matrix --json`, by name."""
    files = sorted(out.glob("*.mtx"))
    if not files:
        raise UserError(f"{out}: no matrices")
    with tempfile.TemporaryDirectory() as scratch:
        answer = Path(scratch) / "replay.json"
        finished("matrix", *map(str, files), "--json", str(answer))
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
    solver, preconditioner = solve["solver"], solve["preconditioner"]
    if solver == "pcg":
        return preconditioner
    return solver if preconditioner == "none" else f"{solver} {preconditioner}"


def table(matrices: list[dict]) -> str:
    rows = []
    for one in matrices:
        by_spectra = {e["scaling"]: cond_text(e) for e in one["estimates"] if e["tier"] == 2}
        solves = {solver_name(s): solve_text(s) for s in one["solves"]}
        cause, _, why = one["cause"].partition(": ")
        about = [f"`{Path(one['file']).stem}`", f"**{cause}**: {why}", f"{one['rows']}", f"{one['entries']}"]
        conds = [by_spectra[s] for s in ("none", "jacobi", "block_jacobi")]
        rows.append([*about, *conds, *(solves[s] for s in SOLVERS)])
    head = ["system", "cause", "rows", "entries", "cond", "Jacobi", "block Jacobi"]
    head += [f"pcg {s}" if s in PCG else s for s in SOLVERS]
    return "\n".join(table_lines(head, rows))


def write_readme(out: Path) -> None:
    matrices = replay(out)
    size = sum(path.stat().st_size for path in out.iterdir() if path.suffix in (".mtx", ".json"))
    if size > MOST_BYTES:
        raise UserError(f"{out}: {size} bytes; at most {MOST_BYTES} go into the repository")
    numbers = {"systems": len(matrices), "mebibytes": size / 2**20, "table": table(matrices)}
    write_whole(out / "README.md", filled(PAGE, numbers))


@reported("study matrix-corpus")
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

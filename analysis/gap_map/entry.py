"""Runs what is missing of a gap map: every shape in every scene, resolution and limit mode at targets from 0.5 to 0.001 d_hat, and what it took against
the gap that it reached. Writes results/gap_map.json (the numbers used), results/GAP_MAP.md (made of it), docs/gap_map.png and its company.

Exit codes: 0 written, 2 bad input, or nothing to write.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from ..matching.formulations import ROOT, MatchError
from ..matching.runs import inputs_sha256, run
from ..record_file import RecordError
from ..whole_file import write_whole
from . import figure, plan, report
from .rows import CANNOT, add_rho, cannot_reach, records_in, row
from .spec import LIMITS, Cell, GapMapError, Spec, cells, limit_settings, make_sweep, quick, read_spec
from .table import Map, read, write

DEFAULT = ROOT / "configs" / "gap_map" / "default.json"
RUNS = ROOT / "results" / "runs" / "gap_map"


def groups(spec: Spec, beyond: set[tuple[str, float]]) -> Iterator[tuple[str, list[Cell]]]:
    """Cells of one scene and resolution, without those that no run can reach."""
    for scene in spec.scenes:
        for resolution in scene.resolutions:
            yield f"{scene.label}-{resolution}", [c for c in cells(spec) if (c.scene, c.resolution) == (scene.label, resolution) and (c.shape, c.theta) not in beyond]


def folder_of(spec: Spec, runs: Path, wanted: list[Cell]) -> Path:
    """Of the records of a scene and resolution. Its name has a hash of everything that they have in common, so that a quick map's are part of the full one's,
    and records of another base config, mesh or setting are never taken for these."""
    first = wanted[0]
    scene = next(s for s in spec.scenes if s.label == first.scene)
    made = make_sweep(spec, [])
    common = json.dumps([json.loads(made.text)["set"], scene.settings, scene.resolutions[first.resolution]], sort_keys=True)
    digest = hashlib.sha256(f"{common} {inputs_sha256(made)}".encode()).hexdigest()
    return runs / f"{first.scene}-{first.resolution}-{digest[:8]}"


def run_missing(spec: Spec, beyond: set[tuple[str, float]], runs: Path, jobs: int) -> None:
    """One sweep a scene and resolution, so many at a time; what is there is skipped by its run id."""
    made = [(name, folder_of(spec, runs, wanted), make_sweep(spec, wanted)) for name, wanted in groups(spec, beyond)]

    def one(item) -> None:
        name, folder, of = item
        start = time.monotonic()
        run(of, folder)
        print(f"gap-map: {name}, {len(of.notes)} runs, {time.monotonic() - start:.0f} s", file=sys.stderr)

    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, made))


def _limit_of(limit: dict) -> tuple:
    """Whether a resolved config has a strain limit, its shape, argument, policy and scale; whether alone where it has none."""
    if not limit.get("enabled"):
        return (False,)
    policy = limit.get("stiffness_policy") or {}
    return True, limit.get("shape"), limit.get("argument"), policy.get("name"), policy.get("scale", 1.0)


def _limit_asked(spec: Spec, cell: Cell) -> tuple:
    """The same of what a cell asks for."""
    asked = limit_settings(cell.limit, *spec.shapes[cell.shape], cell.theta)
    return _limit_of({"enabled": cell.limit != "off", **{key.rpartition("/")[2]: value for key, value in asked.items()}})


def check_cell(spec: Spec, cell: Cell, record: dict, folder: Path) -> None:
    """Errors: GapMapError where a record's settings are not those of its cell."""
    config = record["config"]
    found = (config["formulation"]["shape"], config["formulation"]["argument"], record["matching"]["theta"], *_limit_of(config.get("strain_limit") or {}))
    asked = (*spec.shapes[cell.shape], cell.theta, *_limit_asked(spec, cell))
    size = next(s for s in spec.scenes if s.label == cell.scene).unknowns[cell.resolution]
    if record["scene"]["free_dofs"] != size:
        raise GapMapError(f"{spec.path}#/scenes/{cell.scene}/resolutions/{cell.resolution}/unknowns: found {size}; its runs have {record['scene']['free_dofs']}")
    if found != asked:
        raise GapMapError(f"{folder}/run.json: shape, argument, theta, limit {found}; {asked} is what {cell.label!r} asks for: remove this folder")


def collect(spec: Spec, beyond: set[tuple[str, float]], runs: Path) -> tuple[list[dict], list[dict]]:
    """Rows in the order of the spec, and the records. A cell without a record is named as not run."""
    found = records_in(folder_of(spec, runs, wanted) for _, wanted in groups(spec, beyond) if wanted)
    rows, records = [], []
    for cell in cells(spec):
        record, folder = found.get(f"gap_map_{spec.name}: {cell.label}", (None, None))
        if (cell.shape, cell.theta) in beyond:
            rows.append(row(cell, None, outcome=CANNOT))
            continue
        if record is not None:
            check_cell(spec, cell, record, folder)
            records.append(record)
        rows.append(row(cell, record, folder))
    return rows, records


def about(spec: Spec, command: str, records: list[dict]) -> dict:
    def words(values) -> str:
        return ", ".join(sorted(set(values)))

    sizes = [r["scene"]["free_dofs"] for r in records]
    return {"command": command, "spec_sha256": spec.sha256, "part": spec.part, "doc": spec.doc, "shapes": {k: list(v) for k, v in spec.shapes.items()}, "main": list(spec.main),
            "gaps": list(spec.gaps), "limits": list(spec.limits), "scenes": {s.label: {"obstacle": s.obstacle, "resolutions": list(s.resolutions)} for s in spec.scenes},
            "unknowns": [min(sizes), max(sizes)], "runs": len(records), "date": words(r["status"]["started_utc"][:10] for r in records),
            "machine": words(f"{r['machine']['cpu_model']}, {r['machine']['cores']} cores, 1 thread a run" for r in records), "build": words(r["ids"]["build_id"][:16] for r in records)}


def write_page(found: Map, results: Path, docs: Path, figures: Path) -> None:
    docs.mkdir(parents=True, exist_ok=True)
    for path in figure.draw_all(found, figures):
        if path.suffix in (".png", ".txt"):
            shutil.copyfile(path, docs / path.name)
    write_whole(results / "GAP_MAP.md", report.markdown(found))


def arguments(argv: list[str]) -> argparse.Namespace:
    modes = "\n".join(f"  {mode:8} {text}" for mode, text in LIMITS.items())
    parser = argparse.ArgumentParser(prog="bench gap-map", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog=f"limit modes:\n{modes}\nexamples: ./bench gap-map --quick\n          ./bench gap-map --plan")
    parser.add_argument("spec", nargs="?", type=Path, default=DEFAULT, help="a gap map as data (default: configs/gap_map/default.json)")
    parser.add_argument("--quick", action="store_true", help="the part of the spec under `quick`: minutes, where the whole takes hours")
    parser.add_argument("--plan", action="store_true", help="say what there is to run and how long it would take, by the seconds of runs that are there; run nothing")
    parser.add_argument("--no-run", action="store_true", help="run nothing: judge the records that are there, or the numbers in gap_map.json")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="sweeps at a time, each of one thread (default 1)")
    parser.add_argument("--runs", type=Path, default=RUNS, metavar="DIR", help="folder of the records (default: results/runs/gap_map)")
    parser.add_argument("--results", type=Path, metavar="DIR", help="folder of GAP_MAP.md, gap_map.json and figures (default: results/ and docs/)")
    args = parser.parse_args(argv)
    if args.jobs < 1:
        parser.error(f"--jobs: found {args.jobs}; a number from 1 on is needed")
    return args


def kept_map(path: Path, spec: Spec) -> Map:
    found = read(path)
    if (found.about["spec_sha256"], found.about["part"]) != (spec.sha256, spec.part):
        raise GapMapError(f"{path}: its numbers are of another {spec.path}, or of its {found.about['part']} part: ./bench gap-map{' --quick' if spec.part == 'quick' else ''}")
    return found


def show_plan(spec: Spec, runs: Path) -> int:
    beyond = cannot_reach(spec)
    rows, _ = collect(spec, beyond, runs)
    print("\n".join(plan.lines(plan.estimate([c for c in cells(spec) if (c.shape, c.theta) not in beyond], rows, {(s.label, r): n for s in spec.scenes for r, n in s.unknowns.items()}))))
    return 0


def main(argv: list[str]) -> int:
    args = arguments(argv)
    results = args.results or ROOT / "results"
    kept = results / "gap_map.json"
    try:
        whole = read_spec(args.spec)
        spec = quick(whole) if args.quick else whole
        if args.plan:
            return show_plan(spec, args.runs)
        beyond, records = None, []
        if not (args.no_run and kept.is_file() and not args.runs.is_dir()):
            beyond = cannot_reach(spec)
            if not args.no_run:
                run_missing(spec, beyond, args.runs, args.jobs)
            rows, records = collect(spec, beyond, args.runs)
        if records:
            add_rho(spec, rows)
            command = "./bench gap-map" + ("" if args.spec.resolve() == DEFAULT else f" {args.spec}") + (" --quick" if args.quick else "")
            found = Map(about(spec, command, records), rows)
            write(found, kept)
        else:
            found = kept_map(kept, spec)
        write_page(found, results, ROOT / "docs" if args.results is None else results, args.runs / "figures")
    except (GapMapError, MatchError, RecordError) as error:
        print(f"bench gap-map: {error}", file=sys.stderr)
        return 2
    print(results / "GAP_MAP.md")
    return 0

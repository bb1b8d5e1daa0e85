"""Runs what a spec asks for (records that are there are skipped by their run_id) and measures every run
against its reference.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.origin import origin, run_of, seconds_of_run
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import RecordError, read_record
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.start import built_program, check_ended, run_sweep
from barrierbench_analysis.studies.kit.runs import sweep
from barrierbench_analysis.tables.accuracy.errors import NotFinite
from barrierbench_analysis.tables.accuracy.reference import (
    CLOSED_FORMS,
    NoReference,
    Reference,
    measure,
    refined,
)
from barrierbench_analysis.tables.accuracy.state import Motion, read_motion
from barrierbench_analysis.tables.outcomes import OK, outcome_of

from .spec import REFERENCE_D_HAT, SOLVERS, Scene, Spec

RUNS = ROOT / "results" / "runs" / "work_precision"


NEEDED = "; --no-run makes the page of the numbers that are kept"


def sweep_name(spec: Spec, scene: Scene) -> str:
    return f"{spec.name}-{scene.name}"


def _sweep(spec: Spec, scene: Scene, runs: Path, *words: str) -> str:
    """Runs the sweep of a scene -> what the program answers. Errors: UserError with what it says."""
    folder = runs / sweep_name(spec, scene)
    built_program(NEEDED)
    done = run_sweep(runs / f"{folder.name}.sweep.json", folder, "--progress", "none", *words)
    check_ended(done, f"{spec.file}: scene {scene.name}: ")
    return done.stdout


def run_scene(spec: Spec, scene: Scene, runs: Path) -> None:
    """The sweep file of a scene, and its runs."""
    folder = runs / sweep_name(spec, scene)
    file = runs / f"{folder.name}.sweep.json"
    cases = spec.cases(scene)
    common = {"/threads": 1, "/passes": {"time": True, "diagnose": False, "audit": True}}
    write_whole(file, sweep(folder.name, scene.base, common, cases).text)
    start = time.monotonic()
    print(f"work-precision: {scene.name}: {len(cases)} runs", file=sys.stderr)
    _sweep(spec, scene, runs)
    print(f"work-precision: {scene.name}: {time.monotonic() - start:.0f} s", file=sys.stderr)


def _records(spec: Spec, scene: Scene, runs: Path) -> dict[str, Path]:
    """Label of a case -> its folder. Only folders that the sweep names now count: those of settings that the
    spec no longer has may lie beside them.
    """
    folder, found = runs / sweep_name(spec, scene), {}
    wanted = {f"{folder.name}: {case['label']}": case["label"] for case in spec.cases(scene)}
    for planned in _sweep(spec, scene, runs, "--dry-run").split("\n"):
        path = Path(planned) / "run.json"
        if not planned or not path.is_file():
            continue
        try:
            found[wanted[read_record(path)["labels"].get("note", "")]] = path.parent
        except (RecordError, KeyError):
            continue  # counted as missing
    if missing := [label for label in wanted.values() if label not in found]:
        raise UserError(
            f"{folder}: {len(missing)} of {len(wanted)} records missing, the first is {missing[0]!r}; ./bench"
            f" work-precision {spec.file} makes them"
        )
    return found


def _reference_motion(scene: Scene, label: str, folder: Path) -> Motion:
    motion = read_motion(folder)
    status = motion.record["status"]
    if outcome_of(motion.record) != OK:
        raise UserError(
            f"scene {scene.name}: reference run {label!r} ended {status['outcome']} {status['detail']}; a"
            " reference has to be ok and valid"
        )
    return motion


def references(scene: Scene, folders: dict[str, Path]) -> dict[float, Reference]:
    """Factor of the time step -> reference of its runs."""
    if "closed_form" in scene.reference:
        return dict.fromkeys(scene.dt_factors, CLOSED_FORMS[scene.reference["closed_form"]]())
    made = {}
    for factor in scene.dt_factors:
        labels = [scene.reference_case(name, factor)["label"] for name in scene.reference["refined"]]
        pair = [_reference_motion(scene, label, folders[label]) for label in labels]
        ids = ", ".join(run_of(motion.record) for motion in pair)
        made[factor] = refined(
            *pair,
            f"middle of {' and '.join(scene.reference['refined'])} with d_hat x{REFERENCE_D_HAT:g},"
            f" tolerance/1000, dt {pair[0].record['labels']['dt_s']:g} s (run_id {ids})",
        )
    return made


def _row(scene: Scene, key: tuple, folder: Path, reference: Reference) -> dict:
    formulation, variation, solver = key
    record = read_record(folder / "run.json")
    summary = record["summary"]
    row = {
        "formulation": formulation.label,
        "axis": variation.axis,
        "factor": variation.factor,
        "solver": solver,
        "outcome": outcome_of(record),
        "error": None,
        "seconds": summary["wall_s"],
        "newton": summary["newton_iterations"],
        "factorizations": summary["factorizations"],
        "products": summary["linear_iterations"],
        "run": run_of(record),
        "errors": {},
    }
    if row["outcome"] != "ok":
        return row
    try:
        row["errors"], skipped = measure(read_motion(folder), reference)
    except RecordError:
        raise  # it names its file
    except (NotFinite, NoReference, UserError) as error:
        raise UserError(f"scene {scene.name}: {folder}: {error}") from None
    if scene.error not in row["errors"]:
        raise UserError(
            f"scene {scene.name}: {folder}: {scene.error} does not apply: {skipped.get(scene.error)}; it has"
            f" {', '.join(row['errors'])}"
        )
    row["error"] = row["errors"][scene.error]
    return row


def collect(spec: Spec, scene: Scene, runs: Path) -> dict:
    """What is kept of a scene: reference, band, targets, one row a run."""
    folders = _records(spec, scene, runs)
    known = references(scene, folders)
    keys = [(f, v, s) for f in spec.formulations for v in scene.variations for s in SOLVERS]
    rows = [_row(scene, key, folders[scene.case(*key)["label"]], known[key[1].of("dt_s")]) for key in keys]
    records = [read_record(folder / "run.json") for folder in folders.values()]
    about = {
        "unknowns": records[0]["scene"]["free_dofs"],
        "seconds": round(sum(map(seconds_of_run, records)), 1),
        "runs": len(records),
        **origin(records),
    }
    first = known[1.0]
    return {
        "name": scene.name,
        "base": os.path.relpath(scene.base, ROOT),
        "error": scene.error,
        "targets": list(scene.targets),
        "anchor": scene.anchor,
        "duration_s": scene.duration_s,
        "references": (
            [{"dt_factor": k, "name": r.name, "band": r.band} for k, r in known.items()]
            if first.band
            else [{"dt_factor": 1.0, "name": first.name, "band": {}}]
        ),
        "about": about,
        "rows": rows,
    }

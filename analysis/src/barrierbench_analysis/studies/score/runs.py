"""Runs of a score, all through the one sweep runner: matched targets, jittered starts, hard cases."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from barrierbench_analysis.io.errors import BAD_INPUT, TRY_AGAIN
from barrierbench_analysis.io.record_file import read_record, read_trace
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.start import check_ended, evaluated, run_sweep
from barrierbench_analysis.studies.gap_map.rows import row
from barrierbench_analysis.studies.gap_map.spec import COMMON, Cell, Scene, Spec, cells
from barrierbench_analysis.studies.kit.runs import Sweep, sweep
from barrierbench_analysis.studies.stress.entry import Formulation, Test, read_test
from barrierbench_analysis.studies.stress.run import Row, run_case
from barrierbench_analysis.tables.outcomes import outcome_of

from .candidate import RIVALS, Candidate

LIMIT_S = 90  # of one run, on the clock
LEAST_ROWS = 2000
SEEDS = (1, 2, 3, 4, 5)
JITTER_M = 1e-4
JITTERED = "cloth"  # scene of the jittered starts, at theta 0.1
JITTER_THETA = 0.1
STRESS = {
    "M05": ("10 deg",),
    "M06": ("2 layers",),
    "M07": ("100 to 1",),
    "M09": ("d_hat",),
    "M10": ("load 0.99", "load 1.01"),
    "M13": ("dt=1e-09", "dt=10"),
    "S09": ("ratio=1000",),
    "S11": ("1 d_hat a step",),
    "S18": ("n=4", "n=8"),
}
GIVEN_KAPPA = "/formulation/stiffness_policy/kappa_N_per_m"
OF_STRESS = {"consistent": "cubic_dynamic_consistent"}  # what a rival is called there
PASSES = {"/passes": {"time": True, "diagnose": True, "audit": True}}


def methods(of: Candidate) -> dict[str, dict]:
    """label -> section `formulation`."""
    return {of.label: of.formulation, **RIVALS}


def _settings(scene: Scene, resolution: str, formulation: dict, theta: float) -> dict:
    kept = {**scene.settings, **scene.resolutions[resolution]}
    if "/formulation/d_hat_m" in kept:
        formulation = {**formulation, "d_hat_m": kept.pop("/formulation/d_hat_m")}
    return kept | {"/formulation": formulation, "/matching/theta": theta, "/strain_limit/enabled": False}


def matched_cells(spec: Spec, of: Candidate) -> list[Cell]:
    """Of every method, the candidate among them."""
    return cells(replace(spec, shapes=dict.fromkeys(methods(of), ("", ""))))


def matched(spec: Spec, of: Candidate) -> Sweep:
    """Every method at every target in every scene."""
    scenes = {scene.label: scene for scene in spec.scenes}
    formulations = methods(of)
    return sweep(
        "score",
        spec.base,
        COMMON | spec.common | PASSES,
        [
            {
                "label": cell.label,
                "set": _settings(scenes[cell.scene], cell.resolution, formulations[cell.shape], cell.theta),
            }
            for cell in matched_cells(spec, of)
        ],
    )


def jittered(spec: Spec, of: Candidate) -> Sweep:
    """Every method from starts that differ by JITTER_M."""
    scene = next(scene for scene in spec.scenes if scene.label == JITTERED)
    resolution = next(iter(scene.resolutions))
    common = (
        COMMON
        | spec.common
        | {"/passes": {"time": False, "diagnose": False, "audit": True}, "/seeds/jitter_m": JITTER_M}
    )
    wanted = [
        {"label": label, "set": _settings(scene, resolution, one, JITTER_THETA)}
        for label, one in methods(of).items()
    ]
    return sweep("score_starts", spec.base, common, wanted, list(SEEDS))


def run(made: Sweep, of: Candidate, out: Path, jobs: int) -> dict[str, tuple[dict, Path] | None]:
    """note -> record and folder, of every case; None where a run left no record. Errors: UserError with what
    the program says.
    """
    file = out / f"{made.name}.json"
    write_whole(file, made.text)
    words = ("--progress", "none", "--time-limit", str(LIMIT_S), "--jobs", str(jobs))
    done = run_sweep(file, out / made.name, *words, plugins=list(of.plugins))
    if done.returncode in (BAD_INPUT, TRY_AGAIN):
        check_ended(done, "")
    found: dict[str, tuple[dict, Path] | None] = dict.fromkeys(made.notes)
    for path in sorted((out / made.name).glob("*/run.json")):
        record = read_record(path)
        if record["labels"].get("note", "") in found:
            found[record["labels"]["note"]] = (record, path.parent)
    return found


def rows(spec: Spec, of: Candidate, records: dict[str, tuple[dict, Path] | None]) -> list[dict]:
    """A row of a gap map of every cell, with seconds per contact row beside it."""
    out = []
    for cell in matched_cells(spec, of):
        record, folder = records[f"score: {cell.label}"] or (None, None)
        one = row(cell, record, folder, outcome="no record")
        out.append(one | {"row_ns": None if record is None else row_ns(record, folder)})
    return out


def row_ns(record: dict, folder: Path) -> float | None:
    """Nanoseconds of one thread for a contact row: barrier, local gradient and Hessian, over all
    iterations. None below LEAST_ROWS rows, where the first touch of memory decides.
    """
    seconds = (record["summary"].get("time") or {}).get("contact_terms_s")
    contacts = sum(sum(line["contacts"].values()) for line in read_trace(record, folder))
    return 1e9 * seconds / contacts if seconds and contacts >= LEAST_ROWS else None


def starts(of: Candidate, records: dict[str, tuple[dict, Path] | None]) -> list[dict]:
    """label, how many of the jittered starts ended ok and valid, and what the others were."""
    out = []
    for label in methods(of):
        mine = [records[f"score_starts: {label} main={seed}"] for seed in SEEDS]
        ends = ["no record" if one is None else outcome_of(one[0]) for one in mine]
        newton = [one[0]["summary"]["newton_iterations"] for one in mine if one is not None]
        out.append(
            {
                "method": label,
                "ok": ends.count("ok"),
                "of": len(ends),
                "others": sorted({e for e in ends if e != "ok"}),
                "newton": newton,
            }
        )
    return out


def _of_test(test: Test, of: Candidate) -> list[Formulation]:
    """The rivals as the test has them, and the candidate with what the test gives the cubic."""
    by_label = {one.label: one for one in test.formulations}
    out = []
    for label in methods(of):
        there = by_label.get(OF_STRESS.get(label, label))
        if there is None:
            like = by_label["cubic"]
            more = {key: value for key, value in like.set.items() if key != "/formulation/name"}
            if GIVEN_KAPPA in more:
                more[GIVEN_KAPPA] *= _of_equal_capacity(of)
            there = Formulation(label, {"/formulation": of.formulation, **more}, like.by_case)
        out.append(replace(there, label=label))
    return out


def _of_equal_capacity(of: Candidate) -> float:
    """Factor on a stiffness of the cubic at which the candidate carries at most as much; 1 where it carries
    any load.
    """
    shape = of.formulation.get("shape")
    if shape is None:
        return 1.0
    query = {"kind": "shape", "argument": "gap", "d": 0, "d_hat": 1}
    mine, cubic = evaluated([{**query, "shape": shape}, {**query, "shape": "cubic"}], list(of.plugins))
    return cubic["db"] / mine["db"] if isinstance(mine["db"], float | int) and mine["db"] < 0 else 1.0


def hard_cases(of: Candidate, out: Path, jobs: int) -> list[dict]:
    """Outcome of every method in the hard cases. Errors: UserError."""
    wanted = []
    for name, labels in STRESS.items():
        test = read_test(name)
        for case in test.cases:
            if case.label in labels:
                wanted += [(test, formulation, case) for formulation in _of_test(test, of)]

    def one(of_one) -> Row:
        test, formulation, case = of_one
        return run_case(test, formulation, case, out / "stress", LIMIT_S, plugins=of.plugins)

    with ThreadPoolExecutor(jobs) as pool:
        found = list(pool.map(one, wanted))
    return [
        {
            "test": test.id,
            "title": test.data["title"],
            "case": case.label,
            "method": formulation.label,
            "outcome": row.outcome,
            "newton": row.newton,
            "detail": row.detail[:200],
        }
        for (test, formulation, case), row in zip(wanted, found, strict=True)
    ]

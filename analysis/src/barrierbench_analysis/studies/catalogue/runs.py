"""Runs of a scene under formulations and from jittered starts: one sweep a scene, whose finished records
are kept.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.start import check_ended, run_sweep
from barrierbench_analysis.studies.kit.runs import sweep

from .entry import MINI, Entry, write_config
from .formulations import cases

RUNS = ROOT / "results" / "runs" / "catalogue"
LAST_FRAME = 1_000_000  # /output/frames_every: the start and the last state alone
LIMIT_S = 600  # of one run
# Times of single steps are not asked for, so that one pass serves.
ONE_PASS = {"/passes": {"time": False, "diagnose": False, "audit": True}}


@dataclass(frozen=True)
class Done:
    """A finished run."""

    formulation: str
    seed: int | None
    folder: Path
    record: dict = field(hash=False)


def run_scene(
    entry: Entry, labels: list[str], folder: Path, seeds: list[int] | None = None, given: dict | None = None
) -> list[Done]:
    """The mini scene under every formulation, from its own start with a frame of its end, or from jittered
    starts. given: settings by pointer that every run has besides. Errors: UserError with what the program
    says.
    """
    base, file, out = folder / f"{entry.name}.json", folder / f"{entry.name}.sweep.json", folder / entry.name
    write_config(entry, base, MINI)
    start = {"/seeds/jitter_m": entry.data["jitter_m"]} if seeds else {"/output/frames_every": LAST_FRAME}
    write_whole(file, sweep(entry.name, base, ONE_PASS | start | (given or {}), cases(labels), seeds).text)
    said = ("--progress", "none", "--time-limit", str(LIMIT_S))
    done = run_sweep(file, out, *said)
    check_ended(done, f"{entry.path}: ")
    planned = run_sweep(file, out, *said, "--dry-run").stdout.splitlines()
    keys = [(label, seed) for label in labels for seed in seeds or [None]]
    records = [read_record(Path(place) / "run.json") for place in planned]
    return [
        Done(*key, Path(place), record) for key, place, record in zip(keys, planned, records, strict=True)
    ]

"""Runs the fraction of each scene as a sweep in shards; what is there is skipped by its run id."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from barrierbench_analysis.io.cases import read_cases
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.start import check_ended, run_sweep
from barrierbench_analysis.studies.kit.runs import sweep

from .design import drawn
from .factors import Factorial


def write_sweep(factorial: Factorial, scene: str, folder: Path) -> Path:
    """The sweep file of a scene: one axis, a case a combination, labelled by its levels. Its configs are
    those of the factorial, so their config_ids are too.
    """
    base, given = factorial.sweep_path.parent / factorial.sweep["base"], factorial.sweep
    cases = [
        {"label": " ".join(factorial.labels_of(one)), "set": factorial.settings_of(scene, one)}
        for one in drawn(factorial, scene)
    ]
    made = sweep(f"{given['name']}_{scene}", base, given["set"], cases, budget=given["budget"])
    file = folder / f"{scene}.json"
    write_whole(file, made.text)
    return file


def run_shard(factorial: Factorial, scene: str, shard: int, folder: Path) -> None:
    """One of the shards of a scene, from 1. Errors: UserError with what the program says."""
    file, shards = write_sweep(factorial, scene, folder), factorial.spec["shards"]
    done = run_sweep(file, folder / scene, "--shard", f"{shard}/{shards}", "--progress", "none")
    check_ended(done, f"{file}: shard {shard}/{shards}: ")
    print(f"ablation: {scene}, shard {shard} of {shards}", file=sys.stderr, flush=True)


def run_all(factorial: Factorial, shards: int, jobs: int, folder: Path) -> None:
    """The first shards of every scene, shard after shard, `jobs` processes at a time. Errors: as run_shard;
    what has not begun then is not begun.
    """
    todo = [(scene, shard) for shard in range(1, shards + 1) for scene in factorial.scenes.labels]
    with ThreadPoolExecutor(jobs) as pool:
        running = [pool.submit(run_shard, factorial, scene, shard, folder) for scene, shard in todo]
        try:
            for one in running:
                one.result()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def records_of(folder: Path) -> dict[str, dict]:
    """label -> record, of the cases that have one of their own config. Errors: UserError."""
    out = {}
    for case in read_cases(folder):
        if not case.record.is_file():
            continue
        record = read_record(case.record)
        if record["ids"]["config_id"] == case.config_id:
            out[case.label] = record
    return out

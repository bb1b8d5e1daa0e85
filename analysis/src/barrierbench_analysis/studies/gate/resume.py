"""Class I: a run that is killed after a checkpoint and resumed ends in the bits of the run that was left
alone.
"""

import time
from pathlib import Path

from barrierbench_analysis.io.cases import CHECKPOINT
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.start import begun, finished

from .cases import Case, run_case, words_of
from .finding import Finding, exact
from .records import Run, read_run

NEVER_EQUAL = ("wall_s", "unaccounted_s", "time")
LONGEST_S = 120.0


def _step(record: dict) -> dict:
    return {name: value for name, value in record.items() if not name.startswith(NEVER_EQUAL)}


def kill_after_checkpoint(words: list[str], out: Path) -> bool:
    """Starts a run and kills it (SIGKILL) as soon as its checkpoint is there; False when it was over before.
    Raises UserError.
    """
    process = begun(*words)
    start = time.monotonic()
    while process.poll() is None and not (out / CHECKPOINT[0]).exists():
        if time.monotonic() - start > LONGEST_S:
            process.kill()
            raise UserError(f"{out}: no checkpoint within {LONGEST_S:.0f} s")
        time.sleep(0.0005)
    alive = process.poll() is None
    process.kill()
    process.communicate()
    return alive


def judge_resume(case: Case, out: Path, whole: Run) -> Finding:
    """whole: the record of the same case with one thread and without checkpoints, which has to end in the
    same state. Every other number is compared with a run that writes the same checkpoints and is left alone.
    Raises UserError when the program cannot resume.
    """
    every_step = {"/output/checkpoint_every": 1}
    alone = run_case(case, out.with_name(out.name + "-not-killed"), 1, every_step)
    for name in ("run.json", CHECKPOINT[0]):
        (out / name).unlink(missing_ok=True)
    words = [*words_of(case, out, 1, every_step), "--progress", "none"]
    killed = kill_after_checkpoint(words, out)
    finished(*words, "--resume", what=f"{case.name}: --resume: ")
    resumed = read_run(out, allow_not_finite=True)
    from_step = resumed.section("status").get("resumed_from_step")
    steps, wanted = resumed.record["steps"], alone.record["steps"]
    same = len({run.section("summary").get("state_hash") for run in (resumed, alone, whole)}) == 1
    unlike = (
        sum(_step(a) != _step(b) for a, b in zip(steps, wanted)) + abs(len(steps) - len(wanted)) + (not same)
    )
    judged = len(steps) if killed and from_step is not None else 0
    note = (
        f"killed, resumed from step {from_step:.0f}"
        if judged
        else "the run was over before it could be killed"
    )
    return exact(case.name, "I", "resumed run", unlike, judged, note, "")

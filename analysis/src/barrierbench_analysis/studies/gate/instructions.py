"""Instructions that a case executes, counted by callgrind: a cost without a clock. It is comparable only on
one processor with one compiler, so elsewhere it is not judged, and a machine without valgrind counts none.
"""

import os
import re
import shutil
import tempfile
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program.start import started

from . import baseline
from .baseline import Baseline, Kept, keep
from .cases import Case, is_chosen, read_set, words_of
from .envelope import Envelope
from .finding import Finding, not_judged
from .judge import COST_EACH, drifted
from .metrics import COST, LOWER_BETTER, Metric
from .records import read_run

INSTRUCTIONS = Metric("instructions", "IV", "1", LOWER_BETTER, COST)
WITHOUT_TIMES = {"/passes/time": False}


def count(case: Case) -> tuple[float, dict] | None:
    """How many, and what made the program that ran them; None without valgrind. About 50 times as slow as the
    run itself.
    """
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        return None
    # The kernel is named beforehand: the program would start itself again to get it, which callgrind does
    # not follow. The hash of the program is kept between processes: with a cache of its own every count has
    # it.
    environment = {**os.environ, "OPENBLAS_CORETYPE": os.environ.get("OPENBLAS_CORETYPE", "Haswell")}
    with tempfile.TemporaryDirectory() as folder:
        environment["BARRIERBENCH_CACHE"] = str(Path(folder) / "cache")
        out = Path(folder) / "run"
        under = [valgrind, "--tool=callgrind", f"--callgrind-out-file={folder}/out"]
        done = started(*words_of(case, out, 1, WITHOUT_TIMES), under=under, env=environment)
        found = re.search(r"Collected : (\d+)", done.stderr)
        if done.returncode != 0 or found is None:
            raise UserError(
                f"{case.name}: callgrind ended with {done.returncode}: {done.stderr.strip()[-400:]}"
            )
        return float(found.group(1)), read_run(out).made_by


def instructions_of(case: Case) -> Kept | None:
    """For a baseline; None where the case asks for none or there is no valgrind."""
    counted = count(case) if case.instructions else None
    return (
        keep(INSTRUCTIONS, Envelope(counted[0], counted[0], COST_EACH * counted[0], 1)) if counted else None
    )


def _judged(case: Case, kept: Baseline) -> Finding:
    was = kept.metrics.get("instructions")
    if not was:
        return not_judged(case.name, "IV", "instructions", "the baseline has none")
    counted = count(case)
    if counted is None or kept.made_by != counted[1]:
        other = "the baseline is of another processor or compiler"
        return not_judged(case.name, "IV", "instructions", other if counted else "no valgrind")
    value, e = counted[0], was.envelope
    note = "" if value > e.upper else drifted(was, value, True)
    verdict = "FAIL" if value > e.upper else "drift" if note else "pass"
    return Finding(case.name, "IV", "instructions", verdict, value, e.value, None, e.upper, "1", note=note)


def judge_instructions(set_name: str, folder: Path, only: list[str]) -> list[Finding]:
    """A line for every case that asks for them."""
    cases = [case for case in read_set(set_name) if case.instructions and is_chosen(case.name, only)]
    return [_judged(case, baseline.read(folder / f"{case.name}.json", case.name)) for case in cases]

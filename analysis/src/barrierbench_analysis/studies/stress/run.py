"""Running a case: a sweep of one case, so that the program itself knows a record that is already there. A
hang, a crash, a refusal touch no other case.
"""

from __future__ import annotations

import json
import math
import re
import resource
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io.errors import TRY_AGAIN, UserError
from barrierbench_analysis.io.json_file import number_at
from barrierbench_analysis.io.origin import run_of
from barrierbench_analysis.io.record_file import RecordError, read_record
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.start import built_program, run_sweep, started
from barrierbench_analysis.studies.kit.runs import Sweep, sweep
from barrierbench_analysis.tables.outcomes import outcome_of

from .entry import ROOT, Case, Formulation, Test

LIMIT_S = 60.0  # of processor time, of one run, whatever other runs took or whether they had records already
CLOCK = 4  # times as much on the clock, so that a busy machine makes no timeouts
ALWAYS = {"/threads": 1, "/passes": {"time": True, "diagnose": False, "audit": True}}
# contacts are counted at step ends; a run that stopped earlier may have had them before its first one
TO_THE_END = ("ok", "not_valid", "unproven")
WAITS = "waits"  # in place of an outcome: the program has no such setting yet


@dataclass
class Row:
    """What is kept of a run. None where a run has no such number."""

    test: str
    case: str
    formulation: str
    outcome: str
    detail: str
    run: str = ""
    valid: bool = False
    seconds: float | None = None
    newton: int | None = None
    linear: float | None = None
    contacts: int | None = None
    gap_min_rel: float | None = None
    gap_min_iterates_rel: float | None = None
    gap_min_ulps: float | None = None
    gap_end_rel: float | None = None
    load_end_N: float | None = None
    max_stretch: float | None = None
    kinetic_end_J: float | None = None
    gravity_work_J: float | None = None  # from the end of the first step to that of the last
    state_hash: str = ""
    expected: tuple = ()
    reason: str = ""
    as_expected: bool = False
    defect: str = ""  # a known one of the program that explains it


METRICS = (
    "newton",
    "linear",
    "contacts",
    "gap_min_rel",
    "gap_min_ulps",
    "gap_end_rel",
    "load_end_N",
    "max_stretch",
    "kinetic_end_J",
    "gravity_work_J",
    "state_hash",
)


def program() -> Path:
    return built_program()


def config_schema() -> dict:
    """That of the program which will run, not of the tree."""
    done = started("help", "config", "--schema")
    if done.returncode != 0:
        raise UserError(f"{built_program()} help config --schema: {done.stderr.strip()}")
    return json.loads(done.stdout)


def known(need: dict, schema: dict) -> bool:
    """Whether the schema of configs allows the value at the pointer."""
    node = schema
    for key in need["pointer"].strip("/").split("/"):
        if "$ref" in node:
            node = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
        node = node.get("properties", {}).get(key)
        if node is None:
            return False
    allowed = node.get("enum") or ([node["const"]] if "const" in node else None)
    return allowed is None or need["value"] in allowed


def spec_of(test: Test, formulation: Formulation, case: Case, folder: Path) -> Sweep:
    """The sweep of this one case, which lies in `folder`."""
    settings = {
        **formulation.set,
        **ALWAYS,
        **test.data.get("set", {}),
        **case.set,
        **formulation.by_case.get(case.label, {}),
    }
    label = f"{formulation.label} {case.label}".replace("/", " per ")
    return sweep(f"stress {test.id}", test.write_base(folder), {}, [{"label": label, "set": settings}])


def _folder(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.=-]+", "_", text)


def _fall(steps: list[dict]) -> float | None:
    ends = [number_at(step, ["gravity_J"]) for step in (steps[:1] + steps[-1:])]
    return None if not ends or None in ends else ends[0] - ends[1]


def row_of(record: dict, test: str, case: str, formulation: str) -> Row:
    """The numbers of a record that the tables and relations read."""
    status, summary, steps = record["status"], record["summary"], record["steps"]
    last = steps[-1] if steps else {}
    return Row(
        test,
        case,
        formulation,
        outcome_of(record),
        status["detail"],
        run_of(record),
        status["valid"],
        seconds=number_at(summary, ["wall_s"]),
        newton=summary["newton_iterations"],
        linear=number_at(summary, ["linear_per_solve", "sum"]),
        contacts=int(number_at(summary, ["contacts", "max"]) or 0),
        gap_min_rel=number_at(summary, ["gap_min_rel", "min"]),
        gap_min_iterates_rel=number_at(summary, ["gap_min_iterates_rel"]),
        gap_min_ulps=number_at(summary, ["gap_min_ulps"]),
        gap_end_rel=number_at(last, ["gap_min_rel"]),
        load_end_N=number_at(last, ["contact_load_sum_N"]),
        max_stretch=number_at(summary, ["max_stretch"]),
        kinetic_end_J=number_at(last, ["kinetic_J"]),
        gravity_work_J=_fall(steps),
        state_hash=summary["state_hash"],
    )


def judge(row: Row, test: Test) -> Row:
    """Against what was expected; a contact test that met no contact judged nothing."""
    expected = test.expected(row.formulation, row.case)
    row.expected, row.reason = expected.outcomes, expected.reason
    row.as_expected = expected.holds(row.outcome)
    if row.as_expected and row.outcome in TO_THE_END and test.contacts and not row.contacts:
        row.as_expected, row.detail = False, "no contact was ever active: nothing was tested"
    if not row.as_expected:
        row.defect = test.defect(row.formulation, row.case, row.outcome)
    return row


def run_case(
    test: Test,
    formulation: Formulation,
    case: Case,
    folder: Path,
    limit_s: float,
    plugins: tuple[str, ...] = (),
) -> Row:
    """One run, or its record if it is there. Raises UserError when the test itself is wrong."""
    place = folder / test.id / _folder(formulation.label) / _folder(case.label)
    spec = place / "spec.json"
    write_whole(spec, spec_of(test, formulation, case, place).text)

    def blank(outcome, detail):
        return Row(test.id, case.label, formulation.label, outcome, detail)

    try:
        done = run_sweep(
            spec,
            place / "runs",
            "--progress",
            "none",
            plugins=list(plugins),
            timeout=CLOCK * limit_s,
            preexec_fn=lambda: _limit(limit_s),
        )
    except subprocess.TimeoutExpired:
        return blank("timeout", f"not over after {CLOCK * limit_s:.0f} s")
    if done.returncode == -signal.SIGXCPU:
        return blank("timeout", f"not over after {math.ceil(limit_s)} s of processor time")
    if done.returncode == 2:
        return blank("refused", _told(done.stderr))
    if done.returncode == TRY_AGAIN:  # of the machine, and no result
        raise UserError(f"{place}: {_told(done.stderr)}", TRY_AGAIN)
    if done.returncode != 0:
        return blank("crash", f"the program ended with {done.returncode}: {_told(done.stderr)}")
    try:
        return row_of(
            read_record(_record(spec, place / "runs", plugins)), test.id, case.label, formulation.label
        )
    except RecordError as error:
        return blank("crash", str(error))


def _record(spec: Path, folder: Path, plugins: tuple[str, ...] = ()) -> Path:
    """The record of this very config; those of earlier versions of the case may lie beside it."""
    made = sorted(folder.glob("*/run.json"))
    if len(made) == 1:
        return made[0]
    told = run_sweep(spec, folder, "--dry-run", plugins=list(plugins)).stdout.strip()
    return Path(told or folder) / "run.json"


def _told(text: str) -> str:
    """What the program says, without the place of the generated sweep."""
    lines = [
        re.sub(r"\S*spec\.json\S*( \[[^]]*\])? ?", "", line).strip()
        for line in text.splitlines()
        if line.strip()
    ]
    return "; ".join(lines).replace(f"{ROOT}/", "")[:400]


def _limit(seconds: float) -> None:
    """Of processor time of this process, which is about to become the program; SIGXCPU ends it, without a
    core file.
    """
    soft = math.ceil(seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (soft, soft + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run_test(
    test: Test,
    folder: Path,
    schema: dict,
    formulations: list[str] | None = None,
    cases: list[str] | None = None,
    say=lambda text: None,
    limit_s: float = LIMIT_S,
) -> list[Row]:
    """All formulations and cases. Each run has limit_s of processor time for itself, so that no verdict
    depends on what else was run.
    """
    rows = []
    for formulation in test.formulations:
        if formulations is not None and formulation.label not in formulations:
            continue
        for case in test.cases:
            if cases is not None and case.label not in cases:
                continue
            missing = [need for need in case.needs if not known(need, schema)]
            if missing:
                rows.append(
                    Row(
                        test.id,
                        case.label,
                        formulation.label,
                        WAITS,
                        f"waits for {missing[0]['pointer']} = {missing[0]['value']}",
                    )
                )
                continue
            row = judge(run_case(test, formulation, case, folder, limit_s), test)
            rows.append(row)
            if not row.as_expected and not row.defect:
                say(
                    f"{test.id} {formulation.label}, {case.label}: {row.outcome}, expected"
                    f" {' or '.join(row.expected)}: {row.detail[:160]}"
                )
    return rows

"""Records for a gate: read strictly, since what a gate overlooks counts as well."""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.input_file import below
from barrierbench_analysis.io.record_file import (
    TRACE,
    RecordError,
    leaves,
    own_trace,
    read_record,
    trace_lines,
)

NOT_FINITE = ("nan", "infinite", "minus_infinite")  # the words of Number in core/base/record/number.hpp
MAY_BE_INFINITE = ("error_estimate_m_status", "contraction_status")  # no bound where nothing shrinks


@dataclass
class Run:
    """A record with its trace. `torn` counts the lines of the trace that a crash cut off (0 or 1)."""

    path: Path
    record: dict
    trace: list[dict] = field(default_factory=list)
    torn: int = 0
    has_trace: bool = False

    def section(self, name: str) -> dict:
        """A section of the record; empty where another program's record has none."""
        value = self.record.get(name)
        return value if isinstance(value, dict) else {}

    @property
    def version(self) -> str:
        return self.record["schema"]["version"]

    @property
    def threads(self) -> int | None:
        return self.section("provenance").get("threads")

    @property
    def state_hash(self) -> str:
        return self.section("summary").get("state_hash") or ""

    @property
    def made_by(self) -> dict:
        """What decides the last bits of a run: two that agree in all of it must agree in every bit."""
        provenance, machine = self.section("provenance"), self.section("machine")
        return {
            "cpu_model": machine.get("cpu_model", ""),
            "compiler": provenance.get("compiler", ""),
            "flags": provenance.get("flags", ""),
            "blas_kernel": (provenance.get("blas") or {}).get("kernel", ""),
            "libraries": provenance.get("libraries", {}),
        }

    @property
    def made_by_same_build(self) -> tuple:
        return self.section("ids").get("build_id", ""), json.dumps(self.made_by, sort_keys=True)


def not_finite(value) -> list[str]:
    """Places of numbers that are none: written as NaN or Infinity, or absent with a `_status` that says
    so."""

    def is_none(place: str, found) -> bool:
        if isinstance(found, float):
            return not math.isfinite(found)
        allowed = found == "infinite" and place.endswith(MAY_BE_INFINITE)
        return place.endswith("_status") and found in NOT_FINITE and not allowed

    return [f"{place}: {found}" for place, found in leaves(value) if is_none(place, found)]


def read_run(path: str | Path, allow_not_finite: bool = False) -> Run:
    """The record in a folder, or a run.json. Raises RecordError with file and place: none there, not JSON,
    another schema, a number that is NaN or infinite (unless allowed: then the invariants say so).
    """
    path = Path(path)
    path = path / "run.json" if path.is_dir() else path
    if not path.is_file():
        raise RecordError(f"{path}: no such record; give a run.json or the folder that holds it")
    run = Run(path, read_record(path, foreign=True, allow_not_finite=allow_not_finite))
    trace = path.parent / TRACE
    if own_trace(run.record, path.parent):  # the invariants count its lines
        run.trace, run.torn = trace_lines(trace)
    run.has_trace = trace.is_file()
    for file, value in () if allow_not_finite else ((path, run.record), (trace, run.trace)):
        if bad := not_finite(value):
            more = f" (and {len(bad) - 1} more)" if len(bad) > 1 else ""
            rule = "a record holds finite numbers, or null and the word that says why"
            raise RecordError(f"{file}: {bad[0]}{more}; {rule}")
    return run


def find_runs(root: str | Path) -> dict[str, Path]:
    """Every run.json below a folder by its place in it, or the one file. Raises RecordError when there is
    none.
    """
    root = Path(root)
    if not root.exists():
        raise RecordError(f"{root}: no such file or folder")
    if root.is_file():
        return {"": root}
    found = {str(path.parent.relative_to(root)): path for path in below(root, "run.json")}
    if not found:
        raise RecordError(f"{root}: no run.json below this folder")
    return {"": found["."]} if list(found) == ["."] else found

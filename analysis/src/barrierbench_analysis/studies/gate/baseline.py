"""Baselines: results/baselines/CASE.json, written by `bench gate accept` alone."""

import argparse
import json
from dataclasses import dataclass, field, fields
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import OURS
from barrierbench_analysis.io.spec_file import checked
from barrierbench_analysis.io.whole_file import write_whole

from .drift import First, digest
from .envelope import Envelope
from .metrics import Metric

PRESENT = ".".join(map(str, OURS))  # version of the records of this program
NAME, VERSION = "barrierbench.baseline", "1.2.0"
# Parts of a file in their order; those that are not needed are left out where they are empty.
NEEDED = ("case", "kind", "reason", "calibrated_at", "made_by", "scene", "config")
BEFORE_METRICS = (*NEEDED, "unsteady", "drifts")
FOLDER = ROOT / "results" / "baselines"


@dataclass
class Kept:
    """What a baseline says about one metric."""

    gate_class: str
    unit: str
    direction: str
    envelope: Envelope
    xfail: str = ""  # the issue that waits for it
    scatter: float = 0.0  # of a cost: how far up its copies reach, without any tolerance
    first: First | None = None  # what it is held against besides; None: this baseline is the first

    def json(self) -> dict:
        e = self.envelope
        line = {"class": self.gate_class, "value": e.value, "lower": e.lower, "upper": e.upper}
        line |= {"unit": self.unit, "direction": self.direction, "n": e.n}
        first = self.first.json() if self.first else None
        more = {"sample": list(e.sample), "xfail": self.xfail, "scatter": self.scatter, "first": first}
        return line | {name: value for name, value in more.items() if value}


@dataclass
class Baseline:
    case: str = ""
    kind: str = ""  # run or matrix
    reason: str = ""
    calibrated_at: dict = field(default_factory=dict)
    metrics: dict[str, Kept] = field(default_factory=dict)
    config: dict = field(default_factory=dict)
    scene: dict = field(default_factory=dict)
    made_by: dict = field(default_factory=dict)
    unsteady: list[str] = field(default_factory=list)  # numbers that only some of the copies had: not judged
    drifts: list[dict] = field(
        default_factory=list
    )  # drifts that were accepted on purpose: when, why, and from what to what

    @property
    def record_version(self) -> str | None:
        """Schema version of the records that it was made of; None where it does not say, as before 1.2.0."""
        return self.calibrated_at.get("record_version")

    @property
    def version(self) -> str:
        """record_version, or that of this program."""
        return self.record_version or PRESENT

    def json(self) -> dict:
        found = {"schema": {"name": NAME, "version": VERSION}}
        found |= {
            name: getattr(self, name) for name in BEFORE_METRICS if getattr(self, name) or name in NEEDED
        }
        return found | {"metrics": {name: kept.json() for name, kept in sorted(self.metrics.items())}}


def keep(metric: Metric, envelope: Envelope) -> Kept:
    return Kept(metric.gate_class, metric.unit, metric.direction, envelope)


def write(baseline: Baseline, path: Path) -> None:
    write_whole(path, json.dumps(baseline.json(), indent=1) + "\n")


def _kept(path: Path, name: str, line: dict, made_by: str) -> Kept:
    value, lower, upper = (line[key] for key in ("value", "lower", "upper"))
    if not lower <= value <= upper:
        raise UserError(f"{path}#/metrics/{name}: value {value} outside its own envelope [{lower}, {upper}]")
    first = line.get("first")
    if first is not None:
        words = {key: str(first.get(key, "")) for key in ("date", "commit", "reason", "made_by")}
        first = First(first["value"], **words, here=bool(made_by) and words["made_by"] == made_by)
    envelope = Envelope(value, lower, upper, line.get("n", 1), tuple(line.get("sample", ())))
    xfail, scatter = line.get("xfail", ""), float(line.get("scatter") or 0)
    return Kept(line["class"], line.get("unit", ""), line["direction"], envelope, xfail, scatter, first)


def how_to_accept(option: str, path: Path, *more: str) -> str:
    """The command that makes a baseline of what another program has written (--record or --matrix)."""
    return " ".join(["bench gate accept", option, "...", "--baseline", str(path), *more, '--reason "..."'])


def other_program_arguments(parser: argparse.ArgumentParser, record: dict, matrix: str) -> None:
    """What another program has written, and its baseline. record: how --record is read; matrix: the help of
    --matrix.
    """
    parser.add_argument("--record", type=Path, metavar="RUN.json", **record)
    parser.add_argument("--matrix", type=Path, nargs="+", metavar="FILE.mtx", help=matrix)
    parser.add_argument("--baseline", type=Path, metavar="FILE.json", help="of --record and --matrix")


def check_other_program(args: argparse.Namespace) -> None:
    """Errors: UserError for options that do not go together."""
    if bool(args.record or args.matrix) != bool(args.baseline) or (args.record and args.matrix):
        raise UserError("--record or --matrix goes with --baseline FILE.json")


def folder_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--baselines", type=Path, default=FOLDER, metavar="DIR", help="default: results/baselines"
    )


def _remedy(path: Path, case: str | None, kind: str | None) -> str:
    """A baseline of a case of ours is measured; one of files of another program is made of them."""
    if case is not None or kind is None:
        return '`bench gate calibrate` measures one and `bench gate accept --reason "..."` keeps it'
    return f"`{how_to_accept('--matrix' if kind == 'matrix' else '--record', path)}` makes one"


def _content(path: Path, case: str | None, kind: str | None) -> dict:
    """Raises UserError with the file: not there, no JSON, another schema, of another case or kind."""
    if not path.is_file():
        raise UserError(
            f"{path}: {'a folder' if path.is_dir() else 'no such baseline'}; {_remedy(path, case, kind)}"
        )
    data = {key: value for key, value in read_object(path).items() if value is not None}
    checked(data, path, "baseline")
    for key, wanted in (("case", case), ("kind", kind)):
        if wanted is not None and data.get(key) != wanted:
            raise UserError(f"{path}: a baseline of {key} {data.get(key)!r}, requested is {wanted!r}")
    return data


def read(path: str | Path, case: str | None = None, kind: str | None = None) -> Baseline:
    """Raises UserError with file and place: not there, empty, another version, of another case or kind, a NaN
    or infinite number.
    """
    path = Path(path)
    data = _content(path, case, kind)
    made_by = digest(data.get("made_by", {}))
    data["metrics"] = {name: _kept(path, name, line, made_by) for name, line in data["metrics"].items()}
    return Baseline(**{part.name: data[part.name] for part in fields(Baseline) if part.name in data})

"""Baselines: results/baselines/CASE.json, written by `bench gate accept` alone."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import is_number
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import checked
from barrierbench_analysis.io.whole_file import write_whole

from .drift import First, digest
from .envelope import Envelope
from .metrics import DIRECTIONS, Metric

NAME, MAJOR, VERSION = "barrierbench.baseline", "1", "1.2.0"
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
        line = {
            "class": self.gate_class,
            "value": e.value,
            "lower": e.lower,
            "upper": e.upper,
            "unit": self.unit,
            "direction": self.direction,
            "n": e.n,
        }
        return (
            line
            | ({"sample": list(e.sample)} if e.sample else {})
            | ({"xfail": self.xfail} if self.xfail else {})
            | ({"scatter": self.scatter} if self.scatter else {})
            | ({"first": self.first.json()} if self.first else {})
        )


@dataclass
class Baseline:
    case: str
    kind: str  # run or matrix
    reason: str
    calibrated_at: dict
    metrics: dict[str, Kept]
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

    def json(self) -> dict:
        return {
            "schema": {"name": NAME, "version": VERSION},
            "case": self.case,
            "kind": self.kind,
            "reason": self.reason,
            "calibrated_at": self.calibrated_at,
            "made_by": self.made_by,
            "scene": self.scene,
            "config": self.config,
            **({"unsteady": self.unsteady} if self.unsteady else {}),
            **({"drifts": self.drifts} if self.drifts else {}),
            "metrics": {name: kept.json() for name, kept in sorted(self.metrics.items())},
        }


def keep(metric: Metric, envelope: Envelope) -> Kept:
    return Kept(metric.gate_class, metric.unit, metric.direction, envelope)


def write(baseline: Baseline, path: Path) -> None:
    write_whole(path, json.dumps(baseline.json(), indent=1) + "\n")


def _first(place: str, line: dict, made_by: str) -> First | None:
    first = line.get("first")
    if first is None:
        return None
    if not isinstance(first, dict) or not is_number(first.get("value")):
        raise UserError(f"{place}/first: {first!r}; an object with a finite value is needed")
    words = {key: str(first.get(key, "")) for key in ("date", "commit", "reason", "made_by")}
    return First(first["value"], **words, here=bool(made_by) and words["made_by"] == made_by)


def _line(path: Path, name: str, line, made_by: str) -> Kept:
    place = f"{path}: /metrics/{name}"
    if not isinstance(line, dict):
        raise UserError(f"{place}: no object")
    for key in ("value", "lower", "upper"):
        if not is_number(line.get(key)):
            raise UserError(f"{place}/{key}: {line.get(key)!r}; a finite number is needed")
    if not line["lower"] <= line["value"] <= line["upper"]:
        raise UserError(
            f"{place}: value {line['value']} outside its own envelope [{line['lower']}, {line['upper']}]"
        )
    if line.get("class") not in ("III", "IV", "V"):
        raise UserError(
            f"{place}/class: {line.get('class')!r}; III, IV or V (classes I and II are exact and have no"
            " baseline)"
        )
    if line.get("direction") not in DIRECTIONS:
        raise UserError(f"{place}/direction: {line.get('direction')!r}; one of {', '.join(DIRECTIONS)}")
    envelope = Envelope(
        line["value"], line["lower"], line["upper"], int(line.get("n", 1)), tuple(line.get("sample", ()))
    )
    return Kept(
        line["class"],
        line.get("unit", ""),
        line["direction"],
        envelope,
        line.get("xfail", ""),
        float(line.get("scatter") or 0),
        _first(place, line, made_by),
    )


def how_to_accept(option: str, path: Path, *more: str) -> str:
    """The command that makes a baseline of what another program has written (--record or --matrix)."""
    return " ".join(["bench gate accept", option, "...", "--baseline", str(path), *more, '--reason "..."'])


def _remedy(path: Path, case: str | None, kind: str | None) -> str:
    """A baseline of a case of ours is measured; one of files of another program is made of them."""
    if case is not None or kind is None:
        return '`bench gate calibrate` measures one and `bench gate accept --reason "..."` keeps it'
    return f"`{how_to_accept('--matrix' if kind == 'matrix' else '--record', path)}` makes one"


def _content(path: Path, case: str | None, kind: str | None) -> dict:
    """Raises UserError with the file: not there, empty, another version, of another case or kind."""
    if not path.is_file():
        raise UserError(
            f"{path}: {'a folder' if path.is_dir() else 'no such baseline'}; {_remedy(path, case, kind)}"
        )
    text = input_file.read_text(path)
    if not text.strip():
        raise UserError(f"{path}: empty")
    try:
        data = json.loads(text)
    except ValueError as error:
        raise UserError(f"{path}: not JSON: {error}") from None
    schema = data.get("schema") if isinstance(data, dict) else None
    if (
        not isinstance(schema, dict)
        or schema.get("name") != NAME
        or str(schema.get("version", "")).split(".")[0] != MAJOR
    ):
        raise UserError(f"{path}: schema {schema}; this version reads {NAME} {MAJOR}.x.y")
    for key, wanted in (("case", case), ("kind", kind)):
        if wanted is not None and data.get(key) != wanted:
            raise UserError(f"{path}: a baseline of {key} {data.get(key)!r}, asked about {wanted!r}")
    return data


def read(path: str | Path, case: str | None = None, kind: str | None = None) -> Baseline:
    """Raises UserError with file and place: not there, empty, another version, of another case or kind, a NaN
    or infinite number.
    """
    path = Path(path)
    data = _content(path, case, kind)
    checked({key: value for key, value in data.items() if value is not None}, path, "baseline")
    metrics = data.get("metrics")
    if not isinstance(metrics, dict) or not metrics:
        raise UserError(f"{path}: /metrics is empty: it would judge nothing")
    made_by = data.get("made_by") or {}
    lines = {name: _line(path, name, line, digest(made_by)) for name, line in metrics.items()}
    return Baseline(
        data.get("case", ""),
        data.get("kind", ""),
        data.get("reason", ""),
        data.get("calibrated_at") or {},
        lines,
        data.get("config") or {},
        data.get("scene") or {},
        made_by,
        data.get("unsteady") or [],
        data.get("drifts") or [],
    )

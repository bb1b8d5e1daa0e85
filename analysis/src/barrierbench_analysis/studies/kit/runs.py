"""Sweep files that are made here, the program that runs them, and their records, read strictly."""

import hashlib
import json
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io import input_file, places
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.program.start import check_ended, run_sweep
from barrierbench_analysis.studies.gate.configs import differences

from . import formulations
from .metrics import FOLDER, METRICS

# What formulations may differ in; everything else of two configs has to be equal.
OF_A_FORMULATION = (
    "/formulation/name",
    "/formulation/shape",
    "/formulation/argument",
    "/formulation/stiffness_policy/",
    "/strain_limit/shape",
    "/strain_limit/argument",
    "/strain_limit/stiffness_policy/",
    "/matching/",
)


@dataclass(frozen=True)
class Sweep:
    """A sweep file: its text, and the labels of its cases in their order."""

    name: str
    text: str
    notes: tuple[str, ...]  # labels.note of the records

    @property
    def digest(self) -> str:
        return hashlib.sha256(self.text.encode()).hexdigest()


def sweep(
    name: str,
    base: Path,
    common: dict,
    cases: list[dict],
    seeds: list[int] | None = None,
    budget: dict | None = None,
) -> Sweep:
    """One axis of cases {label, set}, and one of seeds where they are given. budget: of the sweep file."""
    axes: list[dict] = [{"cases": cases}]
    notes = [f"{name}: {case['label']}" for case in cases]
    if seeds:
        axes.append({"pointer": "/seeds/main", "values": seeds})
        notes = [f"{note} main={seed}" for note in notes for seed in seeds]
    data = {
        "schema": "barrierbench.sweep/1",
        "name": name,
        "base": str(base.resolve()),
        "set": common,
        "axes": axes,
    } | ({"budget": budget} if budget is not None else {})
    return Sweep(name, json.dumps(data, indent=1) + "\n", tuple(notes))


def _last(key: str, above: str) -> str:
    """The last key of a way; of the name of a formulation `formulation`, since a name alone is a formulation
    too.
    """
    *before, last = [above, *key.strip("/").split("/")]
    return "formulation" if last == "name" and before[-1] == "formulation" else last


def _inputs(node, folder: Path, name: str = "") -> Iterator[bytes]:
    """Contents of the files that settings name: configs under configs, meshes, presets, methods. name: the
    last key of the way to the node.
    """
    if isinstance(node, dict):
        for key in sorted(node):
            of_axis = key == "values" and isinstance(node.get("pointer"), str)
            yield from _inputs(node[key], folder, _last(node["pointer"] if of_axis else key, name))
    elif isinstance(node, list):
        for one in node:
            yield from _inputs(one, folder, name)
    elif name == "formulation" and (file := formulations.PRESETS / f"{node}.json").is_file():
        yield input_file.read_bytes(file)
    elif name == "method" and isinstance(node, str) and (file := places.METHODS / f"{node}.json").is_file():
        yield input_file.read_bytes(file)
        yield from _inputs(read_object(file)["set"], folder)
    elif name in ("base", "extends", "file") and isinstance(node, str) and (folder / node).is_file():
        yield input_file.read_bytes(folder / node)
        if name != "file":
            yield from _inputs(read_object(folder / node), (folder / node).parent)


def inputs(node, folder: Path) -> bytes:
    """sha256 of every file that settings name, one behind the other; files of paths relative to `folder`."""
    return b"".join(hashlib.sha256(part).digest() for part in _inputs(node, folder))


def contents(plugins: Iterable[str]) -> bytes:
    """sha256 of every plugin, one behind the other; of one that is missing that of nothing: the program
    refuses it."""
    files = [Path(plugin) for plugin in plugins]
    return b"".join(
        hashlib.sha256(input_file.read_bytes(file) if file.is_file() else b"").digest() for file in files
    )


def inputs_sha256(made: Sweep, overrides: list[str] | None = None, plugins: list[str] | None = None) -> str:
    """Of the contents, not the places, of all files that the runs of a sweep are made from. A base that is
    missing adds nothing: the program refuses it.
    """
    data = json.loads(made.text)
    found = inputs(
        [data, dict(text.partition("=")[::2] for text in overrides or [])], Path(data["base"]).parent
    )
    return hashlib.sha256(found + contents(plugins or [])).hexdigest()


def run(
    made: Sweep,
    out: Path,
    overrides: list[str] | None = None,
    plugins: list[str] | None = None,
    jobs: int = 1,
    again: bool = False,
) -> None:
    """Runs what is missing of the sweep into `out`, which keeps a copy of the sweep file, so many runs at a
    time. again: runs also what has a record. Errors: UserError with the first line of what the program said;
    input that it refuses leaves nothing.
    """
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / f"{made.name}.json"
        file.write_text(made.text)
        words = ["--progress", "none", "--jobs", str(jobs), *(["--again"] if again else [])]
        for override in overrides or []:
            words += ["--set", override]
        done = run_sweep(file, out, *words, plugins=plugins or [])
    done.stderr = done.stderr.strip().removeprefix(f"{file} ")
    check_ended(done, "")


def records_in(folders: Iterable[Path], notes: Iterable[str] = ()) -> dict[str, tuple[dict, Path]]:
    """note -> record and its folder, of the notes alone where some are given. Errors: UserError for a file
    that is no record, and for two records of one note.
    """
    found: dict[str, tuple[dict, Path]] = {}
    for path in (path for folder in folders for path in sorted(folder.glob("*/run.json"))):
        record = read_record(path)
        note = record["labels"].get("note", "")
        if notes and note not in notes:
            continue
        if note in found:
            raise UserError(
                f"{path}: a second record of {note!r}, beside {found[note][1]}, with other settings; allowed:"
                " one record a case: remove one, or name another folder"
            )
        found[note] = (record, path.parent)
    return found


def collect(made: Sweep, out: Path) -> dict[str, dict]:
    """note -> record, of every case of the sweep, with its folder for metrics of the trace. Errors: UserError
    when one is missing or there twice.
    """
    found = records_in([out], made.notes)
    if missing := [note for note in made.notes if note not in found]:
        raise UserError(
            f"{out}: {len(missing)} of {len(made.notes)} records are missing, the first {missing[0]!r}"
        )
    return {note: {**record, FOLDER: str(folder)} for note, (record, folder) in found.items()}


def check_equal(records: dict[str, dict]) -> None:
    """Refuses records whose configs differ in more than a formulation."""
    notes = list(records)
    for note in notes[1:]:
        found = differences(records[notes[0]]["config"], records[note]["config"])
        if unlike := [line for line in found if not line.startswith(OF_A_FORMULATION)]:
            raise UserError(f"{notes[0]!r} and {note!r} are not runs of the same config: {unlike[0]}")


def check_varied(record: dict, vary: str, place: str) -> None:
    """Refuses to vary a strain limit that the run does not have: all formulations would be the same run."""
    if vary == "limit" and record["matching"].get("limit_load_N_per_m") is None:
        raise UserError(
            f"{place}: no strain limit acts in scene {record['labels']['scene']!r}, so that nothing varies;"
            " contact or both, or a limit: /strain_limit/limit"
        )


def metric(record: dict, name: str) -> float | None:
    """A number of metrics.py; None where the record has none."""
    if name not in METRICS:
        raise UserError(f"metric {name!r}: one of {', '.join(METRICS)}")
    return METRICS[name][3](record)

"""The cases of a gate: configs/gates/SET.json, and running one."""

import argparse
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec
from barrierbench_analysis.program.start import finished, settings_words

from .records import Run, read_run

FOLDER = ROOT / "configs" / "gates"


@dataclass(frozen=True)
class Case:
    name: str
    config: Path
    set: dict = field(default_factory=dict)  # JSON pointer -> value
    instructions: bool = False  # small enough for callgrind
    resumed: bool = False  # also killed after a checkpoint and resumed


def sets() -> list[str]:
    return sorted(path.stem for path in FOLDER.glob("*.json"))


def set_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--set", default="small", help="configs/gates/SET.json (default: small)")


def case_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--case",
        action="append",
        default=[],
        metavar="TEXT",
        help="only cases whose name contains it (repeatable)",
    )


def is_chosen(name: str, words: list[str]) -> bool:
    """Whether a name has one of the words of --case in it, or there is none."""
    return not words or any(word in name for word in words)


def read_set(name: str) -> list[Case]:
    """Every scene with every formulation of the set, then with those of its own, of which one with the same
    name takes the place of that of the set. Raises UserError with file and place.
    """
    path = FOLDER / f"{name}.json"
    if not path.is_file():
        raise UserError(f"set {name!r}: one of {', '.join(sets())} (configs/gates/)")
    data = read_spec(path, "gates")
    cases = [
        Case(
            f"{scene['name']}-{formulation['name']}",
            (path.parent / scene["config"]).resolve(),
            {**data.get("set", {}), **scene.get("set", {}), **formulation.get("set", {})},
            scene.get("instructions", False),
            scene.get("resumed", False),
        )
        for scene in data.get("scenes", [])
        for formulation in {
            f["name"]: f for f in [*data.get("formulations", []), *scene.get("formulations", [])]
        }.values()
    ]
    if not cases:
        raise UserError(f"{path}: no case: it needs scenes and formulations")
    return cases


def words_of(case: Case, out: Path, threads: int, more: dict) -> list[str]:
    """The words of the program for a run of a case."""
    settings = {**case.set, "/threads": threads, **more}
    # --replace: the folder is the gate's, whatever an earlier call left there.
    return ["run", str(case.config), "--out", str(out), "--replace", *settings_words(settings)]


def run_case(case: Case, out: Path, threads: int = 1, more: dict | None = None) -> Run:
    """Runs it, with more settings (pointer -> value), and reads its record. A failed run has a record too.
    Raises UserError when there is none.
    """
    # A record of an earlier call must not stand in for one that this program fails to write.
    (out / "run.json").unlink(missing_ok=True)
    finished(*words_of(case, out, threads, more or {}), what=f"{case.name}: ")
    return read_run(out, allow_not_finite=True)


def jittered(case: Case, out: Path, seed: int, size_m: float, threads: int = 1) -> Run:
    """A copy whose start coordinates are moved by up to 1e-12 times the size of the scene."""
    return run_case(case, out, threads, {"/seeds/main": seed, "/seeds/jitter_m": 1e-12 * size_m})

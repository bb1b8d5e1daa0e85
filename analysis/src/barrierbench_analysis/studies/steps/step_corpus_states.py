"""The states of results/steps from configs/steps/corpus.json: each from a run of its config by
`barrierbench steps --keep`; what it is hard for and its half are added here.
"""

import json
import sys
import tempfile
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.spec_file import read_spec, refused, require_base, require_names_once
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.start import finished, settings_words
from barrierbench_analysis.studies.catalogue.entry import read_entry, write_config

SCHEMA = "barrierbench.step_state/1"
HALVES = ("tune", "report")
MOST_BYTES = 12 << 20  # of all states together
MOST_OF_ONE = 800 << 10


def read_corpus(path: Path) -> dict:
    """Errors: UserError, also for two states of one name, and for one with two bases or none."""
    spec = read_spec(path, "step_corpus")
    require_names_once(path, "states", [state["name"] for state in spec["states"]])
    for k, state in enumerate(spec["states"]):
        if ("base" in state) == ("catalogue" in state):
            raise refused(
                path, f"states/{k}", state["name"], "either base (a config) or catalogue (a scene of it)"
            )
    return spec


def halves(names: list[str]) -> dict[str, str]:
    """The rule: in alphabetical order every other state is one to tune on, beginning with the first."""
    return {name: HALVES[k % 2] for k, name in enumerate(sorted(names))}


def _base(state: dict, k: int, spec_file: Path, scratch: Path) -> Path:
    if "base" in state:
        return require_base(state, spec_file, f"states/{k}/")
    file = scratch / f"{state['name']}.json"
    write_config(read_entry(state["catalogue"]), file)
    return file


def _keep(state: dict, base: Path, common: dict, stem: Path) -> None:
    words = ["steps", str(base), "--at", str(state["step"]), "--keep", str(stem), "--progress", "none"]
    settings = {**common, **state.get("set", {})}
    finished(*words, *settings_words(settings), what=f"{state['name']}: ")


def _name(file: Path, hard_for: str, half: str) -> None:
    """Adds what the program does not know of a state."""
    kept = read_object(file)
    first = {"schema": kept.pop("schema"), "hard_for": hard_for, "split": half}
    write_whole(file, json.dumps({**first, **kept}, indent=1) + "\n")


def chosen(spec: dict, path: Path, only: list[str]) -> list[tuple[int, dict]]:
    """The states of the names, with their places; all without one. Errors: UserError for an unknown name."""
    names = [state["name"] for state in spec["states"]]
    if unknown := [name for name in only if name not in names]:
        raise UserError(f"--only {unknown[0]}: none of {path}; it has {', '.join(sorted(names))}")
    return [(k, state) for k, state in enumerate(spec["states"]) if not only or state["name"] in only]


def _is_of_corpus(document: Path) -> bool:
    """Whether the corpus made the state: one of `barrierbench steps --keep` alone has no half."""
    kept = read_object(document)
    return kept.get("schema") == SCHEMA and kept.get("split") in HALVES


def drop_unlisted(out: Path, names: list[str]) -> None:
    """Removes what an earlier list of the corpus made, and names it."""
    for document in sorted(out.glob("*.json")):
        if document.stem in names or not _is_of_corpus(document):
            continue
        for file in (document.with_suffix(".state"), document):
            if file.exists():
                file.unlink()
                print(f"{file}: removed, since the list has no state of this name", file=sys.stderr)


def make(spec_file: Path, out: Path, only: list[str]) -> None:
    """Each is kept when it is made. Without `only` what an earlier list had goes. Errors: UserError, also
    for states that are too large for the repository.
    """
    spec = read_corpus(spec_file)
    names = [state["name"] for state in spec["states"]]
    half = halves(names)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        for k, state in chosen(spec, spec_file, only):
            stem = out / state["name"]
            _keep(state, _base(state, k, spec_file, Path(scratch)), spec["set"], stem)
            _name(stem.with_suffix(".json"), state["hard_for"], half[state["name"]])
            print(f"{state['name']}: step {state['step']}", file=sys.stderr)
    if not only:
        drop_unlisted(out, names)
    _require_small(out, names)


def _require_small(out: Path, names: list[str]) -> None:
    files = (out / f"{name}{ending}" for name in names for ending in (".json", ".state"))
    sizes = {file: file.stat().st_size for file in files if file.exists()}
    if large := [file for file, size in sizes.items() if size > MOST_OF_ONE]:
        raise UserError(f"{large[0]}: {sizes[large[0]]} bytes; allowed: {MOST_OF_ONE}, a smaller scene")
    if (total := sum(sizes.values())) > MOST_BYTES:
        raise UserError(f"{out}: {total} bytes; allowed: {MOST_BYTES}")

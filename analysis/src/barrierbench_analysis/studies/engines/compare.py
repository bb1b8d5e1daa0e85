"""./bench engine compare: the scenes of a spec under this program and under engines, each judged, in one
record.

A run that is there with the same scene, settings and requirements is taken as it is, so that a study that
was cut off goes on.
"""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.spec_file import read_spec, refused, require_base
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.start import built_program

from . import environment, launch, matching, ours
from .card import Card, read_card
from .judged import error_of, judge
from .launch import positions
from .matching import Material, Tests
from .ours import Config
from .scene import exported

RECORD = "barrierbench.engines_record/1"
OURS = "barrierbench"
NAME = "engines"  # of the files of a spec that has none
MOST_FACTOR = 20.0  # of a fit
_FITS = input_file.read_text(Path(matching.__file__))  # what a fit depends on beside its engine


@dataclass(frozen=True)
class Study:
    spec: dict
    folder: Path  # of its runs
    scenes: dict[str, Config]
    cards: dict[str, Card]
    say: Callable[[str], None]


def read_study(path: Path, folder: Path, only: list[str], say: Callable[[str], None]) -> Study:
    """only: names of scenes, empty for all. Errors: UserError with the place in the spec."""
    spec = read_spec(path, "engines")
    names = [one["name"] for one in spec["scenes"]]
    if unknown := [name for name in only if name not in names]:
        raise UserError(f"found scene {unknown[0]!r}; allowed: {', '.join(names)}")
    scenes = {
        one["name"]: Config(require_base(one, path, f"scenes/{k}/").resolve(), one["set"])
        for k, one in enumerate(spec["scenes"])
        if not only or one["name"] in only
    }
    cards = {}
    for k, one in enumerate(spec["engines"]):
        card = cards.setdefault(one["engine"], read_card(one["engine"]))
        if one["variant"] not in card.data["variants"]:
            allowed = ", ".join(card.data["variants"])
            raise refused(path, f"engines/{k}/variant", one["variant"], f"one of {allowed}")
        for j, level in enumerate(one["levels"]):
            if unknown := [name for name in level if name not in card.data["settings"]]:
                allowed = ", ".join(card.data["settings"])
                raise refused(path, f"engines/{k}/levels/{j}", unknown[0], f"one of {allowed}")
    return Study(spec, folder, scenes, cards, say)


def _key(*parts) -> str:
    return hashlib.sha256(json.dumps(parts, sort_keys=True, default=str).encode()).hexdigest()[:16]


def kept(folder: Path, key: str, make: Callable[[], dict]) -> dict:
    """What `make` answers, or what it answered before for the same key."""
    file = folder / "answer.json"
    if file.is_file() and (old := json.loads(input_file.read_text(file))).get("key") == key:
        return old["answer"]
    answer = make()
    if answer.get("outcome") not in ("not_installed", "not_fitted"):
        write_whole(file, json.dumps({"key": key, "answer": answer}, indent=1) + "\n")
    return answer


def _code(card: Card) -> str:
    """Of what an answer of an engine depends on beside the scene: adapter, what they share, requirements."""
    files = (card.adapter, card.folder.parent / "common.py", card.requirements, card.folder / "card.toml")
    return _key(*(input_file.read_text(file) for file in files))


def _ours(study: Study, name: str, scene: dict, parts: int, more: dict, label: str) -> dict:
    out = study.folder / name / label
    config = study.scenes[name]
    key = _key(scene, config.set, parts, more, built_program().stat().st_mtime_ns)

    def make() -> dict:
        study.say(f"{name}: {label}")
        done = ours.run(config, scene, out, parts, more, limit_s=20 * study.spec["limit_s"])
        return done | ({"judged": judge(out, scene)} if done["outcome"] == "ok" else {})

    return kept(out, key, make)


def believed(fit: dict) -> dict:
    """A fit whose factors are some of a stiffness. Errors: UserError where an engine goes far further or
    hardly at all: it is unstable, or another material altogether.
    """
    for name, value in fit["factors"].items():
        if not 1 / MOST_FACTOR < value < MOST_FACTOR:
            raise UserError(
                f"{name} {value:.3g} would be needed; believed: {1 / MOST_FACTOR:g} to {MOST_FACTOR:g}"
            )
    return fit


def fits(study: Study) -> dict[str, dict]:
    """Factors and what is left of each "engine variant", or why it has `failed`."""
    if "material" not in study.spec:
        as_mapped = {"outcome": "as_mapped", "failed": "nothing is fitted; cards say what is mapped"}
        return {f"{one['engine']} {one['variant']}": as_mapped for one in study.spec["engines"]}
    m = study.spec["material"]
    material = Material(m["youngs_N_per_m"], m["poisson"], m["density_kg_per_m2"], m["hinge_J"])
    folder, tests, out = study.folder / "material", None, {}
    for one in study.spec["engines"]:
        card = study.cards[one["engine"]]
        label = f"{card.name} {one['variant']}"
        if why := environment.why_not(card):
            out[label] = {"outcome": "not_installed", "failed": why}
            continue
        where = folder / label.replace(" ", "-")

        def make(card=card, one=one, where=where, label=label) -> dict:
            nonlocal tests
            study.say(f"material tests: {label}")
            tests = tests or Tests(material, folder)

            def simulate(scenes: dict[str, dict], factors: dict) -> dict[str, np.ndarray]:
                own = {**card.data.get("tests", {}), **factors}
                limit = len(scenes) * study.spec["limit_s"]
                return launch.run_all(card, scenes, where, one["variant"], own, limit)

            try:
                return {"outcome": "ok", **believed(tests.fit(simulate, card.data["fit"]))}
            except UserError as error:
                return {"outcome": "not_fitted", "failed": str(error)}

        out[label] = kept(where, _key(_code(card), _FITS, m, one["variant"]), make)
    return out


def _row(answer: dict, scene: dict, reference: np.ndarray | None) -> dict:
    """One line of the record."""
    row = {key: answer[key] for key in ("outcome", "detail", "log")}
    if run := answer["run"]:
        row |= {key: run[key] for key in ("version", "settings", "dt_s", "iterations_a_step", "notes")}
        row["seconds"] = run["stepping_s"]
    row |= answer.get("judged", {})
    if reference is not None and answer["outcome"] == "ok":
        row |= error_of(positions(Path(answer["out"])), reference, scene)
    return row


def _engine_rows(study: Study, name: str, scene: dict, fitted: dict, reference, left_out) -> list[dict]:
    rows = []
    for one in study.spec["engines"]:
        card, variant = study.cards[one["engine"]], one["variant"]
        label = f"{card.name} {variant}"
        factors = fitted[label].get("factors", {})
        for k, level in enumerate(one["levels"]):
            if (card.name, variant, k) in left_out:
                continue
            out = study.folder / name / f"{card.name}-{variant}-{k}"
            sets = {**factors, **level}

            def make(card=card, variant=variant, sets=sets, out=out, label=label, k=k) -> dict:
                study.say(f"{name}: {label}, level {k}")
                done = launch.run(card, scene, out, variant, sets, study.spec["limit_s"])
                judged = done["outcome"] in ("ok", "not_finite")
                return done | ({"judged": judge(out, scene)} if judged else {})

            answer = kept(out, _key(scene, _code(card), variant, factors, level), make)
            rows.append(
                {"engine": card.name, "variant": variant, "level": k, **_row(answer, scene, reference)}
            )
    return rows


def of_scene(
    study: Study, name: str, fitted: dict, left_out: set[tuple[str, str, int]] = frozenset()
) -> dict:
    """The rows of one scene, but for engine, variant and level that are left out; a run that fails is a row.
    Errors: UserError where the scene cannot be built.
    """
    config, asked = study.scenes[name], study.spec["reference"]
    scene = exported(config.file, config.sets())
    more = {"/integrator/name": asked["integrator"]}
    fine = _ours(study, name, scene, asked["parts"], more, "reference")
    coarser = _ours(study, name, scene, max(1, asked["parts"] // 2), more, "reference-coarser")
    reference = positions(Path(fine["out"])) if fine["outcome"] == "ok" else None
    rows = []
    for k, parts in enumerate(study.spec["ours"]["parts"]):
        answer = _ours(study, name, scene, parts, {}, f"{OURS}-{parts}")
        rows.append({"engine": OURS, "variant": "log", "level": k, **_row(answer, scene, reference)})
    return {
        "scene": name,
        "vertices": len(scene["positions_m"]),
        "triangles": len(scene["triangles"]),
        **({"segments": len(scene["segments"])} if "segments" in scene else {}),
        "frames": scene["steps"],
        "frame_s": scene["dt_s"],
        "reference": _row(fine, scene, None),
        "reference_apart": _row(coarser, scene, reference),
        "rows": [*rows, *_engine_rows(study, name, scene, fitted, reference, left_out)],
    }


def compared(study: Study) -> dict:
    """The whole record. Errors: UserError."""
    fitted = fits(study)
    return {
        "schema": RECORD,
        "spec": study.spec,
        "guarantees": {name: card.data["guarantee"] for name, card in study.cards.items()},
        "versions": {name: card.data["version"] for name, card in study.cards.items()},
        "material_left": fitted,
        "scenes": [of_scene(study, name, fitted) for name in study.scenes],
    }

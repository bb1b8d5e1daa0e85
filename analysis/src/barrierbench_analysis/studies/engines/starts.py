"""./bench engine compare --starts N: the scenes of a record once more, from N starts that are jittered.

Start k moves every coordinate of vertices that are not held by a uniform number in [-jitter, jitter] of
seed k, by the rule of /seeds of a config, so every engine and our reference begin at the same place.
Materials, own starts and seconds are those of the record: jittered runs may share the machine, so their
seconds are not kept.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.store import merged

from .compare import RECORD, Study, of_scene
from .judged import error_of
from .launch import positions
from .ours import Config
from .scene import exported

OF_ROW = (
    "engine", "variant", "level", "outcome", "detail", "verdict", "frames_crossing", "frames_in_obstacles",
    "crossings_most", "passages", "depth_obstacles_m", "depth_bodies_m", "error_mean", "error_last",
)  # fmt: skip


KEPT = ("starts", "references_apart")  # of a scene, beside its own runs


def without_starts(spec: dict) -> list[str]:
    """Names of the scenes that jittered starts leave out."""
    return [one["name"] for one in spec["scenes"] if not one.get("starts", True)]


def _short(row: dict) -> dict:
    return {key: row[key] for key in OF_ROW if row.get(key) not in (None, "")}


def own_starts(spec: dict) -> dict:
    """What runs of own starts depend on: a spec without what it says of jittered ones."""
    scenes = [{key: value for key, value in one.items() if key != "starts"} for one in spec.get("scenes", [])]
    return {key: value for key, value in spec.items() if key != "starts"} | {"scenes": scenes}


def with_kept_starts(record: dict, path: Path) -> dict:
    """The record of new runs with the jittered starts of the one at `path`, where both are of one spec."""
    kept = read_object(path) if path.is_file() else {}
    if kept.get("schema") != RECORD or "command_of_starts" not in kept:
        return record
    own, jittered = own_starts(kept["spec"]) == own_starts(record["spec"]), kept["spec"].get("starts")
    if not own or jittered != record["spec"].get("starts"):
        return record
    known = {one["scene"]: {key: one[key] for key in KEPT if key in one} for one in kept["scenes"]}
    scenes = [one | known.get(one["scene"], {}) for one in record["scenes"]]
    return record | {"scenes": scenes, "command_of_starts": kept["command_of_starts"]}


def earlier(path: Path, study: Study) -> dict:
    """The record whose scenes are run again. Errors: UserError where there is none, or of another spec."""
    again = "run ./bench engine compare without --starts first"
    if not path.is_file():
        raise UserError(f"{path} is not there: {again}")
    record = read_object(path)
    if record.get("schema") != RECORD or own_starts(record["spec"]) != own_starts(study.spec):
        raise UserError(f"{path} is of another spec: {again}")
    return record


def jittered(study: Study, start: int) -> Study:
    """The study at start 1, 2, ...: the same scenes, moved, with runs in a folder of their own."""
    seeds = {"/seeds/main": start, "/seeds/jitter_m": study.spec["starts"]["jitter_m"]}
    scenes = {name: Config(one.file, {**one.set, **seeds}) for name, one in study.scenes.items()}
    return replace(study, folder=study.folder / f"start-{start}", scenes=scenes)


def dear(study: Study, one: dict) -> set[tuple[str, str, int]]:
    """Engine, variant and level of runs that the spec does not want from every start: those that took long,
    and those that flew away, whose millions of passages the judge counts for minutes.
    """
    long = study.spec["starts"].get("few_above_s", np.inf)
    far = study.spec["starts"].get("few_above_error", np.inf)
    return {_who(r) for r in one["rows"] if r.get("seconds", 0) > long or r.get("error_mean", 0) > far}


def _references_apart(study: Study, name: str, n: int) -> list[float]:
    """How far the reference of start 2, 3, ... is from that of start 1, as errors are: the start's share."""
    folders = [jittered(study, k).folder / name / "reference" for k in range(1, n + 1)]
    if not (folders[0] / "frames.npz").is_file():
        return []
    states = [positions(folder) for folder in folders if (folder / "frames.npz").is_file()]
    scene = exported(study.scenes[name].file, study.scenes[name].sets())
    return [error_of(x, states[0], scene)["error_mean"] for x in states[1:]]


def _who(row: dict) -> tuple[str, str, int]:
    return row["engine"], row["variant"], row["level"]


def _others(one: dict, only: list[str]) -> set[tuple[str, str, int]]:
    """Lines of a scene that are not of the engines and variants asked for; none where none is asked for."""
    return {_who(row) for row in one["rows"] if only and f"{row['engine']}/{row['variant']}" not in only}


def _merged(one: dict, made: list[dict]) -> list[dict]:
    """The starts of a scene's record with what was made anew in its place, in the order of the scene's
    rows.
    """
    known = {start["start"]: start for start in one.get("starts", [])}
    order = [_who(row) for row in one["rows"]]
    out = []
    for start in made:
        before = known.get(start["start"], {}).get("rows", [])
        rows = merged(before, start["rows"], ("engine", "variant", "level"), replace=True)
        out.append(start | {"rows": sorted(rows, key=lambda row: order.index(_who(row)))})
    return out


def check_only(study: Study, only: list[str]) -> None:
    """Errors: UserError that names what the spec does not run."""
    there = [f"{one['engine']}/{one['variant']}" for one in study.spec["engines"]]
    for word in only:
        if word not in there:
            raise UserError(f"--only: found {word!r}; allowed: {', '.join(there)}")


def with_starts(study: Study, record: dict, n: int, only: list[str] = ()) -> dict:
    """The record with `starts` in each of its scenes. only: "ENGINE/VARIANT" of what is run, beside ours;
    what the record knows of all others stays. Cheap runs of all starts come first, start by start, so that
    a study that is cut off can be written with fewer. Errors: UserError.
    """
    if "starts" not in study.spec:
        raise UserError("--starts: the spec has no `starts` with a jitter_m")
    check_only(study, only)
    fitted, few = record["material_left"], study.spec["starts"].get("few", n)
    left = without_starts(study.spec)
    known = [one for one in record["scenes"] if one["scene"] in study.scenes]
    scenes = [one for one in known if one["scene"] not in left]
    if not scenes:
        found = ", ".join(study.scenes)
        raise UserError(f"--starts: found {found}; allowed: a scene whose `starts` is not false in the spec")
    out: dict[str, list[dict]] = {one["scene"]: [] for one in scenes}
    for last in (False, True):
        for k in range(1, n + 1):
            for one in scenes:
                left_out = _others(one, only) | (set() if last and k <= few else dear(study, one))
                made = of_scene(jittered(study, k), one["scene"], fitted, left_out)
                if last:
                    rows = [_short(row) for row in made["rows"]]
                    out[one["scene"]].append(
                        {"start": k, "reference": _short(made["reference"]), "rows": rows}
                    )

    def started(one: dict) -> dict:
        made = out[one["scene"]]
        apart = _references_apart(study, one["scene"], n)
        return {**one, "starts": _merged(one, made) if only else made, "references_apart": apart}

    scenes = [one if one["scene"] in left else started(one) for one in known]
    return {**record, "spec": study.spec, "scenes": scenes}

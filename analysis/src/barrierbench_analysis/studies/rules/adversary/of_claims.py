"""Statements of claims: the deciding parts that hold, of the claims with one of the verdicts that the spec
names. Their region is what the levels of their sweep span, in its scenes.
"""

import copy
import functools
import json
from pathlib import Path

from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.studies.claims import entry, judge, registry, table
from barrierbench_analysis.studies.claims.inputs import asked_once
from barrierbench_analysis.studies.claims.merged import base_path
from barrierbench_analysis.studies.claims.outcomes import asked
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.studies.claims.slices import rows_of
from barrierbench_analysis.studies.claims.table import Runs
from barrierbench_analysis.studies.claims.threshold import Threshold
from barrierbench_analysis.studies.claims.verdict import HOLDS
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.studies.kit.success import read_for

from .region import SEED, Point, Range, Region, Value
from .statement import Left, Statement

LEVEL = "level"  # the axis of the place between the levels of a sweep
IN = "."  # between sweep and scene in the label of a scene
NO_SETTING = ("schema", "name", "doc")


def between(a: object, b: object, t: float) -> object:
    """Between two settings: numbers that differ in proportion to t, of positive ones their logarithms, whole
    ones rounded; of what else differs that of the nearer one.
    """
    nearer = a if t < 0.5 else b
    if a == b:
        return copy.deepcopy(a)
    if isinstance(a, dict) and isinstance(b, dict):
        return {key: between(a[key], b[key], t) if key in a and key in b else nearer[key] for key in nearer}
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        return [between(x, y, t) for x, y in zip(a, b, strict=True)]
    if any(isinstance(x, bool) or not isinstance(x, (int, float)) for x in (a, b)):
        return copy.deepcopy(nearer)
    x = a * (b / a) ** t if a > 0 and b > 0 else a + t * (b - a)
    x = min(max(x, min(a, b)), max(a, b))
    return round(x) if isinstance(a, int) and isinstance(b, int) else x


@functools.cache
def _levels(text: str) -> dict[str, dict[str, dict[str, str]]]:
    """scene -> case -> level -> note of a run of the sweep of a part, in the slice that the part names. text:
    the part as JSON."""
    part = json.loads(text)
    sweep = entry.read_sweep(part["sweep"])
    places = [
        {"note": note, "scene": scene, "level": level, "case": case, **sweep.more[note]}
        for note, (scene, level, case, _) in sweep.cases.items()
    ]
    found: dict = {}
    for row in rows_of(part, Runs({}, places), sweep).rows:
        if row["scene"] in part.get("scenes", [row["scene"]]):
            of_case = found.setdefault(row["scene"], {}).setdefault(row["case"], {})
            of_case.setdefault(row["level"], row["note"])
    return found


def config_at(part: dict, scene: str, case: str, level: Value) -> dict:
    """The config of a case at a place between two neighbouring levels, in the order of the sweep file."""
    sweep = entry.read_sweep(part["sweep"])
    notes = list(_levels(json.dumps(part))[scene][case].values())
    low = min(int(level), len(notes) - 2) if len(notes) > 1 else 0
    ends = [asked_once(sweep)[note] for note in notes[low : low + 2]]
    return between(ends[0], ends[-1], level - low)


@functools.cache
def _base(sweep: str) -> Path:
    """The base config of a sweep."""
    path = entry.sweep_path(sweep)
    return base_path(read_object(path), path)


def _region(parts: list[dict]) -> Region:
    """Of the scenes of all sweeps over which the part holds."""
    scenes, of = {}, {}
    for part in parts:
        for scene, cases in _levels(json.dumps(part)).items():
            label = f"{part['sweep']}{IN}{scene}"
            most = len(next(iter(cases.values()))) - 1
            of[label] = part, scene
            scenes[label] = {LEVEL: Range(0.0, float(most)), "seed": SEED}

    def settings(point: Point, arm: str) -> tuple[Path, dict]:
        part, scene = of[point.scene]
        config = config_at(part, scene, arm, point.values[LEVEL])
        config["seeds"] = {**config.get("seeds", {}), "main": point.values["seed"]}
        return _base(part["sweep"]), {
            f"/{key}": value for key, value in config.items() if key not in NO_SETTING
        }

    return Region(scenes, settings)


def why_not(part: dict, metrics: dict[str, str]) -> str:
    """Why a part is not attacked; empty where it is. metrics: of the rows of the adversary."""
    if "proof" in part:
        return "a closed form decides it, and no run"
    if part["rule"] == "slope":
        return "a slope is of all levels of a scene, and no pair of runs has one"
    if part["rule"] not in ("ratio", "level", "outcomes"):
        return f"its rule `{part['rule']}` is read of no pair of runs"
    if lacking := sorted({*_read(part)} - metrics.keys()):
        return f"the spec names no metric {lacking[0]}"
    return ""


def _read(part: dict) -> list[str]:
    return [name for name in (part.get("metric"), *read_for(part.get("bad"))) if name]


def _statement(claim: entry.Claim, number: int, parts: list[dict], verdict: str) -> Statement:
    """parts: the same part over each sweep in which it holds."""
    part = parts[0]
    arms = tuple(dict.fromkeys(part[key] for key in ("case", "over") if key in part))
    if part["rule"] == "outcomes":
        side = None
        every = part.get("needs") != "more"
        threshold = f"{part['case']} {asked(part)}" + (
            f" where {part['over']} does" if "over" in part else ""
        )
    else:
        side = Threshold(part, part["rule"] == "ratio")
        every = bool(part.get("every"))
        threshold = f"{METRICS[part['metric']][0]}: {' / '.join(arms)} {side.text}"
    return Statement(
        label=f"{claim.id}-{number}",
        source=f"claim {claim.id}",
        says=part["says"],
        verdict=verdict,
        threshold=threshold,
        side=side,
        arms=arms,
        compares=part["rule"],
        metric=part.get("metric", ""),
        region=_region(parts),
        refuted_by=int(every),
        part=part,
        comparable=part["rule"] == "ratio" and part.get("counts", "comparable") == "comparable",
    )


def _holding(answer: judge.Answer, verdicts: list[str]) -> dict[int, list[tuple[dict, str]]]:
    """Number of a deciding part, from 1 -> the part over each of its sweeps over which it holds, and which
    verdict that is; of evaluations of the claim with one of `verdicts`.
    """
    found: dict[int, list] = {}
    for word, whole, parts, judged in (
        ("exploratory", answer.verdict, answer.claim.deciding, [j for j in answer.parts if not j.beside]),
        ("confirmed", answer.confirmed, registry.confirmed_parts(answer.claim), answer.confirmed_parts),
    ):
        if whole is None or whole.verdict not in verdicts:
            continue
        for number, (part, one) in enumerate(zip(parts, judged, strict=True), 1):
            if one.verdict == HOLDS:
                found.setdefault(number, []).append((part, word))
    return found


def of_claims(about: dict, metrics: dict[str, str]) -> tuple[list[Statement], list[Left]]:
    """From the kept numbers of all claims. metrics: of the rows of the adversary."""
    kept, found, left = table.read(table.FILE), [], []
    for name in entry.ids():
        claim = entry.read_claim(name)
        answer = judge.judge(claim, kept, Eval(None, kept.answers))
        for number, of in sorted(_holding(answer, about["verdicts"]).items()):
            parts = [part for part, _ in of]
            if why := why_not(parts[0], metrics):
                left.append(Left(f"claim {name}", parts[0]["says"], why))
            else:
                words = " and ".join(dict.fromkeys(word for _, word in of))
                found.append(_statement(claim, number, parts, f"holds ({words})"))
    return found, left

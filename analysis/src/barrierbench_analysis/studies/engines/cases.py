"""./bench engine cases: four small scenes that public trackers report faults of, under every engine.

Each has one measured number or two, and the range that physics allows. An engine that has no words for a
scene refuses it, and its card says why; one that is not installed is skipped, and the table says so.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from barrierbench_analysis.io.places import ROOT

from . import environment, launch, ours
from .card import Card, names, read_card
from .judged import judge
from .launch import positions
from .ours import Config
from .scene import exported

OURS = "barrierbench"
CONFIGS = ROOT / "configs/engines/cases"
LIMIT_S = 300.0
WITHIN, OUTSIDE, REFUSED, SKIPPED, FAILED = "within", "outside", "refused", "skipped", "failed"
CLEAN = "clean"  # verdict of the judge
LATE = 10  # frames at the end, over which a speed is measured


@dataclass(frozen=True)
class Bound:
    """A number of a run and what is allowed of it."""

    what: str
    unit: str
    least: float
    most: float
    measure: Callable[[np.ndarray, dict], float]  # [frames, n, 3] m, the scene


@dataclass(frozen=True)
class Case:
    name: str
    config: str  # of configs/engines/cases
    title: str
    source: str
    bounds: tuple[Bound, ...]
    clean: bool = False  # whether the judge has to find no crossing and no passage, too


def _way_off_mm(x: np.ndarray, scene: dict) -> float:
    """Of the vertex whose way is furthest from 2 mm."""
    way = 1e3 * (x[-1] - x[0])[:, 0]
    return float(way[np.argmax(np.abs(way - 2.0))])


def _way_mm(x: np.ndarray, scene: dict) -> float:
    return 1e3 * float((x[-1] - x[0])[:, 0].mean())


def _late_speed_mm_s(x: np.ndarray, scene: dict) -> float:
    """Along the plane, of the mean of all vertices over the last frames."""
    way = (x[-1] - x[-1 - LATE])[:, :2].mean(axis=0)
    return 1e3 * float(np.linalg.norm(way)) / (LATE * scene["dt_s"])


def _least_height_mm(x: np.ndarray, scene: dict) -> float:
    """The least of all frames: mean height of the upper sheet over the lowest vertex of the lower one, whose
    dent it may lie in. Whether it crosses or passes the other one locally is the judge's to say.
    """
    split = scene["bodies"][1]["first_vertex"]
    return 1e3 * float((x[:, split:, 2].mean(axis=1) - x[:, :split, 2].min(axis=1)).min())


# Way until a sheet with the speed v = 0.5 m/s stops by friction 1/2, v^2/(2 mu g); a method of first order in
# time goes up to v dt/2 farther, 5% with the 5 ms of this case.
STOP_MM = 1e3 * 0.5**2 / (2 * 0.5 * 9.81)
# Coulomb's law allows no creep. A law that is regularised below a speed creeps up to it; 1 mm/s is the
# default of this program.
SLOW = Bound("speed at the end", "mm/s", 0.0, 1.0, _late_speed_mm_s)
CASES = (
    Case(
        "E1",
        "slides",
        "a sheet that moves at 1 m/s goes 2 mm in 2 ms",
        "mujoco pull request 3420, review of 2026-09-11: 18 mm instead of 2 mm",
        (Bound("way of the vertex furthest off", "mm", 1.999, 2.001, _way_off_mm),),
    ),
    Case(
        "E2",
        "stops",
        "a sheet that slides with friction stops where Coulomb's law says",
        "newton issue 3492: boxes slide as on ice",
        (Bound("way", "mm", 0.95 * STOP_MM, 1.06 * STOP_MM, _way_mm), SLOW),
    ),
    Case(
        "E3",
        "holds",
        "a sheet that friction can hold creeps no faster than 1 mm/s, the speed below which friction is"
        " regularised in this program; Coulomb's law allows 0",
        "newton issue 3943, mujoco issue 3328: it creeps, since friction vanishes without slip",
        (SLOW,),
    ),
    Case(
        "E4",
        "order",
        "a sheet thrown at 10 m/s on one that is held at its rim stays above it",
        "newton issue 351: cloth goes through what it meets",
        (
            Bound(
                "least height of the upper over the deepest of the lower", "mm", 0.0, np.inf, _least_height_mm
            ),
        ),
        clean=True,
    ),
)


def _run(engine: str, variant: str, case: Case, out: Path) -> tuple[dict, dict]:
    """What the engine answered, and the scene."""
    config = Config(CONFIGS / f"{case.config}.json")
    scene = exported(config.file)
    if engine == OURS:
        return ours.run(config, scene, out, limit_s=LIMIT_S), scene
    return launch.run(read_card(engine), scene, out, variant, limit_s=LIMIT_S), scene


def row_of(engine: str, variant: str, case: Case, out: Path) -> dict:
    """One line: outcome and detail, the numbers, and the verdict of the judge."""
    done, scene = _run(engine, variant, case, out)
    row = {"case": case.name, "engine": engine, "variant": variant, "detail": done["detail"], "numbers": []}
    words = {"refused": REFUSED, "not_installed": SKIPPED}
    if done["outcome"] != "ok":
        return row | {"outcome": words.get(done["outcome"], FAILED), "verdict": ""}
    x = positions(Path(done["out"]))
    row["numbers"] = [bound.measure(x, scene) for bound in case.bounds]
    within = all(b.least <= value <= b.most for b, value in zip(case.bounds, row["numbers"]))
    verdict = judge(Path(done["out"]), scene)["verdict"]
    within &= not case.clean or verdict == CLEAN
    return row | {"outcome": WITHIN if within else OUTSIDE, "verdict": verdict}


def variants_of(engine: str) -> list[str]:
    return ["log"] if engine == OURS else list(read_card(engine).data["variants"])


def skipped(card: Card) -> list[dict]:
    """A line for each variant of an engine that is not installed."""
    row = {"case": "all", "engine": card.name, "numbers": [], "verdict": "", "outcome": SKIPPED}
    return [row | {"variant": v, "detail": environment.why_not(card)} for v in card.data["variants"]]


def rows_of(engines: list[str], folder: Path, say: Callable[[str], None]) -> list[dict]:
    """All cases under engines, ours or those with a card. Errors: UserError for an unknown engine."""
    rows = []
    for engine in engines:
        if engine != OURS and environment.why_not(card := read_card(engine)):
            rows += skipped(card)
            continue
        for variant in variants_of(engine):
            say(f"cases: {engine} {variant}")
            rows += [row_of(engine, variant, c, folder / f"{c.config}-{engine}-{variant}") for c in CASES]
    return rows


def all_engines() -> list[str]:
    return [OURS, *names()]


def is_well(row: dict) -> bool:
    """Nothing is wrong with it: what is refused or skipped was not run."""
    return row["outcome"] not in (OUTSIDE, FAILED)


def cells_of(row: dict) -> list[str]:
    """Of a table: engine, variant, case, numbers with what is allowed, outcome, verdict, detail."""
    case = next((c for c in CASES if c.name == row["case"]), None)
    numbers = [f"{value:.4g} {b.unit}" for b, value in zip(case.bounds if case else (), row["numbers"])]
    detail = "" if row["outcome"] in (WITHIN, OUTSIDE) else row["detail"]
    return [
        row["engine"],
        row["variant"],
        row["case"],
        "; ".join(numbers),
        row["outcome"],
        row["verdict"],
        detail,
    ]


def allowed_of(bound: Bound) -> str:
    least = f"{bound.least:.4g}"
    top = f"above {least}" if bound.most == np.inf else f"{least} to {bound.most:.4g}"
    return f"{bound.what}: {top} {bound.unit}"


HEADER = ["engine", "variant", "case", "measured", "outcome", "judge", "detail"]


def _coverage(rows: list[dict]) -> str:
    """By how many engines each case was run."""
    ran = {c.name: {r["engine"] for r in rows if r["case"] == c.name and r["numbers"]} for c in CASES}
    counts = [f"{name} by {', '.join(sorted(of)) or 'none'}" for name, of in ran.items()]
    return f"Engines that ran each case: {'; '.join(counts)}."


def page_of(rows: list[dict], command: str) -> str:
    """results/ENGINES_CASES.md."""
    lines = [
        "# Cases of public trackers",
        "",
        f"Made by `{command}`. Each case is a config of `configs/engines/cases`; `within`: all numbers are in"
        " their ranges; `refused`: the engine has no words for the scene, as its card says; `skipped`: it was"
        " not installed. What `./bench judge` says of the frames stands beside it; E4 needs the verdict"
        f" `{CLEAN}`, too. {_coverage(rows)}",
        "",
        "| case | what | allowed | after |",
        "|---|---|---|---|",
        *(f"| {c.name} | {c.title} | {'; '.join(map(allowed_of, c.bounds))} | {c.source} |" for c in CASES),
        "",
        f"| {' | '.join(HEADER)} |",
        f"|{'---|' * len(HEADER)}",
        *(f"| {' | '.join(cells_of(row))} |" for row in rows),
    ]
    return "\n".join(lines) + "\n"

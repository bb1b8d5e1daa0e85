"""A new barrier beside log, quadratic, cubic and a consistent stiffness: matched at equal gaps, started from
jittered states, and put through hard cases of the stress suite.
"""

from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.io.record_file import read_trace
from barrierbench_analysis.program.start import evaluated
from barrierbench_analysis.studies.kit.metrics import FOLDER
from barrierbench_analysis.studies.kit.study import collect
from barrierbench_analysis.studies.kit.study.spec import Case, Cell, Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules.gap_map.measured import conditions, reached
from barrierbench_analysis.studies.rules.stress.entry import Formulation, Test, read_test
from barrierbench_analysis.tables.outcomes import OK

from . import judge
from .candidate import RIVALS

AXES = ("part", "scene", "case", "method")
PARTS = MATCHED, START, HARD = "matched", "start", "hard"
LEAST_ROWS = 2000
GIVEN_KAPPA = "/formulation/stiffness_policy/kappa_N_per_m"
OF_STRESS = {"consistent": "cubic_dynamic_consistent"}  # what a rival is called there
MEASURED = {
    "gap": "load-weighted median of d/d_hat at converged step ends",
    "gap_p05": "its 5% quantile",
    "row_ns": "nanoseconds of one thread for a contact row",
    **dict.fromkeys(conditions([]), "over iterations in contact, of the trace"),
}


def methods(study: Study) -> dict[str, dict]:
    """label -> section `formulation`, the candidate first."""
    of = study.about["candidate"]
    return {of["label"]: of["formulation"], **RIVALS}


def cells(study: Study) -> Iterator[Case]:
    """Every method at every target in every scene, from every jittered start, and in every hard case."""
    about, starts = study.about, study.about["starts"]
    for scene in about["scenes"]:
        for method, formulation in methods(study).items():
            own = about["set"] | scene["set"] | {"/formulation": formulation}
            for gap in about["gaps"]:
                place = dict(zip(AXES, (MATCHED, scene["label"], f"{gap:g}", method)))
                yield Case(place, own | {"/matching/theta": gap})
            for seed in starts["seeds"] if scene["label"] == starts["scene"] else ():
                place = dict(zip(AXES, (START, scene["label"], f"{seed}", method)))
                yield Case(place, own | starts["set"] | {"/seeds/main": seed})
    for name, labels in about["hard"].items():
        test = read_test(name)
        base, more = test.base(study.base)
        for case in (case for case in test.cases if case.label in labels):
            for formulation in of_test(test, study):
                place = dict(zip(AXES, (HARD, name, case.label, formulation.label)))
                yield Case(place, more | test.settings(formulation, case), base)


def of_test(test: Test, study: Study) -> list[Formulation]:
    """The rivals as the test has them, and the candidate with what the test gives the cubic."""
    by_label = {one.label: one for one in test.formulations}
    out = []
    for label, formulation in methods(study).items():
        like = by_label.get(OF_STRESS.get(label, label), by_label["cubic"])
        found = dict(like.set)
        if like is by_label["cubic"] and label != "cubic":
            del found["/formulation/name"]
            if GIVEN_KAPPA in found:
                found[GIVEN_KAPPA] *= _of_equal_capacity(formulation, study.plugins)
            found = {"/formulation": formulation, **found}
        out.append(Formulation(label, found, like.by_case))
    return out


def _of_equal_capacity(formulation: dict, plugins: list[str]) -> float:
    """Factor on a stiffness of the cubic at which the candidate carries at most as much; 1 where it carries
    any load.
    """
    if "shape" not in formulation:
        return 1.0
    query = {"kind": "shape", "argument": "gap", "d": 0, "d_hat": 1}
    mine, cubic = evaluated([{**query, "shape": one} for one in (formulation["shape"], "cubic")], plugins)
    return cubic["db"] / mine["db"] if isinstance(mine["db"], float | int) and mine["db"] < 0 else 1.0


def run(study: Study, chosen: list[Cell], folder: Path, jobs: int) -> list[Row]:
    """Each run alone, since a new barrier may hang or crash."""
    return collect.run_each(study, chosen, folder, jobs, study.about["limit_s"])


def measure(_: Study, cell: Cell, record: dict) -> dict:
    if cell.place["part"] != MATCHED or not record["summary"]:
        return dict.fromkeys(MEASURED)
    lines = read_trace(record, Path(record[FOLDER]))
    gaps = {"gap": reached(record), "gap_p05": reached(record, 0.05)}
    return gaps | {"row_ns": row_ns(record, lines)} | conditions(lines)


def row_ns(record: dict, lines: list[dict]) -> float | None:
    """Nanoseconds of one thread for a contact row: barrier, local gradient and Hessian, over all
    iterations. None below LEAST_ROWS rows, where the first touch of memory decides.
    """
    seconds = (record["summary"].get("time") or {}).get("contact_terms_s")
    contacts = sum(sum(line["contacts"].values()) for line in lines)
    return 1e9 * seconds / contacts if seconds and contacts >= LEAST_ROWS else None


def _matched(row: Row) -> dict:
    """As a gap map has it."""
    no_contact = row.outcome == OK and row.values["gap"] is None
    return {
        **{"scene": row.place["scene"], "resolution": "-", "shape": row.place["method"], "limit": "off"},
        **{"theta": float(row.place["case"]), "outcome": "no contact" if no_contact else row.outcome},
        **{"run": row.run, "unknowns": row.unknowns, "seconds": row.seconds, **row.values},
    }


def _start(method: str, rows: list[Row]) -> dict:
    """How many of the jittered starts ended ok and valid, and what the others were."""
    ends = [row.outcome for row in rows]
    newton = [row.values["newton"] for row in rows if row.values["newton"] is not None]
    others = sorted(set(ends) - {OK})
    return {"method": method, "ok": ends.count(OK), "of": len(ends), "others": others, "newton": newton}


def _hard(row: Row) -> dict:
    return {
        **{"test": row.place["scene"], "title": read_test(row.place["scene"]).data["title"]},
        **{"case": row.place["case"], "method": row.place["method"], "outcome": row.outcome},
        **{"newton": row.values["newton"], "detail": (row.values["detail"] or "")[:200]},
    }


def rule(study: Study, rows: list[Row]) -> dict:
    """What score.json holds of the runs."""
    of = {part: [row for row in rows if row.place["part"] == part] for part in PARTS}
    label, *_ = names = list(methods(study))
    starts = [_start(name, [row for row in of[START] if row.place["method"] == name]) for name in names]
    matched, hard = list(map(_matched, of[MATCHED])), list(map(_hard, of[HARD]))
    equal = judge.at_equal_gap(matched, label)
    return {
        "decides": judge.decides(matched, starts, hard, label),
        "comparisons": [vars(one) | {"verdict": one.verdict} for one in judge.comparisons(matched, label)],
        "at_equal_gap": [vars(ratio) | {"metric": metric, "gap": gap} for metric, gap, ratio in equal],
        "row_ns": {method: ns for method, (ns, _) in judge.row_times(matched).items()},
        "rows": matched,
        "starts": starts,
        "hard_cases": hard,
    }

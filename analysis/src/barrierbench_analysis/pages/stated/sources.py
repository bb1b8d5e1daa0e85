"""Numbers of the log over another shape that the kept results have: of claims, gap map and ablation."""

import math
import re
from collections.abc import Iterator

from barrierbench_analysis.studies.claims import registry
from barrierbench_analysis.studies.claims.entry import Claim, ids, read_claim
from barrierbench_analysis.studies.claims.judge import judge_part, missing
from barrierbench_analysis.studies.claims.proofs import Eval
from barrierbench_analysis.studies.claims.sizes import span
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.claims.verdict import Judged
from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.rules.ablation.effects import main_effects
from barrierbench_analysis.studies.rules.ablation.factors import read_factorial
from barrierbench_analysis.studies.rules.gap_map.compare import METRICS, at_theta
from barrierbench_analysis.studies.rules.gap_map.spec import REFERENCE
from barrierbench_analysis.studies.rules.gap_map.table import Map

from .number import ALIKE, OFF, OWN, SAME, Number

# Metric of a part -> the name that it has here, and cases of sweeps -> the shape of contact and limit.
OF_CLAIMS = {"cond_p95": "cond_p95", "cond_bj_p95": "bj_p95", "pcg_probe": "pcg", "newton": "newton"}
SHAPES = ("cubic", "quadratic", "two_stage", "log_squared")
BOTH = {"cubic_both": "cubic"}
LIMITS = {"on": OWN, "contact": SAME, "off": OFF}
OF_ABLATION = {"bj_p95": "bj_p95", "pcg": "pcg", "newton": "newton"}
THETA = 0.1  # of the stiffnesses of the ablation


def measured_elsewhere(part: dict) -> bool:
    """Whether a part of a claim compares what gap map or ablation compare too: the log with another shape."""
    ratio = part.get("rule") == "ratio" and part["case"] == REFERENCE and part["metric"] in OF_CLAIMS
    return ratio and BOTH.get(part["over"], part["over"]) in SHAPES


def _of_part(claim: Claim, part: dict, judged: Judged, table: Table, confirmed: bool) -> Number:
    theta = re.search(r"theta ([\d.]+)", judged.slice)
    limit = re.search(r"limit (\w+)", judged.slice)
    own = part["over"] in BOTH
    few = judged.lower is None or judged.missing.startswith("indication")
    which = "" if part.get("counts") == "valid" else "comparable runs alone"
    scenes = part.get("scenes")
    places = "; ".join(filter(None, [which, f"scenes {', '.join(scenes)}" if scenes else ""]))
    return Number(
        metric=OF_CLAIMS[part["metric"]], case=part["case"], over=BOTH.get(part["over"], part["over"]),
        theta=float(theta[1]) if theta else None,
        limit=OWN if own else OFF if limit and limit[1] == "off" else SAME,
        study=claim.id, confirmed=confirmed, scenes=judged.scenes,
        unknowns=span(table.sweeps[part["sweep"]].about["unknowns"]),
        value=judged.value, lower=judged.lower, upper=judged.upper,
        decided=not few and not judged.lower <= 1 <= judged.upper, places=places, sweep=part["sweep"],
        alike=sum(1 / ALIKE < value < ALIKE for _, value, *_ in judged.per_scene),
    )  # fmt: skip


def confirmation(claim: Claim, table: Table) -> list[dict]:
    """Its parts over scenes that no rule was tuned on, where their registration stands: it is verified, or
    there is no git history to verify it by."""
    state = registry.state(claim, table, registry.read())
    return registry.confirmed_parts(claim) if state.verified or state.word == registry.UNVERIFIED else []


def of_claim(claim: Claim, table: Table) -> Iterator[Number]:
    """Of every part that sets the log over another shape and has a value; nothing where runs are missing."""
    if missing(claim, table):
        return
    asker, seen = Eval(None, table.answers, fresh=False), set()
    for confirmed, parts in ((False, claim.parts), (True, confirmation(claim, table))):
        for part in parts:
            if measured_elsewhere(part):
                judged = judge_part(part, table, asker)
                if judged.value is not None:
                    number = _of_part(claim, part, judged, table, confirmed)
                    if number not in seen:  # two parts may ask two questions of one number
                        seen.add(number)
                        yield number


def of_claims(table: Table) -> list[Number]:
    return [number for name in ids() for number in of_claim(read_claim(name), table)]


def of_map(found: Map, shape: str, limit: str, theta: float) -> list[Number]:
    """Of the two alone: every place in which both got through."""
    here = at_theta(found.rows, limit, theta, [shape])
    if shape not in here.ratios:
        return []
    sizes = [
        r["unknowns"]
        for r in found.rows
        if (r["scene"], r["resolution"]) in here.cut.places and r["unknowns"]
    ]
    numbers = []
    for metric in METRICS:
        ratio = here.ratios[shape][metric].turned()
        decided = ratio.lower is not None and not ratio.lower <= 1 <= ratio.upper
        what = (metric, REFERENCE, shape, theta, LIMITS[limit], "gap map", False)
        value = (ratio.value, ratio.lower, ratio.upper, decided, here.cut.words)
        numbers.append(Number(*what, ratio.scenes, (min(sizes), max(sizes)), *value))
    return numbers


def of_ablation(study: Study) -> list[Number]:
    """Main effects of the shapes, turned."""
    factorial, rows, numbers = read_factorial(study), page.rows_of(study), []
    sizes = [row.unknowns for row in rows]
    for metric, name in OF_ABLATION.items():
        for effect in main_effects(factorial, rows, metric):
            factor, level = effect.term.parts[0]
            labels = factorial.factors[factor].labels
            if labels[0] == REFERENCE and effect.low is not None:
                mean, low, high = (math.exp(-x) for x in (effect.mean, effect.high, effect.low))
                what = (name, REFERENCE, labels[level], THETA, OFF, "ablation", False, len(effect.scenes))
                value = (mean, low, high, effect.decided, "all other factors varied")
                numbers.append(Number(*what, (min(sizes), max(sizes)), *value))
    return numbers

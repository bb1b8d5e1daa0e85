"""The six questions, each with its outcome words, which were fixed before the first run.

A question is answered by runs of scenes at size M (S where it says so) and theta 0.01. An outcome needs its
interval over scenes as written here and a p below 0.05 after Holm's correction over all six questions;
otherwise it is `not decided`.
"""

import math
from dataclasses import dataclass, field, replace

from barrierbench_analysis.tables.estimate import sign_test, student
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import Mean, holm, mean_over

from .causes import CAUSES
from .loads import of_label
from .p_values import LEVEL, p_above, p_other, p_within, within
from .pairs import COARSE, CUBIC, FINE, LOG, Rows, Where, mean_ratio
from .stops import RULES

UNDECIDED = "not decided"
NO_RUNS = "not run"
SCENES = 5  # fewer with both runs give no outcome
VANISHES = math.log(0.9), math.log(1.25)
PERSISTS = math.log(2)
GROWS = math.log(1.05)
ALIKE = math.log(0.8), math.log(1.25)  # within 20%
WORK = {"products": "pcg", "flop": "diagnosed", "seconds": "pcg"}  # work -> the runs that it is read from
MASKS = ("friction", "dt24", "limit", "clamped")


@dataclass(frozen=True)
class Answer:
    """word: the outcome before Holm's correction. p: of the test that the word rests on. numbers: what the
    page shows, label -> number with its interval. scenes: that are in it.
    """

    number: int
    name: str
    word: str
    p: float
    numbers: dict[str, Mean | None]
    scenes: list[str] = field(default_factory=list)
    p_holm: float = 1.0

    @property
    def outcome(self) -> str:
        if self.word in (NO_RUNS, UNDECIDED):
            return self.word
        return self.word if self.p_holm < LEVEL else UNDECIDED


def _mean(values: dict[str, float]) -> Mean | None:
    return mean_over(list(values.values())) if values else None


def _word(values: dict[str, float], words: dict[str, bool]) -> str:
    """The first word that holds. Too few scenes decide nothing."""
    if not values:
        return NO_RUNS
    if len(values) < SCENES:
        return UNDECIDED
    return next((word for word, holds in words.items() if holds), UNDECIDED)


def conditioning(rows: Rows) -> Answer:
    """1: is the raw condition number of the log above the cubic's? Shells and rods; solids apart, since there
    d_hat is in proportion to the edges and the ratio does not depend on them."""
    every = rows.logs("cond_p95", Where())
    thin = {s: v for s, v in every.items() if s in rows.kind("shell", "rod")}
    solid = {s: v for s, v in every.items() if s in rows.kind("solid")}
    values = list(thin.values())
    persists = len(values) > 1 and float(student(values)[0]) > PERSISTS
    word = _word(thin, {"vanishes": within(values, *VANISHES), "persists": persists})
    p = min(1.0, 2 * min(p_within(values, *VANISHES), p_above(values, PERSISTS)))
    return Answer(
        1, "conditioning", word, p, {"raw": mean_ratio(thin), "raw, solids": mean_ratio(solid)}, sorted(thin)
    )


def newton(rows: Rows) -> Answer:
    """2: does the ratio of Newton iterations grow with size?"""
    rise = rows.rises("velocity_newton", Where(COARSE), Where(FINE))
    values = list(rise.values())
    above = len(values) > 1 and float(student(values)[0]) > 0
    mean = sum(values) / len(values) if values else 0.0
    numbers = {
        "M/S of log/cubic": mean_ratio(rise),
        "log/cubic at S": rows.ratio("velocity_newton", Where(COARSE)),
        "log/cubic at M": rows.ratio("velocity_newton", Where()),
    }
    word = _word(rise, {"grows": above and mean > GROWS})
    return Answer(2, "Newton", word, min(1.0, 2 * p_above(values, 0.0)), numbers, sorted(rise))


def _differences(rows: Rows, where: Where) -> dict[str, dict[str, float]]:
    """cause -> scene -> iterations of that cause, log less cubic, over all iterations of the cubic."""
    found: dict[str, dict[str, float]] = {name: {} for name in CAUSES}
    for scene, (log, cubic) in rows.pairs(where).items():
        of_all = sum(cubic.values[f"by_{name}"] or 0 for name in CAUSES)
        for name in CAUSES if of_all else ():
            found[name][scene] = (log.values[f"by_{name}"] - cubic.values[f"by_{name}"]) / of_all
    return found


def _slopes(rows: Rows, where: Where, name: str) -> dict[str, float]:
    """scene -> slope of the iterations of a cause on ln contacts, log less cubic."""
    found = {}
    for scene, (log, cubic) in rows.pairs(where).items():
        of = [row.values[f"slope_{name}"] for row in (log, cubic)]
        if None not in of:
            found[scene] = of[0] - of[1]
    return found


def cause(rows: Rows) -> Answer:
    """3: which iterations make the difference? The cause whose share of the cubic's iterations differs most,
    if its interval is without 0 and on the side of the whole difference."""
    of = _differences(rows, Where())
    numbers: dict[str, Mean | None] = {f"share {name}": _mean(values) for name, values in of.items()}
    numbers |= {f"slope {name}": _mean(_slopes(rows, Where(), name)) for name in CAUSES}
    limited = _differences(rows, Where(COARSE, setting="limit"))
    numbers |= {f"share {name}, limit": _mean(values) for name, values in limited.items()}
    scenes = sorted(of["contact"])
    if not scenes:
        return Answer(3, "cause", NO_RUNS, 1.0, numbers)
    total = {s: sum(values[s] for values in of.values()) for s in scenes}
    first = max(of, key=lambda name: abs(sum(of[name].values())))
    values = list(of[first].values())
    decided = p_other(values) < LEVEL and sum(values) * sum(total.values()) > 0
    numbers["share of all causes"] = _mean(total)
    p = min(1.0, len(CAUSES) * p_other(values))
    return Answer(3, "cause", _word(total, {first: decided}), p, numbers, scenes)


def work(rows: Rows) -> Answer:
    """4: is one of them cheaper? Products, operations of factors and seconds until each of three stop
    rules.
    """
    numbers, every = {}, {}
    for rule in RULES:
        for name, measure in WORK.items():
            logs = rows.logs(f"{rule}_{name}", Where(measure=measure))
            numbers[f"{name} to {rule}"], every[rule, name] = mean_ratio(logs), list(logs.values())
    whole = [values for values in every.values() if len(values) >= SCENES]
    scenes = sorted(rows.pairs(Where(measure="pcg")))
    if len(whole) < len(every):
        word = UNDECIDED if any(every.values()) else NO_RUNS
        return Answer(4, "work", word, 1.0, numbers, scenes)
    alike = all(within(values, *ALIKE) for values in whole)
    less = {LOG: [p_above([-v for v in values], 0.0) for values in whole]}
    less[CUBIC] = [p_above(values, 0.0) for values in whole]
    word = "equivalent" if alike else next((a for a, p in less.items() if max(p) < LEVEL / 2), UNDECIDED)
    ps = [p_within(values, *ALIKE) for values in whole] if alike else less.get(word, [1.0])
    return Answer(4, "work", word, min(1.0, 2 * max(ps)), numbers, scenes)


def robustness(rows: Rows) -> Answer:
    """5: which formulation ends ok under changed loads more often? Of each scene at XS, how many of ten
    changed loads end ok; a sign test over scenes of each formulation against the log, without a rule about
    gaps.
    """
    of: dict[tuple[str, str], list] = {}
    for row in rows.rows:
        if of_label(row.place["setting"]):
            of.setdefault((row.place["arm"], row.place["scene"]), []).append(row)
    arms = list(dict.fromkeys(arm for arm, _ in of))
    of = _alike_loads(of)
    share = {key: sum(r.outcome == OK for r in mine) / len(mine) for key, mine in of.items()}
    scenes = sorted({scene for arm, scene in of if arm == LOG})
    numbers, words = {}, {}
    for arm in arms:
        mine = {s: share[arm, s] for s in scenes if (arm, s) in share}
        numbers[f"{arm}: share that ends ok"] = _mean(mine)
        gaps = {s: _least_gap(of[arm, s]) for s in mine}
        numbers[f"{arm}: smallest gap"] = mean_ratio({s: math.log(g) for s, g in gaps.items() if g})
        if arm == LOG:
            continue
        more = sum(mine[s] > share[LOG, s] for s in mine)
        less = sum(mine[s] < share[LOG, s] for s in mine)
        words[f"{arm} {'more' if more > less else 'less'} often than log"] = sign_test(more, less)
    if not words:
        return Answer(5, "robustness", NO_RUNS, 1.0, numbers)
    held, p = _named(words if len(scenes) >= SCENES else {})
    return Answer(5, "robustness", held, p, numbers, scenes)


def _named(words: dict[str, float]) -> tuple[str, float]:
    """Of several tests in one question: the words whose p holds after Holm's correction over all questions,
    and the largest p of these times their number; the least one where none does. words: word -> p.
    """
    adjusted = {word: min(1.0, p * len(words)) for word, p in words.items()}
    held = [word for word, p in adjusted.items() if p * len(QUESTIONS) < LEVEL]
    chosen = [adjusted[word] for word in held] or [min(adjusted.values(), default=1.0)]
    return ", ".join(held) or UNDECIDED, max(chosen)


def _alike_loads(of: dict[tuple[str, str], list]) -> dict[tuple[str, str], list]:
    """The runs of those loads alone that every formulation of a scene has."""
    loads: dict[str, set[str]] = {}
    for (_, scene), mine in of.items():
        there = {row.place["setting"] for row in mine}
        loads[scene] = loads.get(scene, there) & there
    return {
        key: kept
        for key, mine in of.items()
        if (kept := [row for row in mine if row.place["setting"] in loads[key[1]]])
    }


def _least_gap(mine: list) -> float | None:
    gaps = [row.values["gap_min"] for row in mine if row.outcome == OK and row.values["gap_min"]]
    return min(gaps, default=None)


def masks(rows: Rows) -> Answer:
    """6: what hides the shape? Newton iterations log/cubic at S with a mask over the same without it."""
    numbers, ps, found = {}, {}, {}
    for mask in MASKS:
        with_mask = Where(COARSE, setting=mask)
        found[mask] = rows.rises("velocity_newton", Where(COARSE), with_mask)
        numbers[f"{mask}: Newton"] = mean_ratio(found[mask])
        numbers[f"{mask}: raw"] = mean_ratio(rows.rises("cond_p95", Where(COARSE), with_mask))
        ps[mask] = p_other(list(found[mask].values()))
    if not any(found.values()):
        return Answer(6, "masks", NO_RUNS, 1.0, numbers)
    held, p = _named({mask: p for mask, p in ps.items() if len(found[mask]) >= SCENES})
    return Answer(6, "masks", held, p, numbers, sorted(set().union(*found.values())))


QUESTIONS = (conditioning, newton, cause, work, robustness, masks)


def answers(rows: Rows) -> list[Answer]:
    """All six, with p after Holm's correction."""
    found = [question(rows) for question in QUESTIONS]
    return [replace(a, p_holm=p) for a, p in zip(found, holm([a.p for a in found]), strict=True)]

"""The numbers of the page: answers, laws, the table of formulations, what the runs took."""

from collections import defaultdict
from dataclasses import replace

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.numbers import written
from barrierbench_analysis.tables.outcomes import OK
from barrierbench_analysis.tables.statistics import Mean, Ratio
from barrierbench_analysis.tables.words import counted

from . import power
from .figure import PANELS, SIZES, THETAS
from .laws import Law, laws
from .loads import of_label
from .pairs import LOG, Rows, Where, mean_ratio
from .questions import SCENES, Answer, answers
from .stops import RULES as STOPS

SUBJECTS = {
    1: "Does the raw condition number differ?",
    2: "Does the difference in Newton iterations grow?",
    3: "Which iterations make the difference?",
    4: "Is one of them cheaper?",
    5: "Which one ends ok under changed loads?",
    6: "What hides the shape?",
}
LABELS = {
    "raw": "raw condition number, log/cubic",
    "raw, solids": "the same of solids",
    "M/S of log/cubic": "Newton iterations log/cubic, M over S",
    "log/cubic at S": "Newton iterations log/cubic at S",
    "log/cubic at M": "Newton iterations log/cubic at M",
    "share of all causes": "share of all causes",
    "products": "matrix products log/cubic",
    "flop": "operations of factors log/cubic",
    "seconds": "seconds log/cubic",
    "share": "share:",
    "slope": "slope:",
}


def _text(number: Mean) -> list[str]:
    return [str(number), str(number.scenes)]


def _answers(found: list[Answer]) -> list[str]:
    body = [
        [str(a.number), SUBJECTS[a.number], f"**{a.outcome}**", f"{a.p_holm:.2g}", str(len(a.scenes))]
        for a in found
    ]
    return markdown(["", "question", "outcome", "p (Holm)", "scenes"], body)


def _of_question(rows: Rows, answer: Answer) -> str:
    """Its numbers, as far as there are any, and the one of its sentence at smaller sizes."""
    body = [[_label(label), *_text(n)] for label, n in answer.numbers.items() if n is not None]
    begins, _, metric, measure = SENTENCES[answer.number]
    for size in SIZES[:2] if metric else ():
        if number := mean_ratio(_smaller(rows, metric, measure, size)):
            words = begins.removeprefix("The ratio log/cubic of ") + _kinds(metric)
            body.append([f"log/cubic of {words} at {size}", *_text(number)])
    return "\n".join(
        markdown(["number", "mean over scenes [95%]", "scenes"], body) if body else ["No pair of runs yet."]
    )


def _label(label: str) -> str:
    first, _, rest = label.partition(" ")
    return f"{LABELS[label]}" if label in LABELS else f"{LABELS.get(first, first)} {rest}".strip()


def _law(law: Law) -> str:
    lines = [f"### Law {law.number}: {law.name}", "", f"**{law.verdict}**: {law.why}.", ""]
    return "\n".join(
        lines + (markdown(list(law.head), law.places) if law.places else ["No run has a row yet."])
    )


def _arms(study: Study, rows: Rows, size: str) -> list[str]:
    """One row a formulation and target: how its runs end, and its numbers over those of the log at 0.1 in the
    scenes in which both end ok."""
    body = []
    for arm, of in study.about["arms"].items():
        for theta in ("0.1", "0.01") if of["matched"] else ("-",):
            where, timed = Where(size, theta), Where(size, theta, measure="pcg")
            mine = rows.of(arm, where) or rows.of(arm, timed)
            if not mine:
                continue
            ok = [row for row in mine.values() if row.outcome == OK]
            gaps = [g for row in ok if (g := row.values["gap_min"])]
            own = f"{min(gaps):.2g}" if gaps else "-"
            numbers = [
                rows.ratio(metric, mine_at, arm, LOG, replace(mine_at, theta="0.1"))
                for metric, mine_at in (
                    ("velocity_newton", where),
                    ("velocity_products", timed),
                    ("velocity_seconds", timed),
                )
            ]
            ratios = ["1" if n and (arm, theta) == (LOG, "0.1") else written(n) for n in numbers]
            words = [arm, theta, f"{len(ok)} of {len(mine)}", own, *ratios, of["when"]]
            body.append(words)
    head = ["formulation", "theta", "ends ok", "smallest gap / d_hat", "Newton", "products", "seconds"]
    return markdown([*head, "when to use"], body)


# Question -> what its sentence begins with, the number of an answer that it gives, the metric and the runs
# that stand for it at smaller sizes while its own runs are missing.
SENTENCES = {
    1: ("The ratio log/cubic of raw condition numbers", "raw", "cond_p95", "diagnosed"),
    2: (
        "The ratio log/cubic of Newton iterations",
        "log/cubic at M",
        "velocity_newton",
        "diagnosed",
    ),
    3: (
        "The share that the step bound of contact has in the difference of iterations",
        "share contact",
        "",
        "",
    ),
    4: ("The ratio log/cubic of seconds", "seconds to velocity", "velocity_seconds", "pcg"),
    5: (
        "The share of changed loads under which the cubic ends ok at size XS",
        "cubic: share that ends ok",
        "",
        "",
    ),
    6: ("The factor on that ratio of iterations where all Hessians are clamped", "clamped: Newton", "", ""),
}
COMMANDS = {
    1: "--part m --only measure=diagnosed",
    2: "--part m --only measure=diagnosed",
    3: "--part m --only measure=diagnosed",
    4: "--part m --only measure=pcg",
    5: "--part robustness",
    6: "--part masks",
}


def sentences(study: Study, rows: Rows, found: list[Answer]) -> list[str]:
    """One a question: its number, its outcome and its command; while fewer than five scenes have its runs,
    the same number at the largest smaller size that has five."""
    made = []
    for answer in found:
        begins, label, metric, measure = SENTENCES[answer.number]
        command = f"`{study.call('run')} {COMMANDS[answer.number]}`"
        seen = len(answer.scenes)
        number, at = None, ""
        if seen >= SCENES:
            number, at = answer.numbers.get(label), f"over {counted(seen, 'scene')}"
        elif metric:
            number, at = _at_smaller(rows, metric, measure)
        few = f"in {counted(seen, 'scene')}, fewer than {SCENES}" if 0 < seen < SCENES else "nowhere yet"
        text = f"{begins} is {number} {at}" if number is not None else f"{begins} was measured {few}"
        made.append(f"{answer.number}. {SUBJECTS[answer.number]} **{answer.outcome}**. {text} ({command}).")
    return made


OF_THIN = "cond_p95"  # the number that question 1 has of shells and rods alone


def _kinds(metric: str) -> str:
    return " of shells and rods" if metric == OF_THIN else ""


def _smaller(rows: Rows, metric: str, measure: str, size: str) -> dict[str, float]:
    """Logarithms of a ratio at theta 0.01, of the scenes that its question is about."""
    found = rows.logs(metric, Where(size, measure=measure))
    thin = rows.kind("shell", "rod")
    return {scene: value for scene, value in found.items() if metric != OF_THIN or scene in thin}


def _at_smaller(rows: Rows, metric: str, measure: str) -> tuple[Ratio | None, str]:
    """The number at the largest smaller size that has five scenes, and which these are."""
    for size in reversed(SIZES[:2]):
        logs = _smaller(rows, metric, measure, size)
        if len(logs) >= SCENES:
            scenes = counted(len(logs), "scene") + _kinds(metric)
            return mean_ratio(logs), f"at size {size} and theta 0.01 over {scenes}"
    return None, ""


def _by_size(rows: Rows) -> list[str]:
    """Log over cubic at every size and target: the bars of the figure, and products."""
    columns = {
        "gap_min": ("smallest gap", "diagnosed"),
        "load_high": ("largest load", "diagnosed"),
        **PANELS,
        "velocity_products": ("matrix products", "pcg"),
    }
    body = []
    for size in SIZES:
        for theta in THETAS:
            ratios = [
                written(rows.ratio(metric, Where(size, theta, measure=measure)))
                for metric, (_, measure) in columns.items()
            ]
            if set(ratios) != {"-"}:
                left = rows.dropped(Where(size, theta))
                out = "; ".join(f"{scene} ({why})" for scene, why in left.items()) or "-"
                body.append([size, theta, str(len(rows.pairs(Where(size, theta)))), out, *ratios])
    head = ["size", "theta", "scenes", "in no ratio", *(title for title, _ in columns.values())]
    return markdown(head, body)


def _missed(rows: list[Row]) -> list[str]:
    """Steps in which a stop rule never holds, which count with all of their iterations."""
    of: dict[tuple[str, str, str], dict[str, int]] = defaultdict(lambda: defaultdict(int))
    for row in rows:
        for rule in STOPS:
            if missed := row.values[f"{rule}_missed"]:
                of[row.place["arm"], row.place["size"], row.place["scene"]][rule] += missed
    body = [[*key, *(str(found[rule]) for rule in STOPS)] for key, found in sorted(of.items())]
    if not body:
        return ["Every rule holds in every step."]
    return markdown(["formulation", "size", "scene", *STOPS], body)


def _cost(study: Study, rows: list[Row]) -> list[str]:
    """Core hours by size and what was measured, and how many cells have no row."""
    hours: dict[tuple[str, str, str], float] = defaultdict(float)
    there: dict[tuple[str, str, str], int] = defaultdict(int)
    every: dict[tuple[str, str, str], int] = defaultdict(int)
    for cell in study.cells:
        every[_group(cell.place)] += 1
    for row in rows:
        hours[_group(row.place)] += (row.seconds or 0.0) / 3600
        there[_group(row.place)] += 1
    body = [
        [" ".join(group), f"{there[group]} of {count}", f"{hours[group]:.2f}" if there[group] else "-"]
        for group, count in every.items()
    ]
    total = ["all", f"{len(rows)} of {len(study.cells)}", f"{sum(hours.values()):.2f}"]
    return markdown(["size, setting, what is measured", "runs", "core hours"], [*body, total])


def _group(place: dict[str, str]) -> tuple[str, str, str]:
    setting = place["setting"]
    return (
        place["size"],
        "changed load" if of_label(setting) else setting,
        place["measure"],
    )


def _ends(rows: list[Row]) -> list[str]:
    """Which runs do not end ok."""
    of: dict[tuple[str, ...], list[str]] = defaultdict(list)
    for row in rows:
        if row.outcome != OK:
            of[row.place["arm"], row.place["theta"], row.place["size"], row.outcome].append(
                f"{row.place['scene']} {row.place['setting']}"
            )
    body = [[*key, counted(len(runs), "run"), ", ".join(runs)] for key, runs in sorted(of.items())]
    if not body:
        return ["All runs end ok."]
    return markdown(["formulation", "theta", "size", "outcome", "runs", "which"], body)


def _load(size: dict) -> str:
    return f"{size['load_N']:.3g} N" if "load_N" in size else "not known yet"


def _scenes(study: Study, of: Rows) -> list[str]:
    """What a scene is, its unknowns, and the load that both barriers carry at theta d_hat."""
    body = []
    for label, scene in of.scenes.items():
        sizes = [f"{n}: {one['unknowns']} ({_load(one)})" for n, one in scene["sizes"].items()]
        seen = "no rule has seen it" if scene["fresh"] else "catalogue"
        body.append([label, scene["kind"], scene["contact"], seen, ", ".join(sizes)])
    return markdown(["scene", "bodies", "contact with", "from", "unknowns (matched load)"], body)


def rule(study: Study, rows: list[Row]) -> dict:
    """What the template needs."""
    of = Rows(study, rows)
    found, of_laws = answers(of), laws(of)
    return {
        "answers": "\n".join(_answers(found)),
        "of_question": {a.number: _of_question(of, a) for a in found},
        "outcome": {a.number: a.outcome for a in found},
        "subjects": SUBJECTS,
        "laws": "\n\n".join(map(_law, of_laws)),
        "verdicts": "\n".join(
            f"- Law {law.number}, {law.name}: **{law.verdict}** ({law.why})." for law in of_laws
        ),
        "sentences": "\n".join(sentences(study, of, found)),
        "by_size": "\n".join(_by_size(of)),
        "arms_s": "\n".join(_arms(study, of, "S")),
        "arms_m": "\n".join(_arms(study, of, "M")),
        "power": "\n".join(power.table(study)),
        "cost": "\n".join(_cost(study, rows)),
        "ends": "\n".join(_ends(rows)),
        "missed": "\n".join(_missed(rows)),
        "scenes": "\n".join(_scenes(study, of)),
        "rows": len(rows),
        "cells": len(study.cells),
    }

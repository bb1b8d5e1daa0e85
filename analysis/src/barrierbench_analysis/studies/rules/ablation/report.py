"""What the page of an ablation says (configs/studies/ablation.md): sentences and tables of the effects."""

import math
from collections import Counter

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.numbers import interval, significant

from .effects import LEAST_SCENES, SHARES, Effect, Term
from .factors import Factorial

WORDS = {
    "newton": "Newton iterations of a run",
    "bj_p95": "95th percentile of the condition number after block Jacobi",
    "pcg": "median of PCG iterations on the same systems",
    "gap": "smallest gap in d_hat at a step end",
    "ok": "share of runs that end ok and valid",
    "common": "share with the common success",
}
BDF2 = "its matrix holds 9/4 of the mass over dt^2"
NEWMARK = "its matrix holds four times the mass over dt^2"
# Main effects that a definition makes, whatever the runs show: number, level -> why. They are no findings.
REASONS = {
    ("bj_p95", "bdf2"): BDF2,
    ("bj_p95", "newmark"): NEWMARK,
    ("pcg", "bdf2"): BDF2,
    ("pcg", "newmark"): NEWMARK,
    ("newton", "accumulated_toi"): "its steps end at an accumulated time of impact and ask for no"
    " convergence",
}


def name_of(factorial: Factorial, term: Term) -> str:
    """`cubic`, or `cubic x float`."""
    return " x ".join(factorial.factors[f].labels[level] for f, level in term.parts)


def against(factorial: Factorial, term: Term) -> str:
    return " x ".join(factorial.factors[f].labels[0] for f, _ in term.parts)


def by_construction(factorial: Factorial, effect: Effect) -> str:
    """Why a definition makes it; empty where nothing but the runs shows it, and for interactions."""
    return REASONS.get((effect.metric, name_of(factorial, effect.term)), "")


def value_of(effect: Effect) -> str:
    """A ratio or a difference of shares, with its interval."""
    if effect.mean is None:
        return "no scene has it"
    share = effect.metric in SHARES
    one = (lambda v: f"{v:+.2f}") if share else (lambda v: significant(math.exp(v)))
    return interval(effect.mean, effect.low, effect.high, one)


def _without(factorial: Factorial, effect: Effect) -> str:
    """What took an effect back."""
    names = " and ".join(f"`{factorial.factors[f].labels[level]}`" for f, level in effect.without)
    value = value_of(effect.direct)
    return f"without {names} {value}" if names else f"{value} directly"


def verdict_of(factorial: Factorial, effect: Effect) -> str:
    if effect.decided:
        why = by_construction(factorial, effect)
        return f"by construction: {why}" if why else "**decided**"
    if effect.passes:
        return f"taken back: {_without(factorial, effect)}"
    return "not decided" if len(effect.scenes) >= LEAST_SCENES else f"{len(effect.scenes)} scenes"


def _named(factorial: Factorial, effects: list[Effect]) -> str:
    return ", ".join(
        f"`{name_of(factorial, e.term)}` {value_of(e)}"
        f" {'beside' if e.metric in SHARES else 'times'} `{against(factorial, e.term)}`"
        for e in effects
    )


def sentence(factorial: Factorial, effects: list[Effect], words: str) -> str:
    """What is decided of a number, the largest first, what is not, and what has too few scenes to be
    tested."""
    decided = sorted((e for e in effects if e.decided), key=lambda e: -abs(e.mean))
    made = [e for e in decided if by_construction(factorial, e)]
    found = [e for e in decided if e not in made]
    text = f"{words[0].upper()}{words[1:]}: {len(found)} of {len(effects)} main effects are decided"
    text += f": {_named(factorial, found)}." if found else "."
    if made:
        text += f" By construction, so no finding: {_named(factorial, made)}."
    if back := [e for e in effects if e.passes and not e.decided]:
        named = (f"`{name_of(factorial, e.term)}` ({_without(factorial, e)})" for e in back)
        text += f" Taken back: {', '.join(named)}."
    for open_, what in (
        ([e for e in effects if not e.passes and e.p is not None], "Not decided"),
        ([e for e in effects if e.p is None], f"Not tested, with fewer than {LEAST_SCENES} scenes"),
    ):
        if open_:
            text += f" {what}: {', '.join(f'`{name_of(factorial, e.term)}`' for e in open_)}."
    return text


def _main_table(factorial: Factorial, metric: str, effects: list[Effect]) -> list[str]:
    rows = []
    for effect in effects:
        up, down = effect.signs
        rows.append(
            [
                factorial.factors[effect.term.parts[0][0]].name,
                f"{name_of(factorial, effect.term)} against {against(factorial, effect.term)}",
                value_of(effect),
                f"{up} up, {down} down, p {effect.sign_p:.2g}",
                significant(effect.holm, 2, none=""),
                verdict_of(factorial, effect),
            ]
        )
    kind = "difference" if metric in SHARES else "ratio"
    head = ["factor", "level", f"{kind} [95%]", "scenes, sign test beside it", "p (Holm)", ""]
    return [f"### {WORDS[metric]}", "", *markdown(head, rows), ""]


def _outcomes(rows: list[Row]) -> list[str]:
    body = []
    for scene in dict.fromkeys(row.place["scene"] for row in rows):
        mine = [row for row in rows if row.place["scene"] == scene]
        words = ", ".join(f"{word} {n}" for word, n in Counter(row.outcome for row in mine).most_common())
        body.append([scene, str(len(mine)), words, str(sum(map(SHARES["common"], mine)))])
    return markdown(["scene", "runs", "outcomes", "common success"], body)


def _interactions(factorial: Factorial, decided: list[Effect]) -> list[str]:
    body = [
        [
            WORDS[e.metric],
            f"{name_of(factorial, e.term)} against {against(factorial, e.term)}",
            value_of(e),
            f"{e.holm:.2g}",
        ]
        for e in sorted(decided, key=lambda e: (list(WORDS).index(e.metric), -abs(e.mean)))
    ]
    return (
        markdown(["number", "levels", "[95%]", "p (Holm)"], body) if body else ["Not decided: all of them."]
    )


def texts(factorial: Factorial, rows: list[Row], of: dict, of_pairs: dict) -> dict:
    """Of the page, without what was run. of, of_pairs: metric -> main effects, and interactions."""
    pairs = [e for metric in WORDS for e in of_pairs[metric]]
    decided = [e for e in pairs if e.decided]
    mains = [line for m in WORDS for line in _main_table(factorial, m, of[m])]
    return {
        "sentences": [sentence(factorial, of[m], words) for m, words in WORDS.items()],
        "tested_pairs": sum(e.p is not None for e in pairs),
        "decided_pairs": len(decided),
        "outcomes": "\n".join(_outcomes(rows)),
        "mains": "\n".join(mains),
        "interactions": "\n".join(_interactions(factorial, decided)),
    }

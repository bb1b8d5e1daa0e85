"""The page of an ablation: results/ABLATION.md. Sentences are made of numbers; the first names the slice."""

from __future__ import annotations

import math
from collections import Counter

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.tables.numbers import interval, significant
from barrierbench_analysis.tables.outcomes import counted_as

from .construction import by_construction
from .design import drawn, seldom
from .effects import LEAST_SCENES, LEVEL, SHARES, Effect, Study, Term
from .factors import Factorial
from .table import Table, got_through

WORDS = {
    "newton": "Newton iterations of a run",
    "bj_p95": "95th percentile of the condition number after block Jacobi",
    "pcg": "median of PCG iterations on the same systems",
    "gap": "smallest gap in d_hat at a step end",
    "ok": "share of runs that end ok and valid",
    "common": "share with the common success",
}
SLICE = "without a strain limit, fixed stiffnesses matched to the load of the scene at 0.1 d_hat"


def name_of(factorial: Factorial, term: Term) -> str:
    """`cubic`, or `cubic x float`."""
    return " x ".join(factorial.factors[f].labels[level] for f, level in term.parts)


def against(factorial: Factorial, term: Term) -> str:
    return " x ".join(factorial.factors[f].labels[0] for f, _ in term.parts)


def value_of(effect: Effect) -> str:
    """A ratio or a difference of shares, with its interval."""
    if effect.mean is None:
        return "no scene tells it"
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


def _largest(effects: list[Effect], n: int | None = None) -> list[Effect]:
    """Those that are decided, the largest first."""
    return sorted((e for e in effects if e.decided), key=lambda e: -abs(e.mean))[:n]


def _told(factorial: Factorial, effects: list[Effect]) -> tuple[list[Effect], list[Effect]]:
    """Those that are decided, the largest first: what the runs decided, and what the program did before."""
    found = _largest(effects)
    made = [e for e in found if by_construction(factorial, e)]
    return [e for e in found if e not in made], made


def _named(factorial: Factorial, effects: list[Effect]) -> str:
    return ", ".join(
        f"`{name_of(factorial, e.term)}` {value_of(e)}"
        f" {'beside' if e.metric in SHARES else 'times'} `{against(factorial, e.term)}`"
        for e in effects
    )


def _of_number(factorial: Factorial, effects: list[Effect], words: str) -> str:
    """What is decided of a number, what is not, and what has too few scenes to be tested."""
    found, made = _told(factorial, effects)
    said = f"{words[0].upper()}{words[1:]}: {len(found)} of {len(effects)} main effects are decided"
    said += f": {_named(factorial, found)}." if found else "."
    if made:
        said += f" By construction, so no finding: {_named(factorial, made)}."
    if back := [e for e in effects if e.passes and not e.decided]:
        named = (f"`{name_of(factorial, e.term)}` ({_without(factorial, e)})" for e in back)
        said += f" Taken back: {', '.join(named)}."
    for open_, what in (
        ([e for e in effects if not e.passes and e.p is not None], "Not decided"),
        ([e for e in effects if e.p is None], f"Not tested, with fewer than {LEAST_SCENES} scenes"),
    ):
        if open_:
            said += f" {what}: {', '.join(f'`{name_of(factorial, e.term)}`' for e in open_)}."
    return said


def lead(factorial: Factorial, table: Table) -> str:
    """The slice, what got through, and what an effect is."""
    runs, through = len(table.rows), sum(map(got_through, table.rows))
    common, scenes = sum(not row["failed"] for row in table.rows), len({row["scene"] for row in table.rows})
    return (
        f"All of this is over {scenes} scenes {SLICE}. {through} of {runs} runs end `ok` and valid, {common}"
        " with the common success; ratios are of the former alone, shares of all runs. An effect is that of a"
        " level against the first level of its factor, the other factors equal: the mean over scenes with its"
        f" 95% interval. It is decided when the sign-flip test of that mean has p < {LEVEL:g} after Holm."
        " It is taken back where it may rest on an interaction: without the runs that have one or two levels"
        f" of other factors it has to agree (same sign, p < {LEVEL:g} by itself), and where exclusions bind a"
        " level in the runs that both levels may have. What is taken back is not told from an interaction, or"
        " has too few runs left to tell. What a definition makes is named as made by construction."
        " What is not decided is not shown to be absent; its interval, in a table below, says what it may be."
    )


def sentences(factorial: Factorial, table: Table, study: Study) -> list[str]:
    """One a number, and one on interactions."""
    said = [_of_number(factorial, study.main[metric], words) for metric, words in WORDS.items()]
    pairs = [e for metric in WORDS for e in study.pairs[metric]]
    tested, decided = [e for e in pairs if e.p is not None], _largest(pairs)
    last = (
        f"Interactions: of {len(tested)} of two levels on these numbers that at least {LEAST_SCENES} scenes"
    )
    return [*said, f"{last} tell, {len(decided)} are decided; they are listed at the end."]


def _main_table(factorial: Factorial, study: Study, metric: str) -> list[str]:
    rows = []
    for effect in study.main[metric]:
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


def _outcomes(table: Table) -> list[str]:
    scenes = list(dict.fromkeys(row["scene"] for row in table.rows))
    rows = []
    for scene in scenes:
        mine = [row for row in table.rows if row["scene"] == scene]
        words = Counter(counted_as(row["outcome"], row["valid"], "not valid") for row in mine)
        rows.append(
            [
                scene,
                str(len(mine)),
                ", ".join(f"{word} {n}" for word, n in words.most_common()),
                str(sum(not row["failed"] for row in mine)),
            ]
        )
    head = ["scene", "runs", "outcomes", "common success"]
    return ["## Outcomes", "", *markdown(head, rows), ""]


def _interactions(factorial: Factorial, study: Study) -> list[str]:
    found = [e for metric in WORDS for e in study.pairs[metric] if e.decided]
    rows = [
        [
            WORDS[e.metric],
            f"{name_of(factorial, e.term)} against {against(factorial, e.term)}",
            value_of(e),
            f"{e.holm:.2g}",
        ]
        for e in sorted(found, key=lambda e: (list(WORDS).index(e.metric), -abs(e.mean)))
    ]
    shown = (
        markdown(["number", "levels", "[95%]", "p (Holm)"], rows) if rows else ["Not decided: all of them."]
    )
    return ["## Interactions that are decided", "", *shown, ""]


def _what_was_run(factorial: Factorial, table: Table) -> list[str]:
    spec, n_scenes = factorial.spec, len(factorial.scenes.levels)
    allowed, every = len(factorial.allowed) * n_scenes, math.prod(factorial.sizes) * n_scenes
    asked = spec["combinations"] * n_scenes
    missing = asked - len(table.rows)
    axes = ", ".join(f"{f.name} ({', '.join(f.levels)})" for f in factorial.factors)
    rarest = [seldom(factorial, drawn(factorial, scene)) for scene in factorial.scenes.labels]
    plan = table.about.get("plan")
    return [
        "## What was run",
        "",
        (
            f"`{factorial.sweep['name']}` has {every} combinations of {n_scenes} scenes"
            f" ({', '.join(factorial.scenes.levels)}) and {axes}; {allowed} of them are allowed. The fraction"
            f" has {spec['combinations']} in each scene; the rarest allowed pair of levels of two factors is"
            f" in {min(rarest)} to {max(rarest)} of them. {len(table.rows)} of {asked} runs are there"
            + (
                f"; {missing} are not run yet, and `./bench study ablation` goes on with them"
                if missing
                else ""
            )
            + ". Holm's factor counts all main effects of a number, or all its interactions."
        ),
        "",
        *([f"All allowed combinations, by `./bench plan`: {plan}.", ""] if plan else []),
    ]


def _reasons(factorial: Factorial) -> list[str]:
    excluded = zip(factorial.sweep["exclude"], factorial.spec["excluded"], strict=True)
    return [
        "Excluded:",
        "",
        *(f"- {' with '.join(entry['labels'])}: {reason}." for entry, reason in excluded),
        "",
        "Left out:",
        "",
        *(f"- {level}: {reason}." for level, reason in factorial.spec["left_out"].items()),
        "",
    ]


def page(factorial: Factorial, table: Table, study: Study) -> str:
    """The whole page."""
    about = table.about
    text = [
        "# Ablation",
        "",
        (
            f"Written by `./bench study ablation`. {about['date']}, {about['machine']}; commit"
            f" {about['commit']},"
            f" build {about['build']}. Rules: docs/results/method/ablation.md, which also"
            " lists what was changed and when."
        ),
        "",
        lead(factorial, table),
        "",
        (
            "Claims and gap map measure the shapes under other conditions: [One quantity, several studies]"
            "(../docs/results/several-studies.md)."
        ),
        "",
        *(f"{k}. {sentence}" for k, sentence in enumerate(sentences(factorial, table, study), 1)),
        "",
        "![main effects and interactions](../docs/ablation.png)",
        "",
        *_what_was_run(factorial, table),
        *_reasons(factorial),
        *_outcomes(table),
        "## Main effects",
        "",
        *(line for metric in WORDS for line in _main_table(factorial, study, metric)),
        *_interactions(factorial, study),
    ]
    return "\n".join(text)

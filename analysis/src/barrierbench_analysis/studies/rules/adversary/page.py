"""The numbers of the page: of each statement draws, core hours, what contradicts it,
and its most contrary draw.
"""

from collections import Counter

from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.numbers import significant
from barrierbench_analysis.tables.words import counted, listed

from .draws import Draw, hours, kept_draws, most_contrary, spent
from .gathered import gathered
from .region import Choice, Range
from .statement import EVERY, MEAN, Statement


def contradicting(draws: list[Draw]) -> list[Draw]:
    """Draws whose number is on the other side of the threshold of their statement."""
    said = ((draw, draw.contrast) for draw in draws)
    return [
        draw
        for draw, found in said
        if found and found.margin is not None and draw.statement.contradicts(found.margin)
    ]


def verdict(statement: Statement, draws: list[Draw]) -> str:
    """What the draws say of a statement. A mean is refuted by no draw."""
    against = contradicting(draws)
    scenes = len({draw.point.scene for draw in against})
    if not draws:
        return "not attacked yet"
    if statement.kind == MEAN:
        return f"{counted(len(against), 'draw')} of {len(draws)} on the other side"
    if not against:
        return "no counterexample"
    word = "refuted" if scenes >= statement.refuted_by else "contradicted"
    return f"{word} in {counted(scenes, 'scene')}"


def command(study: Study, draw: Draw) -> str:
    """What repeats the runs of a draw."""
    return f"{study.call('run')} --again --only statement={draw.statement.label} --only draw={draw.label}"


def _row(study: Study, statement: Statement, draws: list[Draw]) -> list[str]:
    none = [draw for draw in draws if (found := draw.contrast) and found.margin is None]
    end = f" (ended by its {why})" if (why := spent(study, draws)) else ""
    return [
        f"`{statement.label}`",
        f"{statement.source}: {statement.says}",
        statement.verdict,
        statement.threshold,
        str(len(draws)),
        f"{significant(hours(draws), 2)}{end}",
        str(len(contradicting(draws))) if draws else "-",
        str(len(none)) if draws else "-",
        f"**{verdict(statement, draws)}**",
    ]


HEAD = (
    *("label", "statement", "its verdict", "a draw agrees if", "draws", "core hours", "contradict"),
    *("compare nothing", "the search says"),
)


def _table(study: Study, of: dict[str, list[Draw]], kind: str) -> str:
    body = [_row(study, one, of[one.label]) for one in gathered(study).statements if one.kind == kind]
    return "\n".join(markdown(HEAD, body)) if body else "No statement of this kind holds."


def _best(study: Study, of: dict[str, list[Draw]], kind: str) -> str:
    """The most contrary draw of each statement, with the command that repeats it."""
    lines = []
    for statement in gathered(study).statements:
        best = most_contrary(of[statement.label])
        if statement.kind != kind or best is None:
            continue
        found = best.contrast
        word = "contradicts" if statement.contradicts(found.margin) else "agrees"
        lines += [
            f"- `{statement.label}`, draw {best.label} {word}: {found.numbers}; {best.point.text}.",
            f"  `{command(study, best)}`",
        ]
    return "\n".join(lines) or "No draw compares anything yet."


def _nothing(of: dict[str, list[Draw]]) -> str:
    """Why draws compare nothing, by statement."""
    body = []
    for label, draws in of.items():
        counts = Counter(found.why for draw in draws if (found := draw.contrast) and found.margin is None)
        body += [[f"`{label}`", why, str(n)] for why, n in counts.most_common()]
    return (
        "\n".join(markdown(["statement", "why", "draws"], body)) if body else "Every draw compares its runs."
    )


def _axis(axis: Range | Choice) -> str:
    if isinstance(axis, Choice):
        return " or ".join(axis.words)
    return f"{axis.low:g} to {axis.high:g}"


def _regions(study: Study) -> str:
    """Of each statement its scenes, and of each axis what its scenes span together."""
    body = []
    for statement in gathered(study).statements:
        spans: dict[str, list[str]] = {}
        for axes in statement.region.scenes.values():
            for name, axis in axes.items():
                spans.setdefault(name, []).append(_axis(axis))
        words = [
            f"{name} {listed(list(dict.fromkeys(of)), 3)}" for name, of in spans.items() if name != "seed"
        ]
        body.append([f"`{statement.label}`", listed(list(statement.region.scenes)), "; ".join(words)])
    return "\n".join(markdown(["statement", "scenes", "what changes"], body))


def _left(study: Study) -> str:
    body = [[one.source, one.says, one.why] for one in gathered(study).left]
    return "\n".join(markdown(["from", "statement", "why it is not attacked"], body)) if body else "None."


def rule(study: Study, rows: list[Row]) -> dict:
    """What the template needs."""
    there = {row.key: row for row in rows}
    of = {one.label: kept_draws(study, one, there) for one in gathered(study).statements}
    every = [draw for draws in of.values() for draw in draws]
    return {
        "every": _table(study, of, EVERY),
        "mean": _table(study, of, MEAN),
        "best_every": _best(study, of, EVERY),
        "best_mean": _best(study, of, MEAN),
        "nothing": _nothing(of),
        "regions": _regions(study),
        "left": _left(study),
        "statements": len(of),
        "draws": len(every),
        "hours": significant(hours(every), 2),
        "hours_each": f"{study.about['hours_each']:g}",
        "draws_each": study.about.get("draws_each"),
        "seed": study.about["seed"],
        "refuted": [
            label
            for label, draws in of.items()
            if verdict(gathered(study).named(label), draws).startswith("refuted")
        ],
    }

"""results/STRESS.md and the lines on the terminal, from the table."""

from __future__ import annotations

from collections import Counter

from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.tables.numbers import significant

from .entry import Test, left_out
from .run import WAITS, Row
from .table import Result


def _cell(rows: list[Row]) -> str:
    """Outcomes with their numbers of cases; bold: not expected, italic: a known defect."""
    marks = Counter(
        (row.outcome, "" if row.as_expected or row.outcome == WAITS else "*" if row.defect else "**")
        for row in rows
    )
    return (
        ", ".join(
            f"{mark}{word}{f' {n}' if n > 1 else ''}{mark}"
            for (word, mark), n in sorted(marks.items(), key=lambda item: len(item[0][1]))
        )
        or "-"
    )


def _numbers(rows: list[Row]) -> str:
    """Smallest gap over d_hat, in ulps, Newton iterations, seconds; of all cases."""

    def least(name):
        return min((getattr(row, name) for row in rows if getattr(row, name) is not None), default=None)

    newton, seconds = [sum(getattr(row, name) or 0 for row in rows) for name in ("newton", "seconds")]
    gap, ulps = significant(least("gap_min_rel"), 2), significant(least("gap_min_ulps"), 1)
    return f"{gap}, {ulps}, {newton}, {significant(seconds, 2)}"


def _table(head: list[str], lines: list[list[str]]) -> list[str]:
    return [*table_lines(head, lines), ""]


def columns(results: dict[str, Result], tests: dict[str, Test]) -> list[str]:
    """Formulations that most tests run: the comparable ones."""
    return list(dict.fromkeys(f.label for test in tests.values() if test.groups for f in test.formulations))


def _by_formulation(result: Result, label: str) -> list[Row]:
    return [row for row in result.rows if row.formulation == label]


def _own(results: dict[str, Result], tests: dict[str, Test], name: str) -> bool:
    return bool(tests[name].formulations) and not tests[name].groups


def _head(results: dict[str, Result], command: str) -> list[str]:
    """When, where and how long, and how many of each kind are as expected."""
    rows = [row for result in results.values() for row in result.rows]
    judged = [row for row in rows if row.outcome != WAITS]
    counts = [count for result in results.values() for count in result.counts]
    relations = [relation for result in results.values() for relation in result.relations]
    dates = sorted({result.about.get("date", "") for result in results.values()})
    machines = sorted({result.about.get("machine", "") for result in results.values()} - {""})
    commits = sorted({result.about.get("commit", "") for result in results.values()} - {""})
    seconds = sum(result.about.get("seconds", 0) for result in results.values())
    return [
        "# Stress suite",
        "",
        (
            f"Written by `{command}`. {', '.join(dates)}, {', '.join(machines)}, one thread; commit"
            f" {', '.join(commits)}; {seconds / 60:.1f} minutes in all."
        ),
        "",
        (
            f"{sum(row.as_expected for row in judged)} of {len(judged)} runs ended as was expected before the"
            " first run, or as an expectation that was changed since and is listed below;"
            f" {sum(bool(row.defect) for row in judged)} show a known defect;"
            f" {sum(relation.holds for relation in relations)} of {len(relations)} relations between runs"
            f" hold; {sum(count.as_expected for count in counts)} of {len(counts)} counts of geometry"
            f" ({sum(count.judged for count in counts)} subjects) are as expected;"
            f" {len(rows) - len(judged)} runs wait for a setting."
        ),
        "",
        (
            "What is not as expected stands in bold, known defects in italics. `not_valid`: ended ok, and the"
            " audit or another check refuses it. `refused`: exit code 2, no record."
        ),
        "",
    ]


def markdown(
    results: dict[str, Result], tests: dict[str, Test], command: str = "./bench study stress"
) -> str:
    """The whole page."""
    results = {name: results[name] for name in tests if name in results}
    text = _head(results, command)
    text += _outcomes(results, tests)
    text += _own_tables(results, tests)
    text += _relations(results)
    text += _geometry(results)
    text += _surprises(results)
    text += _defects(results, tests)
    text += _changes(tests)
    text += ["## Left out", "", *(f"- {name}: {why}." for name, why in left_out().items()), ""]
    return "\n".join(text)


def _outcomes(results, tests) -> list[str]:
    labels = columns(results, tests)
    names = [name for name in results if tests[name].groups]

    def title(name):
        return f"{name} {tests[name].data['title']}"

    text = [
        "## Outcomes",
        "",
        *_table(
            ["test", *labels],
            [
                [title(name), *(_cell(_by_formulation(results[name], label)) for label in labels)]
                for name in names
            ],
        ),
        "## Numbers",
        "",
        (
            "Smallest gap at a step end over d_hat, the same in units of the last place, Newton iterations,"
            " seconds; over all cases of a test."
        ),
        "",
        *_table(
            ["test", *labels],
            [
                [name, *(_numbers(_by_formulation(results[name], label)) for label in labels)]
                for name in names
            ],
        ),
    ]
    return text


def _own_tables(results, tests) -> list[str]:
    text = []
    for name in results:
        if _own(results, tests, name):
            text += [
                f"### {name} {tests[name].data['title']}",
                "",
                *_table(
                    ["formulation", "outcome", "gap, ulps, Newton, seconds", "PCG iterations"],
                    [
                        [
                            f.label,
                            _cell(rows := _by_formulation(results[name], f.label)),
                            _numbers(rows),
                            significant(sum(row.linear or 0 for row in rows), 6),
                        ]
                        for f in tests[name].formulations
                    ],
                ),
            ]
    return text


def _relations(results) -> list[str]:
    lines = [
        [
            name,
            r.says,
            r.worst or "-",
            f"{r.judged}" + (f" ({r.not_judged} could not be)" if r.not_judged else ""),
            (
                "holds"
                if r.holds
                else "**"
                + (
                    "; ".join(r.broken[:4]) + (f"; {len(r.broken) - 4} more" if len(r.broken) > 4 else "")
                    or "nothing was judged"
                )
                + "**"
            ),
            r.reason,
        ]
        for name, result in results.items()
        for r in result.relations
    ]
    return (
        [
            "## Relations between runs",
            "",
            *_table(
                ["test", "relation", "smallest and largest", "judged", "verdict", "expected because"], lines
            ),
        ]
        if lines
        else []
    )


def _geometry(results) -> list[str]:
    lines = [
        [
            name,
            c.case,
            c.precision,
            f"{c.judged}" + (f" ({c.not_judged} could not be)" if c.not_judged else ""),
            ", ".join(f"{k} {v:.2g}" for k, v in c.numbers.items()),
            ", ".join(f"{k} <= {v:g}" for k, v in c.allowed.items()) or "anything",
            "yes" if c.as_expected else "**no**",
        ]
        for name, result in results.items()
        for c in result.counts
    ]
    return (
        [
            "## Geometry",
            "",
            "Pairs and shapes through `./bench eval`, against exact fractions and decimals of 60 digits.",
            "",
            *_table(["test", "case", "precision", "judged", "found", "expected", "as expected"], lines),
        ]
        if lines
        else []
    )


def _surprises(results) -> list[str]:
    lines = [
        [
            name,
            row.formulation,
            row.case,
            row.outcome,
            " or ".join(row.expected),
            row.detail.replace("|", "/")[:160],
        ]
        for name, result in results.items()
        for row in result.unexpected
    ]
    return [
        "## Not as expected",
        "",
        *(
            _table(["test", "formulation", "case", "found", "expected", "what the record says"], lines)
            if lines
            else ["Nothing.", ""]
        ),
    ]


def _defects(results, tests) -> list[str]:
    lines = []
    for name in results:
        for entry in tests[name].data.get("defects", []):
            n = sum(row.defect == entry["why"] for row in results[name].rows)
            lines.append(
                [
                    name,
                    "; ".join(entry["cases"]),
                    " or ".join(entry["outcomes"]),
                    f"{n} runs" if n else "**no run shows it any more**",
                    entry["why"],
                ]
            )
    return (
        ["## Known defects", "", *_table(["test", "cases", "found", "how often", "why"], lines)]
        if lines
        else []
    )


def _changes(tests) -> list[str]:
    lines = [
        [name, change["what"], change["old"], change["new"], change["why"]]
        for name, test in tests.items()
        for change in test.data.get("changed", [])
    ]
    return [
        "## Changed expectations",
        "",
        "Every expectation was committed before the first run; these were changed after it.",
        "",
        *(_table(["test", "what", "old", "new", "why"], lines) if lines else ["None.", ""]),
    ]


def text(results: dict[str, Result], tests: dict[str, Test]) -> str:
    """One line a test."""
    lines = []
    for name in tests:
        result = results[name]
        judged = [row for row in result.rows if row.outcome != WAITS]
        what = (
            f"{sum(row.as_expected for row in judged)}/{len(judged)} runs"
            if result.rows
            else f"{sum(c.as_expected for c in result.counts)}/{len(result.counts)} counts"
        )
        if result.relations:
            what += f", {sum(r.holds for r in result.relations)}/{len(result.relations)} relations"
        if known := sum(bool(row.defect) for row in judged):
            what += f", {known} known defects"
        if len(judged) < len(result.rows):
            what += f", {len(result.rows) - len(judged)} wait"
        lines.append(
            f"{'as expected' if result.as_expected else 'UNEXPECTED ':<11}  {name} "
            f" {tests[name].data['title'][:70]:<70}  {what}  {result.about.get('seconds', 0):.0f} s"
        )
        lines += [
            f"             {row.formulation}, {row.case}: {row.outcome}, expected"
            f" {' or '.join(row.expected)}: {row.detail[:150]}"
            for row in result.unexpected
        ]
        lines += [
            f"             {r.says}: {'; '.join(r.broken) or 'nothing was judged'}"
            for r in result.relations
            if not r.holds
        ]
        lines += [
            f"             {c.precision}, {c.case}: {c.numbers}, {c.judged} judged"
            for c in result.counts
            if not c.as_expected
        ]
    return "\n".join(lines)

"""Verdicts as text: results/CLAIMS.md, and the short table of docs/results/claims.md."""

import textwrap

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.template import filled
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.pages.stated.sources import measured_elsewhere
from barrierbench_analysis.program.verbs import renewed
from barrierbench_analysis.studies.claims import frontiers, verdict_code
from barrierbench_analysis.studies.claims.entry import read_sweep
from barrierbench_analysis.studies.claims.judge import Answer
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.claims.verdict import IN_PART, ONLY_IF, OPEN, Judged
from barrierbench_analysis.studies.claims.words import interval
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.tables.numbers import ratio

TEMPLATE = ROOT / "configs" / "studies" / "claims.md"
WIDTH = 140
MANY = 4  # parts: of more a table says how many hold


def counts_of(groups: tuple[int, ...], parts: list[Judged]) -> str:
    """How many parts hold and do not. Where several ask of one number, so many numbers there are too: two
    thresholds of one number are one measurement.
    """
    deciding = [j for j in parts if not j.beside]
    numbers = {(j.measures, j.sweep, j.slice, j.value, j.lower, j.upper) for j in deciding}
    of = (
        f"of {sum(groups)} questions on {len(numbers)} numbers"
        if len(numbers) < len(deciding) == sum(groups)
        else f"of {sum(groups)} parts"
    )
    return f"{of}: {groups[0]} upheld, {groups[1]} refuted, {groups[2]} not decided"


def sentence(j: Judged, brief: bool = False, parts: list[Judged] = ()) -> str:
    """The verdict with its condition or its parts, or with what is missing. brief: of many parts how many
    hold, for a cell of a table.
    """
    if brief and j.verdict == IN_PART and sum(j.groups) > MANY:
        return f"{IN_PART} ({counts_of(j.groups, list(parts))})"
    if j.verdict == ONLY_IF:
        return f"{ONLY_IF}: {j.condition}"
    if j.verdict == IN_PART:
        return f"{IN_PART} ({j.condition})"
    return f"{OPEN}: {j.missing}" if j.verdict == OPEN and j.missing else j.verdict


def confirmed_word(a: Answer) -> str:
    if a.proven:
        return "closed form"
    if not a.confirmed:
        return a.state.word
    return sentence(a.confirmed, brief=True, parts=a.confirmed_parts) + _resting(
        a.confirmed_rests, a.confirmed_parts
    )


def _resting(rests: dict[str, str], parts: list[Judged]) -> str:
    """Beside a verdict: which of its deciding parts one demand decides alone."""
    named = [f"{j.says} {rests[j.says]}" for j in parts if not j.beside and j.says in rests]
    return f" ({'; '.join(named)})" if named else ""


SWEEP_COLUMNS = (
    "sweep",
    "runs",
    "unknowns",
    "ok",
    "comparable",
    "seconds",
    "date",
    "machine",
    "build",
    "command",
)


def sweep_table(table: Table) -> list[str]:
    rows = []
    for name, runs in sorted(table.sweeps.items()):
        sweep, about = read_sweep(name), runs.about
        ok = sum(row["outcome"] == "ok" for row in runs.rows)
        comparable = sum(row["comparability"] == "comparable" for row in runs.rows)
        made = about["unknowns"], f"{ok}", f"{comparable}", f"{about['seconds']:.0f}", about["date"]
        by = about["machine"], about["build"][:8], f"`{sweep.command}`"
        rows.append([name, f"{len(runs.rows)} of {len(sweep.cases)}", *made, *by])
    return table_lines(SWEEP_COLUMNS, rows)


def _short(a: Answer) -> str:
    if a.verdict.verdict == OPEN and a.claim.waits_for:
        return f"{OPEN}: waits for {a.claim.waits_for}"
    return sentence(a.verdict, brief=True, parts=a.parts) + _resting(a.rests, a.parts)


def main_number(j: Judged) -> str:
    return f"{j.measures}: {interval(j)}" + (f" ({j.ends})" if j.ends else "")


VERDICT_COLUMNS = (
    "claim",
    "sentence",
    "kind",
    "exploratory verdict (or closed form)",
    "confirmed",
    "number of its first part (of the confirmed scenes where there are any)",
)


def verdict_table(answers: list[Answer]) -> list[str]:
    rows = []
    for a in answers:
        j = a.confirmed_main or a.main
        number_of = f"{main_number(j)}{f' ({j.slice})' if j.slice else ''}" if j else "-"
        number_of += f"; {j.scenes} confirmed scenes" if j and a.confirmed_main else ""
        rows.append([a.claim.id, a.claim.sentence, a.claim.kind, _short(a), confirmed_word(a), number_of])
    return table_lines(VERDICT_COLUMNS, rows)


BEGIN, END = "<!-- claims: written by ./bench study claims -->\n", "<!-- /claims -->"


def in_page(page: str, answers: list[Answer]) -> str:
    """docs/results/claims.md with its table of verdicts made anew."""
    before, _, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    return before + BEGIN + "\n".join(verdict_table(answers)) + "\n" + end + after if end else page


def markdown(answers: list[Answer], table: Table) -> str:
    """The page. Errors: UserError for a template that asks for what is not here."""
    about = {
        "answers": answers,
        "changes": verdict_code.changes(),
        "conditional": (ONLY_IF, IN_PART, OPEN),
        "confirmed_word": confirmed_word,
        # Other studies measure what a part compares: verdicts may differ with the conditions.
        "elsewhere": lambda claim: any(map(measured_elsewhere, claim.parts)),
        "frontier": lambda claim: frontiers.lines(claim, table),
        "interval": interval,
        "metrics": METRICS,
        "ratio": ratio,
        "seconds": f"{sum(runs.about['seconds'] for runs in table.sweeps.values()):.0f}",
        "sentence": sentence,
        "sweeps": "\n".join(sweep_table(table)),
        "verdicts": "\n".join(verdict_table(answers)),
    }
    return renewed(filled(TEMPLATE, about))  # texts of claims are kept


def text(answers: list[Answer]) -> str:
    """For a terminal."""
    lines = []
    for a in answers:
        j = a.main
        lines += textwrap.wrap(
            f"{a.claim.id:4} {_short(a)}; confirmed: {confirmed_word(a)}"
            + (f"  [{main_number(j)}]" if j else ""),
            WIDTH,
            subsequent_indent="     ",
        )
    return "\n".join(lines)

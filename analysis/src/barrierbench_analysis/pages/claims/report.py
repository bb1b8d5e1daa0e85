"""Verdicts as text: results/CLAIMS.md, and the short table of docs/results/claims.md."""

from __future__ import annotations

import textwrap

from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.pages.stated.sources import measured_elsewhere
from barrierbench_analysis.program.verbs import renewed
from barrierbench_analysis.studies.claims import frontiers, verdict_code
from barrierbench_analysis.studies.claims.entry import Claim, read_sweep
from barrierbench_analysis.studies.claims.judge import Answer
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.claims.verdict import IN_PART, ONLY_IF, OPEN, Judged
from barrierbench_analysis.studies.claims.words import interval
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.tables.numbers import ratio

WIDTH = 140
MANY = 4  # parts: of more a table says how many hold
SEVERAL = "../docs/results/several-studies.md"
BY_SMALLEST = "; compared by smallest gaps"


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


def _part(j: Judged, rests: dict[str, str]) -> list[str]:
    kind = "closed form" if j.proof else f"`{j.sweep}`"
    verdict = f"{sentence(j)}{' (beside, decides nothing)' if j.beside else ''}"
    verdict += f" ({rests[j.says]})" if j.says in rests else ""
    lines = [
        f"- {j.says}: **{verdict}**. {j.measures}{' (depends on the machine)' if j.machine else ''}:"
        f" {interval(j)}, asked: {j.threshold or '-'};"
        f" {j.counted or '-'}{BY_SMALLEST if j.smallest_gaps else ''}; {kind}."
    ]
    if j.slice:
        lines.append(
            f"  Slice: {j.slice}." + (f" Samples: {j.scenes} scenes; {j.starts}." if j.scenes else "")
        )
    if j.per_scene:
        lines.append(
            "  By scene (least and largest of its levels): "
            + "; ".join(
                f"{name} {ratio(v)} ({ratio(low)} to {ratio(high)} at {levels}, n = {n})"
                for name, v, low, high, levels, n in j.per_scene
            )
            + "."
        )
    if j.ends:
        lines.append(f"  Ends of steps: {j.ends}.")
    if j.runs:
        lines.append(f"  First {'pair' if len(j.runs) == 2 else 'run'}: run_id {', '.join(j.runs)}.")
    return lines


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


def _confirmation(a: Answer) -> list[str]:
    """What stands of the claim over scenes that no rule was tuned on."""
    if not a.state.why:
        return []
    lines = [f"Confirmed: **{confirmed_word(a)}** ({a.state.why}).", ""]
    for j in a.confirmed_parts:
        lines += _part(j, a.confirmed_rests)
    return lines + [""] if a.confirmed_parts else lines


def _elsewhere(claim: Claim) -> list[str]:
    """Where other studies measure what a part compares: verdicts may differ with the conditions."""
    if not any(measured_elsewhere(part) for part in claim.parts):
        return []
    return [
        "Gap map and ablation measure the same under other conditions, and decide some of it otherwise: the"
        f" numbers stand side by side in [One quantity, several studies]({SEVERAL}).",
        "",
    ]


def _claim(a: Answer, table: Table) -> list[str]:
    claim = a.claim
    lines = [
        f"## {claim.id}: {a.verdict.verdict}",
        "",
        claim.sentence,
        "",
        (
            f"Source: {claim.source}. Dimension: {claim.dimension}. Kind: {claim.kind}. Keeps the guarantee:"
            f" {claim.guarantee}. Rerun: `{claim.command}`."
        ),
        "",
    ]
    if a.verdict.verdict in (ONLY_IF, IN_PART, OPEN):
        lines += [f"**{sentence(a.verdict)}.**", ""]
    if a.why_exploratory:
        lines += [f"The verdict is {a.why_exploratory}.", ""]
    for j in a.parts:
        lines += _part(j, a.rests)
    if a.parts:
        lines.append("")
    lines += _elsewhere(claim) + _confirmation(a) + frontiers.lines(claim, table)
    if claim.note:
        lines += [claim.note, ""]
    for change in claim.rule_changes:
        lines += [f"Rule changed after numbers were seen: {change}", ""]
    return lines


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


def _sweeps(table: Table) -> list[str]:
    rows = []
    for name, runs in sorted(table.sweeps.items()):
        sweep, about = read_sweep(name), runs.about
        ok, comparable = (
            sum(row[key] == word for row in runs.rows)
            for key, word in (("outcome", "ok"), ("comparability", "comparable"))
        )
        rows.append(
            [
                name,
                f"{len(runs.rows)} of {len(sweep.cases)}",
                about["unknowns"],
                f"{ok}",
                f"{comparable}",
                f"{about['seconds']:.0f}",
                about["date"],
                about["machine"],
                about["build"][:8],
                f"`{sweep.command}`",
            ]
        )
    total = sum(runs.about["seconds"] for runs in table.sweeps.values())
    return [
        "## Sweeps",
        "",
        *table_lines(SWEEP_COLUMNS, rows),
        "",
        (
            f"Seconds are those of the runs, diagnosis and audit included: {total:.0f} s of one core in all,"
            " on a machine that did other work as well."
        ),
        "",
    ]


HEAD = """# Claims

Made by `./bench study claims` from results/claims.json; every verdict is computed by the rules in claims/ID.json, none is typed. docs/results/method/claims.md, has the rules. A
number is the mean of its scenes (a ratio: of their logarithms), a scene the mean of its levels (resolution, load, limit), a level that of its starts, with a 95% interval
over scenes by Student's t ([COVERAGE.md](COVERAGE.md)), or what its line says: levels and starts are no samples. cond is a condition number. Every part names its slice.
Verdicts from runs are exploratory: their rules were changed after numbers were seen, or not registered before them; the confirmed ones are over scenes that no rule was
tuned on, by a rule that was committed before their first run ("-": none was run). Interval and sign test were changed for all claims when numbers were known
(2026-11-23): before, a bootstrap drew levels and starts as samples too, and signs were those of scenes x levels, then of levels got through with every start; now of the
shares of starts, and thresholds are strict. A claim of which some parts hold and some do not holds in part. From a sentence to its runs: its sweep's command makes
the records, `run_id` names them in results/claims.json and in their run.json, and `./bench run RUN.json` repeats one.
Runs are comparable by the gaps at which each pair of bodies carries its load (docs/theory/audit.md, Comparability); where a part says "compared by smallest gaps", its numbers are
of records before version 3.5.0, whose verdicts are by the smallest gap of the whole run: another rule, and the two are never compared with each other. An end of a step
that is not asked to converge has a residual, in tolerances of a step that is.
"""


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
    lines = [
        HEAD,
        *verdict_code.lines(),
        "![main number of every claim by kind, with its scenes, interval and threshold](../docs/claims.png)",
        "",
        *verdict_table(answers),
        "",
    ]
    for a in answers:
        lines += _claim(a, table)
    lines += _sweeps(table)
    lines += [
        "## Metrics",
        "",
        *(
            f"- `{name}`: {meaning}{' (depends on the machine)' if machine else ''}"
            for name, (meaning, _, machine, _) in METRICS.items()
        ),
    ]
    return renewed("\n".join(lines)) + "\n"  # texts of claims are kept


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

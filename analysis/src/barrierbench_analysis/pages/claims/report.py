"""Verdicts as text: results/CLAIMS.md, a line for each claim, and what a terminal shows. All parts are in
results/CLAIMS.csv (parts_file.py).
"""

import textwrap

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.template import filled
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.pages.stated.sources import measured_elsewhere
from barrierbench_analysis.program.verbs import renewed
from barrierbench_analysis.studies.claims import frontiers, verdict_code
from barrierbench_analysis.studies.claims.judge import Answer
from barrierbench_analysis.studies.claims.sizes import SMALL, Sizes, of_parts, of_sweeps
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.claims.verdict import HOLDS, IN_PART, NOT, ONLY_IF, OPEN, Judged
from barrierbench_analysis.studies.claims.words import interval
from barrierbench_analysis.studies.kit.metrics import METRICS

from .appendix import TRIVIAL

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
        f"of {sum(groups)} questions on {len(numbers)} number{'s' if len(numbers) > 1 else ''}"
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


def _short(a: Answer) -> str:
    if a.verdict.verdict == OPEN and a.claim.waits_for:
        return f"{OPEN}: waits for {a.claim.waits_for}"
    return sentence(a.verdict, brief=True, parts=a.parts) + _resting(a.rests, a.parts)


def main_number(j: Judged) -> str:
    return f"{j.measures}: {interval(j)}" + (f" ({j.ends})" if j.ends else "")


LAST = "number of its first part (of the confirmed scenes where there are any)"
VERDICT_COLUMNS = (
    *(
        "claim",
        "sentence",
        "exploratory verdict (or closed form)",
        "confirmed",
        "sizes of these scenes",
        LAST,
    ),
)
TRIVIAL_COLUMNS = ("claim", "sentence", "verdict", "why no run could say otherwise", LAST)
SEVERAL = "[other studies](../docs/results/several-studies.md) measure the same"


def counted(j: Judged, parts: list[Judged]) -> str:
    """A verdict in a cell: of parts that are not all alike how many hold, do not, and are not decided."""
    deciding = [part.verdict for part in parts if not part.beside]
    if len(set(deciding)) < 2:
        return f"{j.verdict}: {j.condition}" if j.verdict == ONLY_IF else j.verdict
    good, bad = (sum(v in of for v in deciding) for of in ((HOLDS, ONLY_IF), (NOT,)))
    return f"{j.verdict} ({counts_of((good, bad, len(deciding) - good - bad), parts)})"


def _marked(text: str, sizes: Sizes | None) -> str:
    """With the rule on small scenes (studies/claims/sizes.py)."""
    return f"{text}; {sizes.mark}" if sizes and sizes.mark else text


def exploratory_cell(a: Answer, table: Table) -> str:
    if a.verdict.verdict == OPEN and a.claim.waits_for:
        return f"{OPEN}: waits for {a.claim.waits_for}"
    return _marked(counted(a.verdict, a.parts) + _resting(a.rests, a.parts), of_parts(a.parts, table))


def confirmed_cell(a: Answer, table: Table) -> str:
    if a.proven or not a.confirmed:
        return confirmed_word(a)
    text = counted(a.confirmed, a.confirmed_parts) + _resting(a.confirmed_rests, a.confirmed_parts)
    return _marked(text, of_parts(a.confirmed_parts, table))


def _number_cell(a: Answer) -> str:
    j = a.confirmed_main or a.main
    if j is None:
        return "-"
    which = " confirmed" if a.confirmed_main else ""
    scenes = f"; {j.scenes}{which} scenes" if j.scenes else ""
    return f"{main_number(j)}{f' ({j.slice})' if j.slice else ''}{scenes}"


def _sizes_cell(a: Answer, table: Table) -> str:
    """Of the runs of the number beside it."""
    j = a.confirmed_main or a.main
    sizes = of_sweeps([j.sweep], table) if j and j.sweep else None
    return sizes.words if sizes else "-"


def _link(a: Answer) -> str:
    return f"[{a.claim.id}](../claims/{a.claim.id}.json)"


def _sentence_cell(a: Answer) -> str:
    """Where other studies measure what a part compares, verdicts may differ with the conditions."""
    return a.claim.sentence + (f" ({SEVERAL})" if any(map(measured_elsewhere, a.claim.parts)) else "")


def verdict_table(answers: list[Answer], table: Table) -> list[str]:
    """Of the claims that runs can decide."""
    rows = []
    for a in (a for a in answers if a.claim.id not in TRIVIAL):
        verdicts = exploratory_cell(a, table), confirmed_cell(a, table)
        rows.append([_link(a), _sentence_cell(a), *verdicts, _sizes_cell(a, table), _number_cell(a)])
    return table_lines(VERDICT_COLUMNS, rows)


def trivial_table(answers: list[Answer], table: Table) -> list[str]:
    """Of the others, each with its reason."""
    rows = []
    for a in (a for a in answers if a.claim.id in TRIVIAL):
        verdict = exploratory_cell(a, table)
        rows.append([_link(a), _sentence_cell(a), verdict, TRIVIAL[a.claim.id], _number_cell(a)])
    return table_lines(TRIVIAL_COLUMNS, rows)


def markdown(answers: list[Answer], table: Table) -> str:
    """The page. Errors: UserError for a template that asks for what is not here."""
    about = {
        "changes": verdict_code.changes(),
        "frontiers": [
            (a.claim.id, "\n".join(found)) for a in answers if (found := frontiers.lines(a.claim, table))
        ],
        "metrics": METRICS,
        "seconds": f"{sum(runs.about['seconds'] for runs in table.sweeps.values()):.0f}",
        "small": f"{SMALL:,}",
        "trivial": "\n".join(trivial_table(answers, table)),
        "verdicts": "\n".join(verdict_table(answers, table)),
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

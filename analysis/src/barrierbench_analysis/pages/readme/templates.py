"""The generated parts of the pages, as templates of the kept numbers: `<!-- numbers: NAME -->` to `<!--
/numbers -->`.
"""

import re
import textwrap

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.pages.stated.cost import table
from barrierbench_analysis.pages.stated.several import table_lines as several_lines
from barrierbench_analysis.studies.rules.gap_map.page import sentences
from barrierbench_analysis.studies.rules.gap_map.table import NOT_RUN, Map

from . import slices

WIDTH = 140
# series of demo_drape -> what the table calls it
NAMES = {
    "cubic_dynamic": "cubic_dynamic (ours: per iteration, to convergence)",
    "cubic_dynamic published": "ando2024, as published (steps of 1 ms)",
    "cubic_dynamic_lagged": "cubic_dynamic_lagged (ours: per step)",
    "cubic_dynamic_consistent": "cubic_dynamic_consistent (ours: potential)",
}
BLOCK = re.compile(r"(<!-- numbers: (\w+) -->\n)(.*?)(<!-- /numbers -->)", re.DOTALL)


def _run(numbers: dict, group: str, series: str) -> dict:
    for row in numbers["runs"]:
        if (row["group"], row["series"]) == (group, series):
            return row
    raise UserError(f"results/demo.json: no run {series!r} of {group}; allowed: the runs of ./bench demo")


def _power(x: float | None) -> str:
    """Two digits: 1.2e4, 351."""
    if x is None:
        return "-"
    return f"{x:.1e}".replace("e+0", "e").replace("e+", "e") if x >= 1e3 else f"{x:.3g}"


def _outcome(row: dict) -> str:
    word = (
        row["outcome"]
        if row["outcome"] in ("ok", "timeout")
        else f"{row['outcome']} in step {row['steps'] - 1}"
    )
    return (
        word
        if row["verdict"] == "comparable" or row["outcome"] != "ok"
        else f"{word}, {row['verdict'].replace('_', ' ')}"
    )


def _name(row: dict) -> str:
    name = NAMES.get(row["series"], row["series"])
    return f"{name} (s = {row['scale']:.2g})" if row["scale"] is not None else name


def conditions(numbers: dict) -> list[str]:
    """Where and when, and for which processors the table holds."""
    about = numbers["about"]
    sentence = (
        f"Made {about['days']} on {about['cores']} cores of {about['processor']} ({about['compiler']}, BLAS"
        f" kernel {about['blas_kernel']}, commit {about['commit'][:10]}). Numbers of runs hold for this class"
        " of processors and this build: on another one the sums of BLAS and of the mathematics library are"
        " rounded otherwise, and counts of iterations move by a few per cent."
    )
    return textwrap.wrap(sentence, WIDTH)


def demo_table(numbers: dict) -> list[str]:
    """The runs of five cloth layers on a sphere."""
    rows = []
    for row in (row for row in numbers["runs"] if row["group"] == "demo_drape"):
        gap = "-" if row["gap_min_rel"] is None else f"{row['gap_min_rel']:.3f}"
        pcg = "-" if row["probe_pcg"] is None else f"{row['probe_pcg']:g}"
        raw, scaled = (
            f"{_power(row[f'cond_{of}_median'])}, {_power(row[f'cond_{of}_max'])}" for of in ("raw", "bj")
        )
        rows.append([_name(row), _outcome(row), raw, scaled, f"{row['newton_iterations']}", pcg, gap])
    head = ["five layers, 16^2", "outcome", "cond raw median, max", "cond bJ median, max", "Newton", "PCG"]
    return [*conditions(numbers), "", *table_lines([*head, "min gap/d_hat"], rows)]


def _free_of_crossings(numbers: dict) -> str:
    common = [row for row in numbers["runs"] if row["step_solver"] == "line_search"]
    if not common:
        raise UserError(
            "results/demo.json: no run with the step solver line_search, so that nothing is free of"
            " crossings; ./bench demo makes them"
        )
    bad = [
        row for row in common if not row["judged"] or row["crossings"] or row["violations"] or row["unproven"]
    ]
    if not bad:
        return (
            f"In all {len(common)} runs of the demo with the common method no surface passes through another,"
            " whichever barrier is used."
        )
    named = ", ".join(f"{row['series']} of {row['group']}" for row in bad)
    return (
        f"In {len(bad)} of {len(common)} runs of the demo with the common method the check of surfaces found"
        f" something, or had nothing to judge: {named}."
    )


def _draped(numbers: dict, sphere: str, words: str) -> tuple[str, str]:
    """The log beside the cubic in the layers that drape for longer: condition numbers, and what the gaps
    say."""
    log, cubic = (_run(numbers, "demo_long", f"{sphere} {name}") for name in ("log", "cubic"))
    median, p95, largest = (
        log[key] / cubic[key] for key in ("cond_raw_median", "cond_raw_p95", "cond_raw_max")
    )
    text = (
        f"{words} the logarithm's median is {median:.2g}, its 95th percentile {p95:.2g} and its largest"
        f" {largest:.2g} times the cubic's, and an iterative solver with a standard preconditioner takes"
        f" {log['probe_pcg']:g} against {cubic['probe_pcg']:g} iterations"
    )
    return text, cubic["verdict"]


def _log_against_cubic(numbers: dict) -> str:
    found = [
        _draped(numbers, *of)
        for of in (("formula", "with the sphere as a formula"), ("mesh", "with the sphere as a mesh"))
    ]
    duration = numbers["about"]["long"]["duration_s"]
    text = (
        f"Five cloth layers drape over a sphere for {duration:g} s, with equal contact forces under the"
        " largest load and a strain limit. Of the condition numbers over the run (cond: how hard a linear"
        " system is): " + "; ".join(words for words, _ in found) + "."
    )
    unlike = [name for name, (_, verdict) in zip(("formula", "mesh"), found) if verdict != "comparable"]
    return text + (
        f" Equal force is not equal gap: with the {' and the '.join(unlike)} the cubic's contacts rest at"
        " other gaps than the logarithm's, and its record says not comparable."
        if unlike
        else ""
    )


def _refreshed(numbers: dict) -> str:
    row, published = (
        _run(numbers, "demo_drape", name) for name in ("cubic_dynamic", "cubic_dynamic published")
    )
    others = [
        other
        for other in numbers["runs"]
        if other["group"] == "demo_drape"
        and other["series"].startswith("cubic_dynamic")
        and other not in (row, published)
    ]
    ended = sum(other["outcome"] == "ok" for other in others)
    verdict = (
        "ends `ok`"
        if row["outcome"] == "ok"
        else f"stops in time step {row['steps'] - 1} (`{row['outcome']}`)"
    )
    return (
        "With a stiffness of the barrier that is computed anew in every Newton iteration, driven to"
        f" convergence, the run {verdict}; of our {len(others)} variants that refresh it once a step, derive"
        f" it from a potential or make it stiffer, {ended} end `ok`. The published method, which requires no"
        f" convergence, ends `{published['outcome']}` after {published['steps']} steps of 1 ms."
    )


def _step_ends(numbers: dict, sphere: str) -> str:
    """The log beside the cubic in the last diagnosed iteration of every time step that ends in contact with
    both.
    """
    log, cubic = (_run(numbers, "demo_long", f"{sphere} {name}")["cond_steps"] for name in ("log", "cubic"))
    ratios = [log[step] / cubic[step] for step in log if step in cubic]
    if not ratios:
        raise UserError(
            f"results/demo.json: demo_long, {sphere}: no time step ends in contact with both log and cubic;"
            " ./bench demo makes them"
        )
    return (
        f"in {sum(ratio < 0.99 for ratio in ratios)} of {len(ratios)} with the sphere as a"
        f" {sphere} ({min(ratios):.2g} to {max(ratios):.2g} times the cubic's)"
    )


def drape_sentences(numbers: dict) -> list[str]:
    """What the figure of the longer drape shows."""
    text = (
        "Seen there, under these conditions (a load matched at 0.1 d_hat, a strain limit, condition numbers"
        f" of one iteration in {numbers['about']['long']['every']}, layers that still move at the end): of"
        " the time steps that end in contact, the log's last condition number is smaller by more than 1%"
        f" {' and '.join(_step_ends(numbers, sphere) for sphere in ('formula', 'mesh'))}. Single iterations"
        f" reach further (result 2)."
    )
    return textwrap.wrap(text, WIDTH)


def result_sentences(numbers: dict) -> list[str]:
    """What the demo shows."""
    sentences = (_free_of_crossings(numbers), _log_against_cubic(numbers), _refreshed(numbers))
    return [
        line
        for k, text in enumerate(sentences, 1)
        for line in textwrap.wrap(f"{k}. {text}", WIDTH, subsequent_indent="   ")
    ]


PARTS = {
    "README.md": ("answer", "at_size_sentences"),
    "docs/results/demo.md": ("result", "demo", "drape"),
    "docs/results/which-barrier.md": ("slices", "gap_map"),
    "docs/results/several-studies.md": ("several",),
    "docs/guides/cluster.md": ("cost",),
    "docs/study.md": ("at_size", "at_size_arms", "at_size_laws"),
}  # page -> its generated parts
TEMPLATES = {
    "answer": lambda numbers: numbers["answer"].splitlines(),
    "demo": demo_table,
    "result": result_sentences,
    "drape": drape_sentences,
    "slices": lambda numbers: slices.sentences(numbers["slices"], WIDTH),
    "several": lambda numbers: several_lines(numbers["several"]),
    "gap_map": lambda numbers: lines(numbers["gap_map"], WIDTH),
    "cost": lambda numbers: table(numbers["cost"]),
    "at_size": lambda numbers: [
        *numbers["at_size"]["sentences"].splitlines(),
        "",
        numbers["at_size"]["by_size"],
    ],
    "at_size_sentences": lambda numbers: numbers["at_size"]["sentences"].splitlines(),
    "at_size_arms": lambda numbers: [numbers["at_size"]["arms_s"]],
    "at_size_laws": lambda numbers: [numbers["at_size"]["verdicts"]],
}


def blocks(text: str) -> dict[str, str]:
    """Name -> content of the generated parts of a page."""
    return {match[2]: match[3] for match in BLOCK.finditer(text)}


def lacking(text: str, page: str) -> list[str]:
    """A line for every part of a page whose marks are not there: what is not marked is never made anew, and
    would never be stale.
    """
    there = blocks(text)
    return [
        f"{page}: no <!-- numbers: {name} --> ... <!-- /numbers -->, the marks of a generated part"
        for name in PARTS.get(page, ())
        if name not in there
    ]


def filled(text: str, numbers: dict, page: str) -> str:
    """The page with its generated parts made anew. Raises UserError for a part that no template makes."""

    def one(match: re.Match) -> str:
        if match[2] not in TEMPLATES:
            raise UserError(f"{page}: <!-- numbers: {match[2]} -->; allowed: {', '.join(TEMPLATES)}")
        return match[1] + "\n".join(TEMPLATES[match[2]](numbers)) + "\n" + match[4]

    return BLOCK.sub(one, text)


# --- map


def gather_map(found: Map) -> list[str]:
    """The sentences of the gap map that the pages show."""
    n, (low, high) = found.counts(), found.unknowns
    of = (
        f"Of {n['cells']} cells {n['cells'] - n[NOT_RUN]} are decided, with {len(found.made)} runs of"
        f" {low} to {high} unknowns"
    )
    return [
        *sentences(found),
        of + (f"; {n[NOT_RUN]} are not run yet, most of them of the larger scenes." if n[NOT_RUN] else "."),
    ]


def lines(found: list[str], width: int) -> list[str]:
    return [line for text in found for line in textwrap.wrap(f"- {text}", width, subsequent_indent="  ")]

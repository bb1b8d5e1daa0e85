"""The generated parts of the pages, as templates of the kept numbers: `<!-- numbers: NAME -->` to `<!-- /numbers -->`."""

from __future__ import annotations

import re
import statistics
import textwrap

from .numbers import ReadmeError
from .slices import sentence

WIDTH = 140
# series of demo_drape -> what the table calls it
NAMES = {"cubic_dynamic": "cubic_dynamic (per iteration)", "cubic_dynamic published": "cubic_dynamic, with its own step solver",
         "cubic_dynamic_lagged": "cubic_dynamic_lagged (per step)", "cubic_dynamic_consistent": "cubic_dynamic_consistent (potential)"}
BLOCK = re.compile(r"(<!-- numbers: (\w+) -->\n)(.*?)(<!-- /numbers -->)", re.DOTALL)


def _run(numbers: dict, group: str, series: str) -> dict:
    for row in numbers["runs"]:
        if (row["group"], row["series"]) == (group, series):
            return row
    raise ReadmeError(f"results/demo.json: no run {series!r} of {group}; allowed: the runs of ./bench demo")


def _power(x: float | None) -> str:
    """Two digits: 1.2e4, 351."""
    if x is None:
        return "-"
    return f"{x:.1e}".replace("e+0", "e").replace("e+", "e") if x >= 1e3 else f"{x:.3g}"


def _outcome(row: dict) -> str:
    word = row["outcome"] if row["outcome"] in ("ok", "timeout") else f"{row['outcome']} in step {row['steps'] - 1}"
    return word if row["verdict"] == "comparable" or row["outcome"] != "ok" else f"{word}, {row['verdict'].replace('_', ' ')}"


def _name(row: dict) -> str:
    name = NAMES.get(row["series"], row["series"])
    return f"{name} (s = {row['scale']:.2g})" if row["scale"] is not None else name


def conditions(numbers: dict) -> list[str]:
    """Where and when, and for which processors the table holds."""
    about = numbers["about"]
    sentence = (f"Made {about['days']} on {about['cores']} cores of {about['processor']} ({about['compiler']}, BLAS kernel {about['blas_kernel']}, commit {about['commit'][:10]}). "
                "Numbers of runs hold for this class of processors and this build: on another one the sums of BLAS and of the mathematics library are rounded otherwise, "
                "and counts of iterations move by a few per cent.")
    return textwrap.wrap(sentence, WIDTH)


def demo_table(numbers: dict) -> list[str]:
    """The runs of five cloth layers on a sphere."""
    lines = [*conditions(numbers), "", "| five layers, 16^2 | outcome | cond raw median, max | cond bJ median, max | Newton | PCG | min gap/d_hat |", "|---|---|---|---|---|---|---|"]
    for row in (row for row in numbers["runs"] if row["group"] == "demo_drape"):
        gap = "-" if row["gap_min_rel"] is None else f"{row['gap_min_rel']:.3f}"
        pcg = "-" if row["probe_pcg"] is None else f"{row['probe_pcg']:g}"
        lines.append(f"| {_name(row)} | {_outcome(row)} | {_power(row['cond_raw_median'])}, {_power(row['cond_raw_max'])} "
                     f"| {_power(row['cond_bj_median'])}, {_power(row['cond_bj_max'])} | {row['newton_iterations']} | {pcg} | {gap} |")
    return lines


def _free_of_crossings(numbers: dict) -> str:
    common = [row for row in numbers["runs"] if row["step_solver"] == "line_search"]
    if not common:
        raise ReadmeError("results/demo.json: no run with the step solver line_search, so that nothing is free of crossings; ./bench demo makes them")
    bad = [row for row in common if not row["judged"] or row["crossings"] or row["violations"] or row["unproven"]]
    if not bad:
        return f"In all {len(common)} runs of the demo with the common method no surface passes through another, whichever barrier is used."
    named = ", ".join(f"{row['series']} of {row['group']}" for row in bad)
    return f"In {len(bad)} of {len(common)} runs of the demo with the common method the check of surfaces found something, or had nothing to judge: {named}."


def _log_against_cubic(numbers: dict) -> str:
    log, cubic = (_run(numbers, "demo_drape", name) for name in ("log", "cubic"))
    free = [step for step in log["cond_steps"] if step in cubic["cond_steps"] and step not in log["touching_steps"]]
    before = statistics.median(log["cond_steps"][k] / cubic["cond_steps"][k] for k in free) if free else None
    text = (f"At equal contact forces under the largest load, with a strain limit, the largest condition number (cond: how hard a linear system is) that the logarithm reaches in a single iteration is {log['cond_raw_max'] / cubic['cond_raw_max']:.2g} times that of the "
            "cubic in five cloth layers on a sphere")
    text += f", and {before:.2g} times before they touch" if before is not None else ""
    text += f"; an iterative solver with a standard preconditioner takes {log['probe_pcg']:g} against {cubic['probe_pcg']:g} iterations"
    if cubic["verdict"] == "comparable":
        return f"{text}."
    return f"{text}. Equal force is not equal gap: the cubic's contacts rest at other gaps than the logarithm's, and its record says {cubic['verdict'].replace('_', ' ')}."


def _refreshed(numbers: dict) -> str:
    row = _run(numbers, "demo_drape", "cubic_dynamic")
    others = [other for other in numbers["runs"] if other["group"] == "demo_drape" and other["series"].startswith("cubic_dynamic") and other is not row]
    ended = sum(other["outcome"] == "ok" for other in others)
    verdict = "ends `ok`" if row["outcome"] == "ok" else f"stops in time step {row['steps'] - 1} (`{row['outcome']}`)"
    return (f"With a stiffness of the barrier that is computed anew in every Newton iteration the run {verdict}; of the {len(others)} variants that refresh it once a step, "
            f"derive it from a potential, make it stiffer or ask for no convergence, {ended} end `ok`.")


def result_sentences(numbers: dict) -> list[str]:
    """The three results of the first screen."""
    sentences = (_free_of_crossings(numbers), _log_against_cubic(numbers), _refreshed(numbers))
    return [line for k, text in enumerate(sentences, 1) for line in textwrap.wrap(f"{k}. {text}", WIDTH, subsequent_indent="   ")]


PARTS = {"README.md": ("result", "slices"), "docs/results.md": ("demo",)}  # page -> its generated parts
TEMPLATES = {"demo": demo_table, "result": result_sentences, "slices": lambda numbers: sentence(numbers["slices"], WIDTH)}


def blocks(text: str) -> dict[str, str]:
    """Name -> content of the generated parts of a page."""
    return {match[2]: match[3] for match in BLOCK.finditer(text)}


def lacking(text: str, page: str) -> list[str]:
    """A line for every part of a page whose marks are not there: what is not marked is never made anew, and would never be stale."""
    there = blocks(text)
    return [f"{page}: no <!-- numbers: {name} --> ... <!-- /numbers -->, the marks of a generated part" for name in PARTS.get(page, ()) if name not in there]


def filled(text: str, numbers: dict, page: str) -> str:
    """The page with its generated parts made anew. Raises ReadmeError for a part that no template makes."""
    def one(match: re.Match) -> str:
        if match[2] not in TEMPLATES:
            raise ReadmeError(f"{page}: <!-- numbers: {match[2]} -->; allowed: {', '.join(TEMPLATES)}")
        return match[1] + "\n".join(TEMPLATES[match[2]](numbers)) + "\n" + match[4]

    return BLOCK.sub(one, text)

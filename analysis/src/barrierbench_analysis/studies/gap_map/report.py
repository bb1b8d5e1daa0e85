"""results/GAP_MAP.md, made of gap_map.json."""

from __future__ import annotations

from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.program.verbs import renewed

from . import size_page, skips
from .compare import METRICS, Beside, Common, at_gap, at_theta, counted_once, deepest, gaps_at, middles
from .figure import TITLES, law_sentence
from .judge import FAR, MADE, counts, exceptions, extent, failures, made_by_contact, pairs, reason, unreached
from .kept import Kept
from .rows import CANNOT, NO_CONTACT, NOT_RUN, UNKNOWN
from .spec import LIMITS, REFERENCE
from .table import Map

NAMES = {"cond_p95": "raw", "bj_p95": "block Jacobi", "pcg": "PCG", "newton": "Newton"}
MOST = 40  # exceptions that the page lists one by one; all are in the table of gap_law.csv


def _others(found: Map) -> list[str]:
    return [s for s in found.shapes if s != REFERENCE]


def _left_out(cut: Common) -> str:
    return ", ".join(f"`{shape}` ({n} of {of})" for shape, (n, of) in cut.left_out.items())


def _table(found: Map, limit: str, head: str, beside) -> list[str]:
    """A row a shape; the rows of one target are of the same places, which the first column names."""
    rows = []
    for gap in found.gaps:
        here: Beside = beside(found.rows, limit, gap, _others(found))
        for shape, ratios in here.ratios.items():
            rows.append([f"{gap:g}", f"`{shape}`", *(str(ratios[m]) for m in METRICS), here.cut.words])
        if here.cut.left_out:
            rows.append([f"{gap:g}", f"not compared: {_left_out(here.cut)}", *[""] * (len(METRICS) + 1)])
    columns = [f"{NAMES[metric]} over the log's" for metric in METRICS]
    return table_lines([head, "shape", *columns, "all of these in"], rows)


def _ends(found: Map) -> list[str]:
    """Who reaches which gap, by limit: every column is of the places that all its shapes share."""
    cuts = {limit: deepest(found.rows, limit, found.shapes) for limit in found.limits}
    of = {limit: middles(cut) for limit, cut in cuts.items()}
    rows = []
    for shape in found.shapes:
        cells = []
        for limit in found.limits:
            gaps = cuts[limit].of.get(shape, {}).values()
            n, tried = cuts[limit].left_out.get(shape, (0, 0))
            apart = f"in {n} of {tried} places: not compared" if tried else "no run"
            cells.append(f"{of[limit][shape]:.3g} ({min(gaps):.3g} to {max(gaps):.3g})" if gaps else apart)
        rows.append([f"`{shape}`", *cells])
    heads = [f"{TITLES[limit]}: {cut.words}" for limit, cut in cuts.items()]
    return table_lines(["shape", *heads], rows)


def _failed(found: Map) -> list[str]:
    rows = [
        [
            f"`{shape}`",
            TITLES[limit],
            f"{theta:g}",
            ", ".join(f"{word} {n}" for word, n in sorted(outcomes.items())),
        ]
        for (shape, limit, theta), outcomes in failures(found.rows).items()
    ]
    return (
        table_lines(["shape", "limit", "theta", "runs without a gap"], rows)
        if rows
        else ["Every cell of the map has a run that reached a gap."]
    )


def _never(found: Map) -> list[str]:
    by: dict[tuple[str, str], list[float]] = {}
    for limit, shape, gap in unreached(found.rows, found.gaps):
        by.setdefault((limit, shape), []).append(gap)
    return [
        f"- {TITLES[limit]}, `{shape}`: " + ", ".join(f"{gap:g}" for gap in gaps)
        for (limit, shape), gaps in by.items()
    ]


def _rests(found: Map, limit: str) -> str:
    """Where contact rests at the smallest target, over the places that all shapes named there reached."""
    theta = min(found.gaps)
    cut = gaps_at(found.rows, limit, theta, found.shapes)
    asked = f"Asked for {theta:g} d_hat at the largest load, with {TITLES[limit]}, "
    if not cut.of:
        return f"{asked}there is no place where every shape that reached a gap has one."
    named = ", ".join(
        f"{gap:.3g} (`{s}`)" for s, gap in sorted(middles(cut).items(), key=lambda item: item[1])
    )
    text = (
        f"{asked}the contact that bears the median load rests at {named} (median of the {cut.words} that all"
        " of these reached)"
    )
    without = [shape for shape in found.shapes if shape not in cut.of]
    return text + (
        f"; without a gap in half of the places or more: {', '.join(f'`{shape}`' for shape in without)}."
        if without
        else "."
    )


def _ranked(beside: Beside, metric: str) -> list[tuple[str, str]]:
    ranked = sorted(beside.ratios.items(), key=lambda item: item[1][metric].value)
    return [(f"`{shape}`", str(ratios[metric])) for shape, ratios in ranked]


def _same_loads(found: Map, limit: str) -> str:
    """Raw condition numbers over the log's at the largest and the smallest theta, ranked where all shapes
    are of the same places.
    """
    parts = []
    for theta in (max(found.gaps), min(found.gaps)):
        here = at_theta(found.rows, limit, theta, _others(found))
        ranked = ", ".join(" ".join(pair) for pair in _ranked(here, "cond_p95"))
        parts.append(
            f"at theta {theta:g} (the {here.cut.words} in which all of these got through) {ranked}"
            if ranked
            else f"at theta {theta:g} no place is left in which the shapes that got through share"
        )
    return (
        f"With {TITLES[limit]} and under the same loads, raw condition numbers over the log's are"
        f" {'; '.join(parts)}."
    )


def _in_iterations(found: Map) -> str:
    """How far a shape moves each number at the smallest target in each limit mode: the smallest and the
    largest of the means, with their names.
    """
    theta, spans = min(found.gaps), []
    for limit in found.limits:
        here = at_theta(found.rows, limit, theta, _others(found))
        if not here.ratios:
            continue
        ends = []
        for metric in METRICS:
            ranked = _ranked(here, metric)
            first, last = ranked[0], ranked[-1]
            ends.append(f"{NAMES[metric]} {first[1]} ({first[0]}) to {last[1]} ({last[0]})")
        left = f"; not compared: {_left_out(here.cut)}" if here.cut.left_out else ""
        spans.append(f"{TITLES[limit]} ({here.cut.words}{left}): {', '.join(ends)}")
    return (
        f"What of this arrives in iterations at theta {theta:g}: over the log's, the smallest and the largest"
        f" of the shapes' means over scenes (single scenes lie farther out): {'; '.join(spans)}."
    )


def _made(found: Map) -> str:
    """How often contact is what makes a condition number."""
    parts = [
        f"{made} of {n} ({TITLES[limit]})"
        for limit in found.limits
        for made, n in [made_by_contact(found.rows, limit)]
    ]
    return (
        f"Contact makes the log's largest eigenvalue at step ends (cond at least {MADE:g} times that without"
        f" contact) in {', '.join(parts)} of its runs."
    )


def sentences(found: Map) -> list[str]:
    """What a reader keeps, each sentence computed from the rows."""
    off = "off" if "off" in found.limits else found.limits[-1]
    first = [_same_loads(found, off), _rests(found, off), _in_iterations(found), _made(found)]
    return [*first, *size_page.sentences(found)]


def _law(found: Map) -> list[str]:
    raw, scaled = pairs(found.rows), pairs(found.rows, raw=False)
    far = exceptions(raw)
    lines = [law_sentence(raw, "Raw"), law_sentence(scaled, "Block Jacobi"), ""]
    kept = [p for p in raw if not p.by_log]
    lines.append(
        f"In {len(kept)} pairs contact does not make the log's largest eigenvalue (cond less than"
        f" {MADE:g} times that without contact): the law says nothing of them. In"
        f" {sum(p.by_log and not p.by_contact for p in raw)} it makes the log's but not the shape's, whose"
        " cond is that without contact: the floor."
    )
    lines += [
        "",
        (
            f"Made by contact in the log, and farther than a factor {FAR:g} from the law with its floor:"
            f" {len(far)} of {len(raw) - len(kept)}."
        ),
    ]
    return lines + [
        "",
        *_listed(far, lambda p: f"predicted {p.floored:.3g}, measured {p.measured:.3g}; {reason(p)}"),
    ]


def _listed(found: list, text) -> list[str]:
    more = [f"- and {len(found) - MOST} more, in gap_law.csv beside the figures"] if len(found) > MOST else []
    return [f"- {p.name}: {text(p)}" for p in found[:MOST]] + more


def _of(found: Map, key: str) -> str:
    return ", ".join(sorted({source[key] for source in found.about["sources"]}))


def _not_run(found: Map, n: dict, refused: bool) -> list[str]:
    """How much of the map is not there yet; n: counts of its rows."""
    if not n[NOT_RUN]:
        return []
    return [
        (
            f"**{n[NOT_RUN]} of {n['cells']} cells are not run yet**"
            f"{'.' if refused else ': `./bench study gap-map` goes on.'} By scene, runs that are there of"
            f" those that can be: {extent(found.rows)}. Every number below is of the runs that are there."
        ),
        "",
    ]


def _refused(refused: Kept | None) -> list[str]:
    """What another call would make of the runs of this page."""
    if refused is None or not refused.refused:
        return []
    counts = "no longer counts all of these" if refused.counted else "counts none of these"
    return [
        (
            f"**A call that collects runs {counts}**: it refuses {refused.why}. It does not write over them"
            " unless it is told so (`--drop`); with `--results DIR` it makes a map of its own. The numbers of"
            " this page are of the programs that are named below; `./bench study gap-map --no-run` writes it"
            " anew from what is kept, where no record of a run of the map is there."
        ),
        "",
    ]


def _head(found: Map, sorted_out: Kept | None) -> list[str]:
    """What was run, by what, and what the numbers are."""
    about, n = found.about, counts(found.rows)
    refused = sorted_out is not None and bool(sorted_out.refused)
    hours = sum(r["seconds"] or 0 for r in found.rows) / 3600
    low, high = about["unknowns"]
    lines = ["# Gap map", "", f"{about['doc']}.", "", *_not_run(found, n, refused)]
    lines += _refused(sorted_out)
    lines += [
        (
            f"{n['cells']} cells, {about['runs']} runs of {low} to {high} unknowns, {hours:.2g} h of one core"
            f" in all, diagnosis and calibration runs included. {n['ok']} reached a gap; {n[CANNOT]} {CANNOT}"
            f" (theta beyond the peak of the force), {n[NO_CONTACT]} {NO_CONTACT}, {n['failed']} failed,"
            f" {n[NOT_RUN]} {NOT_RUN}. {sum(r[UNKNOWN] or 0 for r in found.rows)} estimates of condition"
            f" numbers in contact have no number and are in no percentile. {_of(found, 'date')};"
            f" {_of(found, 'machine')}; build {_of(found, 'build')}."
        ),
        "",
        (
            f"Made by `{renewed(about['command'])}` (spec sha256 {about['spec_sha256'][:16]}). The gap is the"
            " load-weighted median of d/d_hat at converged step ends; theta, the target, is where the"
            " largest load of the calibration run would rest. Raw and block Jacobi are 95th percentiles of"
            " cond over iterations in contact. A number is a geometric mean over scenes, the resolutions of a"
            " scene averaged first, with its 95% interval (Student's t over scenes)."
            f"{counted_once(about['scenes'])} A place is a scene at a resolution. Rows that stand together"
            " are of the same places: those in which every shape of them, and the log, got through; a shape"
            " that did so in half of its places or fewer is named and not compared."
        ),
        "",
    ]
    return lines + _company(about, refused)


def _company(about: dict, refused: bool) -> list[str]:
    """Other studies of the same, and the builds of this one."""
    lines = [
        "Claims and ablation measure some of these ratios under other conditions: [One quantity, several"
        " studies](../docs/results/several-studies.md).",
        "",
    ]
    if len(builds := {source["build"] for source in about["sources"]}) > 1:
        lines += [
            (
                f"The runs are of {len(builds)} builds of the program"
                + ("." if refused else ": their settings and the meaning of their records are those of now.")
            ),
            "",
        ]
    return lines


def _tail(found: Map) -> list[str]:
    """Targets and cells without a gap, and the law."""
    never = _never(found)
    lines = [
        (
            "Targets that no path comes down to, or starts above:"
            if never
            else "Every target lies on some path of every shape."
        ),
        "",
        *never,
        "",
    ]
    lines += ["## Cells without a gap", "", *_failed(found), "", *skips.lines(skips.skips_of(found.rows))]
    lines += [
        "## The area law",
        "",
        "![predicted against measured](../docs/gap_law.png)",
        "",
        (
            "Every shape is in the numbers; the other shapes are drawn in"
            " [gap_law_more](../docs/gap_law_more.png)."
            if len(found.shapes) - 1 > len(found.main)
            else ""
        ),
        "",
        *_law(found),
        "",
    ]
    return lines


def markdown(found: Map, sorted_out: Kept | None = None) -> str:
    """sorted_out: which of its runs count for the spec as it is now; None: all."""
    lines = _head(found, sorted_out)
    lines += ["## What a reader keeps", "", *(f"{k}. {s}" for k, s in enumerate(sentences(found), 1)), ""]
    lines += ["![the gap map](../docs/gap_map.png)", ""]
    for title, head, beside in (
        ("Under the same loads", "theta", at_theta),
        ("At equal reached gap", "reached gap", at_gap),
    ):
        lines += [f"## {title}", ""]
        for limit in found.limits:
            lines += [
                f"### {title}, {TITLES[limit]}",
                "",
                f"{LIMITS[limit][0].upper()}{LIMITS[limit][1:]}.",
                "",
                *_table(found, limit, head, beside),
                "",
            ]
    lines += size_page.pair_section(found) + size_page.section(found)
    lines += [
        "## Who reaches which gap",
        "",
        "Smallest reached gap: median over the places that all shapes of a column share (smallest to"
        " largest).",
        "",
        *_ends(found),
        "",
    ]
    lines += _tail(found)
    return "\n".join(lines) + "\n"

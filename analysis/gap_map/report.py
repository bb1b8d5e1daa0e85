"""results/GAP_MAP.md, made of gap_map.json."""

from __future__ import annotations

from ..text_table import markdown as table_lines
from .figure import TITLES, law_sentence
from .judge import (
    FAR,
    MADE,
    Ratio,
    at_target,
    at_theta,
    counts,
    deepest,
    end_of,
    exceptions,
    extent,
    failures,
    pairs,
    ratio_at,
    reason,
    unreached,
)
from .rows import CANNOT, NO_CONTACT, NOT_RUN, UNKNOWN
from .spec import LIMITS, REFERENCE
from .table import Map

METRICS = (("cond_p95", "raw"), ("bj_p95", "block Jacobi"), ("pcg", "PCG"), ("newton", "Newton"))
MOST = 40  # exceptions that the page lists one by one; all are in the table of gap_law.csv


def _share(r: Ratio | None) -> str:
    return "nobody" if r is None else f"{r.value:.3g} [{r.low:.3g}, {r.high:.3g}] {r.n}/{r.of}"


def _others(found: Map) -> list[str]:
    return [s for s in found.shapes if s != REFERENCE]


def _table(found: Map, limit: str, head: str, ratio) -> list[str]:
    rows = []
    for gap in found.gaps:
        for shape in _others(found):
            ratios = [ratio(found.rows, limit, shape, metric, gap) for metric, _ in METRICS]
            if any(ratios):
                rows.append([f"{gap:g}", f"`{shape}`", *map(_share, ratios)])
    return table_lines([head, "shape", *(f"{title} over the log's" for _, title in METRICS)], rows)


def _ends(found: Map) -> list[str]:
    rows = []
    for shape in found.shapes:
        cells = []
        for limit in found.limits:
            places, end = deepest(found.rows, limit, shape), end_of(found.rows, limit, shape)
            cells.append(
                "no run reached a gap"
                if end is None
                else (
                    f"{end[0]:.3g} ({min(places.values()):.3g} to {max(places.values()):.3g},"
                    f" {end[1]} places)"
                )
            )
        rows.append([f"`{shape}`", *cells])
    return table_lines(["shape", *(TITLES[m] for m in found.limits)], rows)


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


def _words(of: dict[str, Ratio]) -> str:
    return ", ".join(
        f"`{s}` {r.value:.2g} [{r.low:.2g}, {r.high:.2g}]"
        for s, r in sorted(of.items(), key=lambda item: item[1].value)
    )


def _rests(found: Map, limit: str) -> str:
    """Where contact rests at the smallest target, over the places that all shapes named there reached."""
    theta = min(found.gaps)
    gaps, shared, without = at_target(found.rows, limit, theta, found.shapes)
    asked = f"Asked for {theta:g} d_hat at the largest load, with {TITLES[limit]}, "
    if not gaps:
        return f"{asked}there is no place where every shape that reached a gap has one."
    named = ", ".join(
        f"{gap:.2g} (`{shape}`)" for shape, gap in sorted(gaps.items(), key=lambda item: item[1])
    )
    text = (
        f"{asked}the contact that bears the median load rests at {named} (median of the {len(shared)} scenes"
        " and resolutions that all of these reached)"
    )
    return text + (
        f"; without a gap there: {', '.join(f'`{shape}`' for shape in without)}." if without else "."
    )


def _same_loads(found: Map, limit: str) -> str:
    """Raw condition numbers over the log's at the largest and the smallest theta, of the shapes that have one
    in half of the scenes.
    """
    parts = []
    for theta in (max(found.gaps), min(found.gaps)):
        of = {
            s: r
            for s in _others(found)
            if (r := at_theta(found.rows, limit, s, "cond_p95", theta)) is not None and 2 * r.n >= r.of
        }
        parts.append(
            f"at theta {theta:g} "
            + (_words(of) if of else "no shape got through beside it in half of the scenes")
        )
    return (
        f"With {TITLES[limit]} and under the same loads, raw condition numbers over the log's are"
        f" {'; '.join(parts)}."
    )


def _in_iterations(found: Map) -> str:
    """How far a shape moves each number in each limit mode, and how often contact makes the log's largest
    eigenvalue.
    """
    spans = []
    for limit in found.limits:
        of = [
            [
                r.value
                for s in _others(found)
                for gap in found.gaps
                if (r := at_theta(found.rows, limit, s, metric, gap)) is not None and 2 * r.n >= r.of
            ]
            for metric, _ in METRICS[:3]
        ]
        made = [p for p in pairs(found.rows) if p.row["limit"] == limit]
        spans.append(
            f"{TITLES[limit]}: "
            + ", ".join(f"{title} {min(v):.2g} to {max(v):.2g}" for (_, title), v in zip(METRICS, of) if v)
            + ", and contact makes the log's largest eigenvalue at step ends in"
            f" {sum(p.by_log for p in made)} of {len(made)} pairs"
        )
    return (
        "What of this arrives in iterations, as ratios to the log's, smallest to largest over all shapes"
        f" and targets: {'; '.join(spans)}."
    )


def sentences(found: Map) -> list[str]:
    """What a reader keeps: three sentences, each computed from the rows."""
    off = "off" if "off" in found.limits else found.limits[-1]
    return [_same_loads(found, off), _rests(found, off), _in_iterations(found)]


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


def _not_run(found: Map, n: dict) -> list[str]:
    """How much of the map is not there yet; n: counts of its rows."""
    if not n[NOT_RUN]:
        return []
    return [
        (
            f"**{n[NOT_RUN]} of {n['cells']} cells are not run yet**: `./bench gap-map` goes on. By"
            f" scene, runs that are there of those that can be: {extent(found.rows)}. Every number below"
            " is of the runs that are there."
        ),
        "",
    ]


def _head(found: Map) -> list[str]:
    """What was run, by what, and what the numbers are."""
    about, n = found.about, counts(found.rows)
    hours = sum(r["seconds"] or 0 for r in found.rows) / 3600
    low, high = about["unknowns"]
    lines = ["# Gap map", "", f"{about['doc']}.", "", *_not_run(found, n)]
    lines += [
        (
            f"{n['cells']} cells, {about['runs']} runs of {low} to {high} unknowns, {hours:.2g} h of one core"
            f" in all, diagnosis and pilots included. {n['ok']} reached a gap; {n[CANNOT]} {CANNOT} (theta"
            f" beyond the peak of the force), {n[NO_CONTACT]} {NO_CONTACT}, {n['failed']} failed,"
            f" {n[NOT_RUN]} {NOT_RUN}. {sum(r[UNKNOWN] or 0 for r in found.rows)} estimates of condition"
            f" numbers in contact have no number and are in no percentile. {_of(found, 'date')};"
            f" {_of(found, 'machine')}; build {_of(found, 'build')}."
        ),
        "",
        (
            f"Made by `{about['command']}` (spec sha256 {about['spec_sha256'][:16]}). The gap is the"
            " load-weighted median of d/d_hat at converged step ends; theta, the target, is where the"
            " largest load of the pilot would rest. Raw and block Jacobi are 95th percentiles of cond over"
            " iterations in contact. A number is a geometric mean over scenes, [smallest, largest scene],"
            " scenes that have both of all."
        ),
        "",
    ]
    if len(builds := {source["build"] for source in about["sources"]}) > 1:
        lines += [
            (
                f"The runs are of {len(builds)} builds of the program: a row counts as long as its settings"
                " and the meaning of its record are those of now."
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
    lines += ["## Cells without a gap", "", *_failed(found), ""]
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


def markdown(found: Map) -> str:
    lines = _head(found)
    lines += ["## What a reader keeps", "", *(f"{k}. {s}" for k, s in enumerate(sentences(found), 1)), ""]
    lines += ["![the gap map](../docs/gap_map.png)", ""]
    for title, head, ratio in (
        ("Under the same loads", "theta", at_theta),
        ("At equal reached gap", "reached gap", ratio_at),
    ):
        lines += [f"## {title}", ""]
        for limit in found.limits:
            lines += [
                f"### {title}, {TITLES[limit]}",
                "",
                f"{LIMITS[limit][0].upper()}{LIMITS[limit][1:]}.",
                "",
                *_table(found, limit, head, ratio),
                "",
            ]
    lines += [
        "## Who reaches which gap",
        "",
        "Smallest reached gap: median over scenes and resolutions (smallest to largest).",
        "",
        *_ends(found),
        "",
    ]
    lines += _tail(found)
    return "\n".join(lines) + "\n"

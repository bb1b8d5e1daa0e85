"""What the page of a gap map is filled with (configs/studies/gap_map.md)."""

from collections import Counter

from barrierbench_analysis.io.record_file import other_meanings
from barrierbench_analysis.io.text_table import markdown
from barrierbench_analysis.studies.kit.study.spec import Study
from barrierbench_analysis.studies.kit.study.store import Row

from . import size_tables, skips
from .compare import METRICS, Beside, Common, at_gap, at_theta, counted_once, deepest, middles
from .law import FAR, MADE, exceptions, failures, made_by_contact, pairs, reason, unreached
from .law import sentences as law_sentences
from .measured import READ, UNKNOWN
from .size import LIMIT
from .spec import LIMITS, REFERENCE
from .table import Map, map_of

TITLES = {"on": "limit on", "contact": "limit the same in every run", "off": "no strain limit"}
NAMES = {"cond_p95": "raw", "bj_p95": "block Jacobi", "pcg": "PCG", "newton": "Newton"}
MOST = 40  # exceptions that the page lists one by one; all are in the table of gap_law.csv


def _others(found: Map) -> list[str]:
    return [shape for shape in found.shapes if shape != REFERENCE]


def _left_out(cut: Common) -> str:
    return ", ".join(f"`{shape}` ({n} of {of})" for shape, (n, of) in cut.left_out.items())


def beside_table(found: Map, limit: str, head: str, beside) -> list[str]:
    """A row a shape; the rows of one target are of the same places, which the last column names."""
    rows = []
    for gap in found.gaps:
        here: Beside = beside(found.rows, limit, gap, _others(found))
        for shape, ratios in here.ratios.items():
            rows.append([f"{gap:g}", f"`{shape}`", *(str(ratios[m]) for m in METRICS), here.cut.words])
        if here.cut.left_out:
            rows.append([f"{gap:g}", f"not compared: {_left_out(here.cut)}", *[""] * (len(METRICS) + 1)])
    columns = [f"{NAMES[metric]} over the log's" for metric in METRICS]
    return markdown([head, "shape", *columns, "all of these in"], rows)


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
    return markdown(["shape", *(f"{TITLES[limit]}: {cut.words}" for limit, cut in cuts.items())], rows)


def _failed(found: Map) -> list[str]:
    rows = [
        [
            f"`{shape}`",
            TITLES[limit],
            f"{theta:g}",
            ", ".join(f"{word} {n}" for word, n in sorted(ends.items())),
        ]
        for (shape, limit, theta), ends in failures(found.rows).items()
    ]
    return markdown(["shape", "limit", "theta", "runs without a gap"], rows) if rows else []


def _rests(found: Map, limit: str) -> str:
    """Where contact rests at the smallest target, over the places that all shapes named there reached."""
    theta = min(found.gaps)
    cut = deepest(found.rows, limit, found.shapes, theta)
    begin = f"At a target gap of {theta:g} d_hat at the largest load, with {TITLES[limit]}, "
    if not cut.of:
        return f"{begin}there is no place where every shape that reached a gap has one."
    ranked = sorted(middles(cut).items(), key=lambda item: item[1])
    named = ", ".join(f"{gap:.3g} (`{shape}`)" for shape, gap in ranked)
    without = ", ".join(f"`{shape}`" for shape in found.shapes if shape not in cut.of)
    return (
        f"{begin}the contact that bears the median load rests at {named} (median of the {cut.words} that all"
        f" of these reached){without and f'; without a gap in half of the places or more: {without}'}."
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
            first, last = (_ranked(here, metric)[k] for k in (0, -1))
            ends.append(f"{NAMES[metric]} {first[1]} ({first[0]}) to {last[1]} ({last[0]})")
        left = f"; not compared: {_left_out(here.cut)}" if here.cut.left_out else ""
        spans.append(f"{TITLES[limit]} ({here.cut.words}{left}): {', '.join(ends)}")
    return (
        f"What of this arrives in iterations at theta {theta:g}: over the log's, the smallest and the largest"
        f" of the shapes' means over scenes (single scenes lie farther out): {'; '.join(spans)}."
    )


def _made(found: Map) -> str:
    """How often contact is what makes a condition number."""
    counts = {limit: made_by_contact(found.rows, limit) for limit in found.limits}
    parts = [f"{made} of {n} ({TITLES[limit]})" for limit, (made, n) in counts.items()]
    return (
        f"Contact makes the log's largest eigenvalue at step ends (cond at least {MADE:g} times that without"
        f" contact) in {', '.join(parts)} of its runs."
    )


def sentences(found: Map) -> list[str]:
    """What a reader keeps, each sentence computed from the rows."""
    off = "off" if "off" in found.limits else found.limits[-1]
    first = [_same_loads(found, off), _rests(found, off), _in_iterations(found), _made(found)]
    return [*first, *size_tables.sentences(found)]


def _law(found: Map) -> dict:
    raw, far = pairs(found.rows), exceptions(pairs(found.rows))
    listed = [
        f"- {p.name}: predicted {p.floored:.3g}, measured {p.measured:.3g}; {reason(p)}" for p in far[:MOST]
    ]
    if len(far) > MOST:
        listed.append(f"- and {len(far) - MOST} more, in gap_law.csv beside the figures")
    return {
        "law": law_sentences(found.rows),
        "by_log": sum(p.by_log for p in raw),
        "without": sum(not p.by_log for p in raw),
        "log_alone": sum(p.by_log and not p.by_contact for p in raw),
        "far": len(far),
        "exceptions": "\n".join(listed),
        "MADE": f"{MADE:g}",
        "FAR": f"{FAR:g}",
    }


def other_records(rows: list[Row]) -> str:
    """Rows of records in which fields mean something else than in those of now: how many, of which version,
    and which of the fields the map reads; empty without such rows.
    """
    parts = []
    for version, n in Counter(row.origin.get("version") for row in rows).items():
        if version and (changed := other_meanings(version)):
            since = ", ".join(sorted({change["since"] for change in changed.values()}))
            read = ", ".join(f"`{field}`" for field in READ if field in changed)
            parts.append(
                f"{n} with records {version}, in which {len(changed)} fields mean something else than in"
                f" records from {since} on; of these fields the map reads {read or 'none'}"
            )
    return "; ".join(parts)


def rule(study: Study, rows: list[Row]) -> dict:
    """The numbers of the page."""
    found = map_of(study, rows)
    low, high = found.unknowns

    def of_limits(head: str, beside) -> list[dict]:
        return [
            {
                "title": TITLES[limit],
                "what": f"{LIMITS[limit][0].upper()}{LIMITS[limit][1:]}.",
                "table": "\n".join(beside_table(found, limit, head, beside)),
            }
            for limit in found.limits
        ]

    return {
        "map": found,
        "n": found.counts(),
        "extent": found.extent(),
        "other_records": other_records(rows),
        "unknowns": f"{low} to {high}",
        "runs": len(rows),
        "hours": f"{sum(row.seconds for row in rows) / 3600:.2g}",
        "without_number": sum(row[UNKNOWN] or 0 for row in found.made),
        **{key: ", ".join(sorted({row.origin[key] for row in rows})) for key in ("date", "machine", "build")},
        "builds": len({row.origin["build"] for row in rows}),
        "counted_once": counted_once(found.scenes),
        "sentences": sentences(found),
        "same_loads": of_limits("theta", at_theta),
        "equal_gap": of_limits("reached gap", at_gap),
        "pair_title": size_tables.PAIR_TITLE,
        "pair_table": "\n".join(size_tables.pair_table(found)),
        "size_title": size_tables.SIZE_TITLE,
        "size_table": "\n".join(size_tables.size_table(found)),
        "size_failed": size_tables.failed(found) or "none",
        "slope_table": "\n".join(size_tables.slope_table(found)),
        "slopes": size_tables.slope_numbers(found),
        "limit_of_size": LIMIT,
        "ends": "\n".join(_ends(found)),
        "never": [
            f"- {TITLES[limit]}, `{shape}`: {', '.join(f'{gap:g}' for gap in gaps)}"
            for (limit, shape), gaps in unreached(found.rows, found.gaps).items()
        ],
        "failed": "\n".join(_failed(found)),
        "skips": "\n".join(skips.table(found.rows)),
        "more": len(found.shapes) - 1 > len(found.main),
        **_law(found),
    }

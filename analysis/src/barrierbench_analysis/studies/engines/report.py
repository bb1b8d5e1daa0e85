"""The page of a record of ./bench engine compare."""

from __future__ import annotations

from barrierbench_analysis.io.text_table import markdown

from .compare import NAME, OURS
from .level import equal
from .scatter import depth_of, number
from .starts_page import of_scene, of_variant, rules

HEAD = [
    "engine", "dt, ms", "outcome", "s", "it/step", "verdict", "frames crossing", "frames in obstacles",
    "depth, mm", "passages", "error, %", "stretch", "gained, J", "end, J",
]  # fmt: skip


def _row(row: dict) -> list[str]:
    judged = "verdict" in row and row["verdict"] != "not_judged"
    return [
        f"{row['engine']} {row['variant']}",
        number(row.get("dt_s"), 1e3),
        row["outcome"],
        number(row.get("seconds")),
        number(row.get("iterations_a_step")),
        row.get("verdict", ""),
        str(row.get("frames_crossing", "")),
        str(row.get("frames_in_obstacles", "")),
        number(depth_of(row), 1e3) if judged else "",
        str(row.get("passages", "")),
        number(row.get("error_mean"), 100),
        number(row.get("stretch_most")),
        number(row.get("energy_most_J")),
        number(row.get("energy_last_J")),
    ]


def _left(fitted: dict) -> list[str]:
    """What material tests leave, of every engine, in one line each."""
    lines = []
    for label, fit in fitted.items():
        if "left" not in fit:
            lines.append(f"- {label}: {fit['outcome']}: {fit['failed']}")
            continue
        factors = ", ".join(f"{name} {value:.3g}" for name, value in fit["factors"].items())
        left = ", ".join(f"{name} {100 * value:+.2g} %" for name, value in fit["left"].items())
        lines.append(f"- {label}: {factors}; left: {left}")
    return lines


def _short_left(fitted: dict) -> str:
    """The largest that is left of each engine, for beside a table."""
    words = []
    for label, fit in fitted.items():
        left = fit.get("left")
        worst = max(left, key=lambda name: abs(left[name])) if left else None
        words.append(f"{label} {100 * left[worst]:+.2g} % ({worst})" if left else f"{label} {fit['outcome']}")
    return "; ".join(words)


def _touched(rows: list[dict]) -> list[str]:
    """How many contacts our runs had, where they were counted: without any nothing was promised."""
    counts = [row["notes"]["contacts_most"] for row in rows if "contacts_most" in row.get("notes", {})]
    if not counts:
        return []
    if max(counts) == 0:
        return ["Nothing touches in our runs: of contact this scene says nothing.", ""]
    return [f"Contacts at a step end in our runs: up to {max(counts)}.", ""]


def _scene(one: dict, fitted: dict) -> list[str]:
    apart = one["reference_apart"]
    known = apart.get("error_mean")
    lines = [
        f"## {one['scene']}",
        "",
        f"{one['vertices']} vertices, {one['triangles']} triangles, {one['frames']} frames of"
        f" {1e3 * one['frame_s']:g} ms. The reference and one of twice its time step are"
        f" {number(known, 100) or '?'} % apart. Materials, the largest that is left: {_short_left(fitted)}.",
        "",
        *_touched(one["rows"]),
        *markdown(HEAD, [_row(row) for row in one["rows"]]),
        "",
    ]
    rows = equal(one["rows"], OURS)
    if rows:
        shown = [
            [f"{r['engine']} {r['variant']}", number(r["error_at_equal_seconds"], 100) or "-",
             number(r["seconds_at_equal_error"]) or "-"]
            for r in rows
        ]  # fmt: skip
        head = ["engine", "error, %, in the seconds of our first level", "s, at the error of our first level"]
        lines += [*markdown(head, shown), ""]
    lines += of_scene(one)
    failed = [row for row in one["rows"] if row["outcome"] != "ok"]
    lines += [f"- {row['engine']} {row['variant']}: {row['outcome']}: {row['detail']}" for row in failed]
    return [*lines, ""] if failed else lines


def _seen(record: dict) -> list[str]:
    """Beside each promise what the judge found in all scenes."""
    lines = []
    for name, promise in record["guarantees"].items():
        lines.append(
            f"- **{name} {record['versions'][name]}** promises: {promise['words']} ({promise['citation']})"
        )
        rows = [row for one in record["scenes"] for row in one["rows"] if row["engine"] == name]
        for variant in dict.fromkeys(row["variant"] for row in rows):
            own = [row for row in rows if row["variant"] == variant]
            ran = [row for row in own if row["outcome"] == "ok"]
            count = lambda key, ran=ran: sum(row.get(key, 0) > 0 for row in ran)  # noqa: E731
            lines.append(
                f"  - {variant}: {len(ran)} of {len(own)} runs ended ok;"
                f" {count('frames_crossing')} with surfaces that cross in a frame,"
                f" {count('frames_in_obstacles')} with surfaces in an obstacle,"
                f" {count('passages')} with a passage between frames, on straight lines"
            )
            lines += of_variant(record, name, variant)
    return lines


def text_of(record: dict) -> str:
    name = record["spec"].get("name", NAME)
    lines = [
        "# Engines of others" + (f": {name.removeprefix('engines_')}" if name != NAME else ""),
        "",
        f"Made by `{record.get('command', './bench engine compare')}`;"
        " [docs/guides/engines.md](../docs/guides/engines.md) says what is compared.",
        "Error: distance of vertices from our refined reference, root mean square over vertices and frames,"
        " in widths of the scene. Depth: the largest in an obstacle or a closed body. Gained: the most of"
        " kinetic energy and that of gravity above the start; end: what is left of it. Seconds are those of"
        " steps, without start and compilation, on one machine that did other things too.",
        "",
        *rules(record),
        f"![Error against seconds](../docs/{name}.png)",
        "",
        "## What was promised, and what was seen",
        "",
        *_seen(record),
        "",
        "## Materials",
        "",
        "Factors that the tests fitted, and how far the tests are apart after it: far ends in the tensile"
        " tests (`warp`, `weft`, `bias`) and the bending test, relative to ours; `narrowing`: change of width"
        " of `warp`; `drape`: root mean square distance, in widths of the sheet.",
        "",
        *_left(record["material_left"]),
        "",
    ]
    for one in record["scenes"]:
        lines += _scene(one, record["material_left"])
    return "\n".join(lines).rstrip() + "\n"

"""What the page of a record says of jittered starts; nothing where a record has none."""

from __future__ import annotations

from barrierbench_analysis.io.text_table import markdown

from .scatter import number, ranged, scatter
from .starts import without_starts

HEAD = [
    "engine", "dt, ms", "ended ok", "error, %", "depth, mm", "cross in a frame", "in an obstacle",
    "pass between frames",
]  # fmt: skip


def rules(record: dict) -> list[str]:
    """How starts were made, and what was left out."""
    if not any(one.get("starts") for one in record["scenes"]):
        return []
    rule = record["spec"]["starts"]
    text = (
        f"Scatter: `{record['command_of_starts']}`. Start k moves each coordinate of vertices that are not"
        f" held by a uniform number in [-{rule['jitter_m']:g}, {rule['jitter_m']:g}] m of seed k, the same"
        " for every engine and for the reference. Seconds, energies and stretch are those of the scene's own"
        " start: jittered runs shared the machine with other work, so their seconds are not kept."
    )
    if "few" in rule:
        why = [f"take more than {rule['few_above_s']:g} s"] if "few_above_s" in rule else []
        if "few_above_error" in rule:
            why.append(f"end more than {rule['few_above_error']:g} widths from the reference")
        made = f"made from {rule['few']} starts alone" if rule["few"] else "not made again"
        text += f" Runs that from the own start {' or '.join(why)} were {made}."
    if left := without_starts(record["spec"]):
        text += f" Of their own start alone are {', '.join(left)}."
    return [text, ""]


def of_variant(record: dict, name: str, variant: str) -> list[str]:
    """What the judge found in the jittered runs of a variant, for below its promise."""
    found = [s for one in record["scenes"] for who, s in scatter(one).items() if who[:2] == (name, variant)]
    if not found:
        return []
    total = {key: sum(s[key] for s in found) for key in ("starts", "ok", "crossing", "inside", "passing")}
    return [
        f"    from jittered starts: {total['ok']} of {total['starts']} ended ok; {total['crossing']} with"
        f" surfaces that cross in a frame, {total['inside']} with surfaces in an obstacle,"
        f" {total['passing']} with a passage"
    ]


def of_scene(one: dict) -> list[str]:
    """The table of a scene."""
    found = scatter(one)
    if not found:
        return []
    steps = {(row["engine"], row["variant"], row["level"]): row.get("dt_s") for row in one["rows"]}
    shown = []
    for who, s in found.items():
        many = [f"{s[key]} of {s['judged']}" for key in ("crossing", "inside", "passing")]
        spread = [ranged(s["error"], 100), ranged(s["depth"], 1e3)]
        ended = f"{s['ok']} of {s['starts']}"
        shown.append([f"{who[0]} {who[1]}", number(steps.get(who), 1e3), ended, *spread, *many])
    line = f"From {len(one['starts'])} jittered starts, each against our reference of that start:"
    line += " median (least to most)."
    if far := one.get("references_apart"):
        line += f" The references of the other {len(far)} are {number(min(far), 100)} to"
        line += f" {number(max(far), 100)} % from that of the first."
    return [line, "", *markdown(HEAD, shown), ""]

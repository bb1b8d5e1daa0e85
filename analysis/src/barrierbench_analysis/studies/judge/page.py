"""The page of a judgement: one HTML file that needs no network."""

from __future__ import annotations

import base64
import io
from html import escape
from pathlib import Path
from string import Template

import numpy as np

from barrierbench_analysis.figures.style import NARROW_IN, WIDE_IN, plt
from barrierbench_analysis.io import input_file

from .verdict import meaning

HERE = Path(__file__).resolve().parent
MOST_ROWS = 200  # of findings on the page; the record has all


def table(caption: str, head: list[str], rows: list[list]) -> str:
    """Numbers are aligned to the right."""

    def cell(value) -> str:
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        text = f"{value:.4g}" if isinstance(value, float) else "" if value is None else str(value)
        return f"<td{' class=n' if number else ''}>{escape(text)}</td>"

    heads = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    body = "\n".join(f"<tr>{''.join(map(cell, row))}</tr>" for row in rows)
    top = f"<caption>{escape(caption)}</caption><thead><tr>{heads}</tr></thead>"
    return f"<table>{top}<tbody>\n{body}\n</tbody></table>"


def _findings(record: dict) -> str:
    rows = record["findings"]
    if not rows:
        return "<p>Nothing was found.</p>"
    shown = rows[:MOST_ROWS]
    more = f"; the first {MOST_ROWS} of {len(rows)}" if len(rows) > MOST_ROWS else ""
    return table(
        f"What was found, frame by frame{more}",
        ["frame", "what", "how often", "a pair", "depth (m)"],
        [[row["frame"], row["what"], row["count"], row["pair"], row["depth_m"]] for row in shown],
    )


def _judged(record: dict) -> str:
    total = record["total"]
    closed = ", ".join(total["closed_bodies"]) or "no body is closed"
    rows = [
        ["frames", total["frames"], ""],
        ["triangles", total["triangles"], ""],
        ["edges", total["edges"], "of triangles, and rods"],
        ["vertices", total["vertices"], ""],
        ["obstacles", total["obstacles"], "analytic"],
        ["pairs in states", total["state_pairs"], "edge and triangle; boxes prove all others apart"],
        ["pairs in motions", total["motion_pairs"], "vertex and triangle, edge and edge"],
        ["primitives at obstacles", total["obstacle_queries"], ""],
        ["vertices against closed bodies", total["sides_asked"], closed],
        ["touches", total["touches"], "at distance 0, and an infinitely small displacement parts them"],
        ["motions not proven", total["unproven"], ""],
        ["seconds of the audit", total["audit_s"], ""],
        ["seconds of reading", record["reading_s"], record["trajectory"]["format"]],
    ]  # fmt: skip
    return table("What was judged", ["subject", "number", ""], rows)


def _series(record: dict, key: str) -> np.ndarray:
    values = [frame.get(key) for frame in record["frames"]]
    return np.array([np.nan if value is None else value for value in values])


def _crosses(frame: dict) -> bool:
    return frame["crossings"] + frame["obstacle_violations"] + frame.get("changed_sides", 0) > 0


def figure_of(record: dict) -> str:
    """Smallest gaps of each frame, with marks where something crosses, and all vertices by their gap."""
    times = record["trajectory"]["times_s"]
    across = np.arange(len(record["frames"])) if times is None else np.array(times)
    bad = np.array([_crosses(frame) for frame in record["frames"]])
    figure, (left, right) = plt.subplots(1, 2, figsize=(WIDE_IN, NARROW_IN * 0.8), layout="constrained")
    for key, word, dash in (
        ("gap_between_m", "between surfaces", "-"),
        ("gap_obstacles_m", "to obstacles", "--"),
    ):
        gap = _series(record, key)
        if np.isfinite(gap).any():
            left.plot(across, gap, dash, marker="." if len(gap) < 60 else None, label=word)
    for k, at in enumerate(across[bad]):
        left.axvline(at, color="#d55e00", lw=0.8, zorder=0, label="something crosses" if k == 0 else None)
    left.set_xlabel("frame" if times is None else "time (s)")
    left.set_ylabel(f"smallest gap (m), of those below {record['reach_m']:.3g} m")
    if left.get_legend_handles_labels()[0]:
        left.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    bins = [b for b in record["total"]["gap_histogram"] if b["from_m"] is not None]
    edges = np.array([b["from_m"] for b in bins])
    right.bar(edges, [b["vertices"] for b in bins], width=edges * (10**0.25 - 1), align="edge")
    right.set_xscale("log")
    right.set_xlabel("gap of a vertex to the closest triangle (m)")
    right.set_ylabel("vertices, over all frames")
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=160)
    plt.close(figure)
    alt = "Left: smallest gaps over the frames. Right: histogram of the gaps of all vertices."
    data = base64.b64encode(out.getvalue()).decode()
    return f'<figure><img alt="{alt}" src="data:image/png;base64,{data}"></figure>'


def page_of(record: dict) -> str:
    notes = "".join(f"<p><strong>Note:</strong> {escape(note)}.</p>" for note in record["notes"])
    word, text = record["verdict"], meaning(record)
    return Template(input_file.read_text(HERE / "page.html")).substitute(
        verdict=escape(word.replace("_", " ")),
        source=escape(record["trajectory"]["source"]),
        meaning=escape(text[0].upper() + text[1:]),
        notes=notes,
        findings=_findings(record),
        figure=figure_of(record),
        judged=_judged(record),
        command=escape(record["command"]),
        **{"class": "clean" if word == "clean" else "not"},
    )

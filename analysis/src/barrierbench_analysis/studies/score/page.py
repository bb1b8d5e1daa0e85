"""The page of a score: one HTML file that needs no network."""

from __future__ import annotations

import base64
import io
from html import escape
from pathlib import Path
from string import Template

from barrierbench_analysis.figures.style import WIDE_IN, plt
from barrierbench_analysis.io import input_file
from barrierbench_analysis.studies.judge.page import table

from .candidate import RIVALS
from .judge import METRICS, at_equal_gap, comparisons, row_times, value

HERE = Path(__file__).resolve().parent
SHOWN = ("newton", "pcg", "cond_p95")  # of the figure
MARKS = ("*", "x", "+", "1", "2")  # the candidate first


def page(score: dict) -> str:
    """score: what score.json holds."""
    label, rows = score["candidate"]["label"], score["rows"]
    return Template(input_file.read_text(HERE / "page.html")).substitute(
        title=escape(label),
        about=escape(score["candidate"]["about"]),
        decides="".join(f"<li>{escape(line)}</li>" for line in score["decides"]),
        figure=_figure(rows, label),
        compared=_compared(rows, label),
        equal=_equal(rows, label),
        times=_times(rows),
        rows=_rows(rows, label),
        starts=_starts(score["starts"]),
        cases=_cases(score["hard_cases"], label),
        command=escape(score["command"]),
        machine=escape(score["machine"]),
        seconds=f"{score['seconds']:.0f}",
    )


def _compared(rows: list[dict], label: str) -> str:
    found = {(one.metric, one.theta, one.rival): one for one in comparisons(rows, label)}
    thetas = sorted({theta for _, theta, _ in found}, reverse=True)
    head = ["", "theta", *(f"over {rival}" for rival in RIVALS)]
    body = []
    for metric, text in METRICS.items():
        for theta in thetas:
            ones = [found.get((metric, theta, rival)) for rival in RIVALS]
            if any(ones):
                body.append(
                    [
                        text,
                        f"{theta:g}",
                        *(
                            "" if one is None else f"{one.ratio:.2f} {one.verdict} ({one.scenes})"
                            for one in ones
                        ),
                    ]
                )
    return table(
        "Candidate over each other, geometric mean over scenes (how many, at least 2); better: 10 % less in"
        " the mean, less in every one",
        head,
        body,
    )


def _equal(rows: list[dict], label: str) -> str:
    body = [
        [
            METRICS[metric],
            f"{gap:g}",
            str(ratio),
            f"{ratio.scenes}",
        ]
        for metric, gap, ratio in at_equal_gap(rows, label)
    ]
    return table(
        "Candidate over log at equal reached gap",
        ["", "gap/d_hat", "ratio [95% over scenes]", "scenes"],
        body,
    )


def _times(rows: list[dict]) -> str:
    body = [[method, ns, runs] for method, (ns, runs) in row_times(rows).items()]
    return table(
        "Nanoseconds of a contact row: barrier, gradient, Hessian", ["method", "median", "runs"], body
    )


def _rows(rows: list[dict], label: str) -> str:
    head = [
        "scene",
        "theta",
        "method",
        "outcome",
        "gap/d_hat",
        "deepest 5 %",
        "Newton",
        "PCG",
        "cond",
        "ns a row",
        "s",
    ]
    order = [label, *RIVALS]
    body = [
        [
            r["scene"],
            f"{r['theta']:g}",
            r["shape"],
            r["outcome"],
            r["gap"],
            r["gap_p05"],
            r["newton"],
            r["pcg"],
            r["cond_p95"],
            r["row_ns"],
            r["seconds"],
        ]
        for r in sorted(rows, key=lambda r: (r["scene"], -r["theta"], order.index(r["shape"])))
    ]
    return table("Every matched run", head, body)


def _starts(starts: list[dict]) -> str:
    body = [
        [
            one["method"],
            f"{one['ok']} of {one['of']}",
            ", ".join(one["others"]),
            " ".join(map(str, one["newton"])),
        ]
        for one in starts
    ]
    return table("Jittered starts", ["method", "ok", "others", "Newton iterations of each"], body)


def _cases(cases: list[dict], label: str) -> str:
    methods = [label, *RIVALS]
    by: dict[tuple[str, str, str], dict[str, str]] = {}
    for case in cases:
        newton = "" if case["newton"] is None else f" ({case['newton']})"
        by.setdefault((case["test"], case["title"], case["case"]), {})[case["method"]] = (
            case["outcome"] + newton
        )
    body = [
        [test, f"{title}, {case}", *(ends.get(method, "") for method in methods)]
        for (test, title, case), ends in by.items()
    ]
    return table("Hard cases: outcome (Newton iterations)", ["test", "what", *methods], body)


def _figure(rows: list[dict], label: str) -> str:
    """Numbers over the reached gap, a line a method and scene's mean."""
    figure, axes = plt.subplots(1, len(SHOWN), figsize=(WIDE_IN, 0.36 * WIDE_IN), layout="constrained")
    for axis, metric in zip(axes, SHOWN, strict=True):
        for k, method in enumerate([label, *RIVALS]):
            points = sorted(
                (r["gap"], value(r, metric))
                for r in rows
                if r["shape"] == method and r["gap"] and value(r, metric)
            )
            if points:
                axis.loglog(
                    *zip(*points, strict=True),
                    MARKS[k],
                    label=method,
                    markersize=9 if k == 0 else 5,
                    linestyle="none",
                )
        axis.set_xlabel("reached gap over d_hat")
        axis.set_title(METRICS[metric].split(",")[0], fontsize=8)
    axes[0].legend(fontsize=7)
    bytes_of = io.BytesIO()
    figure.savefig(bytes_of, format="png", dpi=130)
    plt.close(figure)
    data = base64.b64encode(bytes_of.getvalue()).decode()
    return f'<img alt="Newton iterations, PCG iterations and condition numbers over the reached gap, of {escape(label)} and the others" src="data:image/png;base64,{data}">'

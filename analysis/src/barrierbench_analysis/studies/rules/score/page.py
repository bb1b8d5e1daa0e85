"""The page of a score: one HTML file that needs no network."""

from pathlib import Path

from barrierbench_analysis.figures.style import WIDE_IN, plt, png
from barrierbench_analysis.io.template import filled

from .candidate import RIVALS
from .judge import METRICS, at_equal_gap, comparisons, row_times, value

TEMPLATE = Path(__file__).with_name("page.html")
SHOWN = ("newton", "pcg", "cond_p95")  # of the figure
MARKS = ("*", "x", "+", "1", "2")  # the candidate first
OF_RUN = ("shape", "outcome", "gap", "gap_p05", "newton", "pcg", "cond_p95", "row_ns", "seconds")


def page(score: dict) -> str:
    """score: what score.json holds."""
    label, rows = score["candidate"]["label"], score["rows"]
    methods = [label, *RIVALS]
    ordered = sorted(rows, key=lambda r: (r["scene"], -r["theta"], methods.index(r["shape"])))
    made = dict(
        label=label,
        methods=methods,
        over=[f"over {rival}" for rival in RIVALS],
        figure=_figure(rows, methods),
        compared=_compared(rows, label),
        equal=[[METRICS[m], f"{gap:g}", str(r), f"{r.scenes}"] for m, gap, r in at_equal_gap(rows, label)],
        times=[[method, ns, runs] for method, (ns, runs) in row_times(rows).items()],
        matched=[[r["scene"], f"{r['theta']:g}", *(r[name] for name in OF_RUN)] for r in ordered],
        jittered=[
            [s["method"], f"{s['ok']} of {s['of']}", ", ".join(s["others"]), " ".join(map(str, s["newton"]))]
            for s in score["starts"]
        ],
        cases=_cases(score["hard_cases"], methods),
    )
    return filled(TEMPLATE, score | made)


def _compared(rows: list[dict], label: str) -> list[list]:
    found = {(one.metric, one.theta, one.rival): one for one in comparisons(rows, label)}
    return [
        [
            text,
            f"{theta:g}",
            *(
                f"{one.ratio:.2f} {one.verdict} ({one.scenes})"
                if (one := found.get((metric, theta, rival)))
                else ""
                for rival in RIVALS
            ),
        ]
        for metric, text in METRICS.items()
        for theta in sorted({t for of, t, _ in found if of == metric}, reverse=True)
    ]


def _cases(cases: list[dict], methods: list[str]) -> list[list]:
    by: dict[tuple[str, str], dict[str, str]] = {}
    for case in cases:
        newton = "" if case["newton"] is None else f" ({case['newton']})"
        ends = by.setdefault((case["test"], f"{case['title']}, {case['case']}"), {})
        ends[case["method"]] = case["outcome"] + newton
    return [[*place, *(ends.get(method, "") for method in methods)] for place, ends in by.items()]


def _figure(rows: list[dict], methods: list[str]) -> str:
    """Numbers over the reached gap, a mark a method and scene's mean."""
    figure, axes = plt.subplots(1, len(SHOWN), figsize=(WIDE_IN, 0.36 * WIDE_IN), layout="constrained")
    for axis, metric in zip(axes, SHOWN, strict=True):
        for k, method in enumerate(methods):
            mine = ((r["gap"], value(r, metric)) for r in rows if r["shape"] == method)
            if points := sorted((gap, y) for gap, y in mine if gap and y):
                look = {"markersize": 9 if k == 0 else 5, "linestyle": "none"}
                axis.loglog(*zip(*points, strict=True), MARKS[k], label=method, **look)
        axis.set_xlabel("reached gap over d_hat")
        axis.set_title(METRICS[metric].split(",")[0], fontsize=8)
    axes[0].legend(fontsize=7)
    return png(figure, dpi=130)

"""All figures and the table of a folder of runs."""

import itertools
import multiprocessing
import os
import sys
from collections.abc import Callable
from pathlib import Path

from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program import processes
from barrierbench_analysis.tables.records import Records, load
from barrierbench_analysis.tables.table import as_text, summary_table

from . import answer, barrier_shapes, condition, kappa_cycle, matrix_forms, over_time

MUST_END_OK = ("log", "cubic_dynamic_lagged", "cubic_dynamic_consistent")
LAYERED = ("demo_equal_gap", "demo_drape", "demo_long")  # five layers, each of which has to touch the next
OF_A_GROUP = [  # each draws the runs of one sweep
    condition.figure,
    matrix_forms.figure,
    over_time.iterations,
    over_time.gaps,
    kappa_cycle.figure,
]
_shared: list = []  # records and folder, in a process that draws


def broken_promises(records: Records) -> list[str]:
    """What a demonstration promises and these runs do not keep; other sweeps promise nothing."""
    lines = []
    for _, run in records.runs.iterrows():
        where = f"{run['group']}: {run['series']}"
        if not str(run["group"]).startswith("demo_") or run["group"] == "demo_article":
            continue
        if (
            run["formulation"] in MUST_END_OK
            and run["series"].split()[-1] == run["formulation"]
            and run["outcome"] != "ok"
        ):
            lines.append(f"{where} has to end ok with the audit on, and ended {run['outcome']}")
        if run["group"] in LAYERED and run["outcome"] == "ok":
            layers = sorted(
                name for pair in run["first_contact"] for name in pair.split("|") if name.startswith("layer")
            )
            touching = {f"layer{k}|layer{k + 1}" for k in range(len(set(layers)) - 1)} | {"layer0|sphere"}
            missing = (
                sorted(touching - set(run["first_contact"])) if len(set(layers)) >= 5 else ["five layers"]
            )
            lines += [f"{where} has no contact {pair}" for pair in missing]
    return lines


def _share(records: Records, out: Path) -> None:
    """What the pictures of this process are made of; a process has it of the one that it was forked from."""
    _shared[:] = records, out


def _picture(draw: Callable, group: str) -> list[Path]:
    records, out = _shared
    return draw(records, group, out)


def make_all_of(records: Records, out: Path) -> str:
    """Writes everything to `out`; returns the text for the terminal."""
    groups = sorted(records.runs["group"].unique())
    of, draw = zip(*itertools.product(groups, OF_A_GROUP), strict=True)
    with processes.pool(
        len(os.sched_getaffinity(0)), multiprocessing.get_context("fork"), _share, records, out
    ) as pool:
        shapes = pool.submit(barrier_shapes.figure, out, records.runs)
        beside = pool.submit(answer.figure, records.rows(), out)
        paths = [path for made in pool.map(_picture, draw, of) for path in made]
        paths += shapes.result() + beside.result()
    table = summary_table(records)
    write_whole(out / "table.csv", table.to_csv(index=False))
    failed = records.runs[records.runs["outcome"] != "ok"]
    lines = [as_text(table), ""]
    lines += [
        f"{r['group']}: {r['series']} ended {r['outcome']}: {r['detail']}" for _, r in failed.iterrows()
    ]
    figures = [path for path in paths if path.suffix == ".png"]
    lines += [f"{len(figures)} figures (PNG, PDF, CSV of the plotted numbers, caption TXT) in {out}:"]
    lines += [f"  {path}" for path in figures]
    return "\n".join(lines)


def make(runs: Path, out: Path | None) -> int:
    """Figures and table of the records below a folder; the exit code."""
    records = load(runs)
    print(make_all_of(records, out or runs / "figures"))
    broken = broken_promises(records)
    for line in broken:
        print(f"figures: {line}", file=sys.stderr)
    return 1 if broken else 0

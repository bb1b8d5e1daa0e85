"""results/GPU.md and docs/gpu_kernels.png from the records of cards, results/gpu/*.json.

One row a card. Without a record the page says that nothing was timed. Prices are inputs
(results/gpu/prices.json).
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.figure_files import copy_to_page
from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of

from .gpu_evidence import RECORDS, SCHEMA
from .gpu_tables import (
    LARGE,
    MOST_KERNELS,
    card_rows,
    copy_rate,
    cost_rows,
    counter_rows,
    fallen,
    judged,
    kernel_rows,
    mixes_idle,
    phase_rows,
    plain_runs,
    same_rows,
    scene_rows,
    stage_rows,
)

NEVER = "Correct by emulation, never timed."


def read_records(folder: Path) -> list[dict]:
    """By card, then day. Errors: UserError for a file of another schema; prices.json is none of them."""
    records = []
    for path in sorted(folder.glob("*.json")):
        record = read_object(path)
        if path.name == "prices.json":
            continue
        if record.get("schema") != SCHEMA:
            raise UserError(f"{path}: schema {record.get('schema')!r} instead of {SCHEMA!r}")
        records.append(record)
    return sorted(records, key=lambda record: (record["device"]["card"], record["date_utc"]))


def _table(head: list[str], rows: list[list[str]]) -> list[str]:
    return [*table_lines(head, rows), ""]


SCENE_HEAD = [
    "scene",
    "where",
    "outcome",
    "vertices",
    "most contacts",
    "steps",
    "Newton iterations",
    "PCG iterations",
    "s a step",
    "ms a Newton iteration",
    "ms a PCG iteration",
    "proof of the minimum",
]
CALLED_LIBRARIES = (
    "Kernels that call `log` or `atan2` may differ in the last place, and a scene that buckles"
    " then goes another way; the `plain` ones have no such kernel."
)
SAME_HEAD = ["run", "vertices", "steps", "outcome", "Newton iterations", "PCG iterations", "most contacts"]


def _of_card(record: dict, copy: float) -> list[str]:
    """What failed, the scenes, the runs beside the host and the kernels of one record. copy: B/s."""
    on = f"on {record['device']['card']}"
    day = f"{record['date_utc'][:10]}, commit {record['git_commit'][:10] or 'not known'}"
    text = []
    if lines := fallen(record):
        text += [f"## What failed {on}, {day}", "", *lines, ""]
    if lines := judged(record):
        text += [f"## Kernels and launches of the tests {on}, {day}", "", *lines, ""]
    if rows := stage_rows(record):
        head = ["stage", "exit code", "s", "s at most"]
        text += [f"## Stages of the lease {on}, {day}", "", *_table(head, rows)]
    text += [f"## Scenes {on}, {day}", "", *_table(SCENE_HEAD, scene_rows(record))]
    head, rows = phase_rows(record)
    if rows:
        said = (
            "Milliseconds a Newton iteration, without the first step, which warms up, where there are more."
            " Only in a run that is called synchronised is a phase charged what it launched, and no other."
        )
        text += [f"## Phases {on}, {day}", "", said, "", *_table(head, rows)]
    head, rows = counter_rows(record)
    if rows:
        text += [f"## Hardware counters {on}, {day}", "", *_table(head, rows)]
    if record.get("same"):
        text += [
            f"## Runs {on} beside the host executor, {day}",
            "",
            *([CALLED_LIBRARIES, ""] if plain_runs(record) else []),
            *_table([*SAME_HEAD, "same bits"], same_rows(record)),
        ]
    text += [f"## Kernels {on}, {day}", ""]
    if not record["kernels"]:
        return [*text, "Not measured.", ""]
    head = ["kernel", "launches", "idle ones", "us a launch", "GB/s", "of the copy"]
    return text + _table(head, kernel_rows(record, copy))


def _cards(records: list[dict]) -> list[str]:
    """The table of cards, and one of kernels for each."""
    text = [
        (
            "Times are means: of a PCG iteration the linear solves over their iterations, of a Newton"
            " iteration the steps over theirs; in records until 2026-11-28 the solves hold assembly that they"
            " waited for. The last column of scenes is the share of the wall time that shows that a step ends"
            " in a minimum. The copy is read and written; of a card it is the fastest that its records have,"
            " since some measured it while the clocks were low. Launches of kernels are those that did"
            " something: a graph of iterations may go on when its solve is over. Records until 2026-11-28 did"
            " not tell them apart, so that times of such kernels are not known."
        ),
        "",
    ]
    text += _table(
        [
            "card",
            "day",
            "driver",
            "SM clock, MHz at most",
            "commit",
            "copy, GB/s",
            "checks",
            "82K: ms a PCG iteration",
            "82K: ms a Newton iteration",
            "1M: ms a PCG iteration",
            "1M: ms a Newton iteration",
            "memory run",
        ],
        card_rows(records),
    )
    for record in records:
        text += _of_card(record, copy_rate(record, records))
    return text


def markdown(records: list[dict], prices: dict) -> str:
    text = [
        "# The CUDA path on cards",
        "",
        (
            "Written by `./bench study gpu-report` from the records `results/gpu/*.json`, which"
            " `experiments/gpu_evidence.sh` makes on a machine with a card."
        ),
        "",
    ]
    if records:
        text += _cards(records)
    else:
        text += [
            (
                f"**{NEVER}** No record of a card is there. What was proven without one: the kernels give the"
                " same bits on host threads in any order; nvcc's PTX of every element function and of the"
                " linear solver gives them on the CPU; the compiled executor gives them on a stand-in for"
                " the CUDA run time. Not proven: the PTX of the kernels of contact and elements"
                " (docs/device.md), ptxas's machine code, CUB, graphs and the driver on a device, memory"
                " order between blocks, and every time and rate."
            ),
            "",
        ]
    text += [
        "## What an hour costs",
        "",
        (
            f"The large scene is `configs/gpu/{LARGE}.json`. Prices are inputs (`results/gpu/prices.json`),"
            " steps are measured."
        ),
        "",
    ]
    text += _table(
        ["card", "price of an hour", "steps in an hour", "a second of the scene"], cost_rows(records, prices)
    )
    return "\n".join(text)


def _rates(axis, record: dict, kernels: list[dict], copy: float) -> list[dict]:
    """The panel of one card, and its numbers. copy: B/s."""
    shares = [kernel["Bps"] / copy for kernel in kernels]
    axis.barh([re.sub(r"\w+::", "", kernel["name"]) for kernel in kernels], shares, color="#0072B2")
    axis.axvline(1, color="#666666", linewidth=0.6, gid=style.REFERENCE)
    axis.invert_yaxis()
    axis.set_xlabel("rate of a kernel / rate of a copy")
    axis.set_title(f"{record['device']['card']}, copy {1e-9 * copy:,.0f} GB/s")
    return [
        {
            "card": record["device"]["card"],
            "date": record["date_utc"],
            "kernel": k["name"],
            "Bps": k["Bps"],
            "copy_Bps": copy,
        }
        for k in kernels
    ]


def draw(records: list[dict], stem: Path) -> list[Path]:
    """Rates of kernels over that of a copy, one panel a card. Empty where no kernel has a rate."""
    shown = [
        (record, [k for k in record["kernels"] if k["Bps"] is not None and not mixes_idle(k)][:MOST_KERNELS])
        for record in records
    ]
    shown = [(record, kernels) for record, kernels in shown if kernels]
    if not shown:
        return []
    fig, axes = plt.subplots(
        len(shown),
        1,
        figsize=(style.WIDE_IN, 0.6 + 0.2 * sum(len(kernels) + 3 for _, kernels in shown)),
        layout="constrained",
        squeeze=False,
    )
    numbers = []
    for axis, (record, kernels) in zip(axes[:, 0], shown):
        numbers += _rates(axis, record, kernels, copy_rate(record, records))
    return style.save(
        fig,
        stem,
        pd.DataFrame(numbers),
        "How fast the longest kernels of the drape at 82 thousand vertices move memory, against a copy on the"
        " same card.",
    )


@tells("study gpu-report")
def main(arguments: list[str]) -> int:
    parser = parser_of("study gpu-report", __doc__)
    parser.add_argument(
        "--records", type=Path, default=RECORDS, help="folder of records and prices (default: results/gpu)"
    )
    parser.add_argument(
        "--results", type=Path, help="folder of page and figure (default: results/ and docs/)"
    )
    asked = parser.parse_args(arguments)
    records = read_records(asked.records)
    prices = read_object(asked.records / "prices.json")
    try:
        page = markdown(records, prices)
    except KeyError as missing:
        raise UserError(f"{asked.records}: no field {missing} in a record") from None
    write_whole((asked.results or ROOT / "results") / "GPU.md", page)
    with tempfile.TemporaryDirectory() as scratch:
        copy_to_page(draw(records, Path(scratch) / "gpu_kernels"), asked.results or ROOT / "docs")
    print(page)
    return 0

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

from . import style
from .errors import UserError, tells
from .figure_files import copy_to_page
from .front.arguments import parser_of
from .gpu_evidence import RECORDS, SCHEMA
from .json_file import read_object
from .places import ROOT
from .text_table import markdown as table_lines
from .whole_file import write_whole

NEVER = "Correct by emulation, never timed."
LARGE = "drape_1m"
MOST_KERNELS = 12
ROOMS = ("sums", "linear", "elements", "contact", "system", "runs")
CHECKS = (
    "device_tests",
    *(f"card_{room}" for room in ROOMS),
    "memcheck",
    "racecheck",
    "initcheck",
    "synccheck",
)
WORDS = {"passed": "passed", "failed": "**failed**", "timed_out": "**timed out**", "left_out": "not run"}


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


def _number(value: float | None, digits: int = 3) -> str:
    return (
        "not measured" if value is None else f"{value:,.{digits}g}" if abs(value) < 1000 else f"{value:,.0f}"
    )


def _scene(record: dict, name: str, key: str) -> float | None:
    scene = record["scenes"].get(name)
    return scene[key] if scene and scene["outcome"] == "ok" else None


def _memory_run(record: dict) -> str:
    scene = record["scenes"].get("dense_184m")
    if scene is None:
        return record["parts"].get("dense_184m", {}).get("why") or "not run"
    return f"{scene['outcome']}, {scene['vertices']:,} vertices, {_number(scene['contacts'])} contacts"


def card_rows(records: list[dict]) -> list[list[str]]:
    rows = []
    for record in records:
        device, card = record["device"], record["card"]
        rows.append(
            [
                device["card"],
                record["date_utc"][:10],
                card.get("driver_version") or device["driver"],
                card.get("clocks.max.sm", "not known"),
                record["git_commit"][:10] or "not known",
                _number(1e-9 * device["copy"]["on_the_card_Bps"]),
                check_text(record),
                *(
                    _number(_scene(record, scene, key))
                    for scene in ("drape_82k", LARGE)
                    for key in ("pcg_ms", "newton_ms")
                ),
                _memory_run(record),
            ]
        )
    return rows


def fallen(record: dict) -> list[str]:
    """Parts that failed, with what they said last; checks have a column of their own."""
    return [
        f"- {name}: {WORDS[part['status']]}: {part['why']}"
        for name, part in record["parts"].items()
        if part["status"] in ("failed", "timed_out")
    ]


def check_text(record: dict) -> str:
    """Every check with its verdict, those with the same one together; what failed comes first."""
    of_word: dict[str, list[str]] = {}
    for name in CHECKS:
        part = record["parts"].get(name, {"status": "left_out"})
        of_word.setdefault(WORDS[part["status"]], []).append(name.replace("_", " "))
    order = ("**failed**", "**timed out**", "passed", "not run")
    return "; ".join(f"{', '.join(of_word[word])} {word}" for word in order if word in of_word)


def scene_rows(record: dict) -> list[list[str]]:
    """The timed scenes of a record, `.cpu` on the processor of the same machine."""
    rows = []
    for name, scene in record["scenes"].items():
        if scene is None:
            continue
        rows.append(
            [
                name.removesuffix(".cpu"),
                f"processor, {scene['linear_solver']}" if name.endswith(".cpu") else "card",
                scene["outcome"],
                f"{scene['vertices']:,}",
                _number(scene["contacts"]),
                str(scene["steps"]),
                str(scene["newton_iterations"]),
                str(scene["pcg_iterations"]),
                *(_number(scene[key]) for key in ("step_s", "newton_ms", "pcg_ms")),
            ]
        )
    return rows


def _both(run: dict, key: str) -> str:
    card, host = (
        f"{value:,.0f}" if isinstance(value, (int, float)) else str(value)
        for value in (run["card"][key], run["host"][key])
    )
    return card if card == host else f"{card}, host {host}"


def same_rows(record: dict) -> list[list[str]]:
    """Runs of a card beside the host executor's."""
    rows = []
    for run in record.get("same", []):
        rows.append(
            [
                run["name"],
                f"{run['vertices']:,}",
                str(run["steps"]),
                *(_both(run, key) for key in ("outcome", "newton_iterations", "pcg_iterations", "contacts")),
                {True: "yes", False: "no", None: "not known"}[run["same_bits"]],
            ]
        )
    return rows


def kernel_rows(record: dict) -> list[list[str]]:
    copy, rows = record["device"]["copy"]["on_the_card_Bps"], []
    for kernel in record["kernels"][:MOST_KERNELS]:
        rate = kernel["Bps"]
        rows.append(
            [
                f"`{kernel['name']}`",
                str(kernel["launches"]),
                _number(1e6 * kernel["seconds"] / max(kernel["launches"], 1)),
                _number(None if rate is None else 1e-9 * rate),
                "not measured" if rate is None else f"{100 * rate / copy:.0f} %",
            ]
        )
    return rows


def cost_rows(records: list[dict], prices: dict) -> list[list[str]]:
    """One row a kind of card; the newest record of it that ran the scene."""
    rows = []
    for card in prices["cards"]:
        of_card = [
            record
            for record in records
            if any(word in record["device"]["card"] for word in card["match"])
            and _scene(record, LARGE, "step_s")
        ]
        step_s = (
            _scene(max(of_card, key=lambda record: record["date_utc"]), LARGE, "step_s") if of_card else None
        )
        dt = _scene(max(of_card, key=lambda record: record["date_utc"]), LARGE, "dt_s") if of_card else None
        price = card["price_per_hour"]
        known = price is not None and card["as_of"] and card["source"]
        said = (
            f"{price:g} {prices['currency']} ({card['as_of']}, {card['source']})"
            if known
            else "enter yours, with date and source, in results/gpu/prices.json"
        )
        a_second = (
            _number(step_s / dt / 3600 * price) + f" {prices['currency']}"
            if step_s and known
            else "not measured"
            if step_s is None
            else "no price"
        )
        rows.append([card["name"], said, _number(None if step_s is None else 3600 / step_s), a_second])
    return rows


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
]
SAME_HEAD = ["run", "vertices", "steps", "outcome", "Newton iterations", "PCG iterations", "most contacts"]


def _of_card(record: dict) -> list[str]:
    """What failed, the scenes, the runs beside the host and the kernels of one record."""
    on = f"on {record['device']['card']}"
    day = record["date_utc"][:10]
    text = []
    if lines := fallen(record):
        text += [f"## What failed {on}, {day}", "", *lines, ""]
    text += [f"## Scenes {on}, {day}", "", *_table(SCENE_HEAD, scene_rows(record))]
    if record.get("same"):
        text += [
            f"## Runs {on} beside the host executor, {day}",
            "",
            "Kernels that call `log` or `atan2` may differ in the last place, and a scene that buckles"
            " then goes another way; the `plain` ones have no such kernel.",
            "",
            *_table([*SAME_HEAD, "same bits"], same_rows(record)),
        ]
    text += [f"## Kernels {on}, {day}", ""]
    if not record["kernels"]:
        return [*text, "Not measured.", ""]
    return text + _table(["kernel", "launches", "us a launch", "GB/s", "of the copy"], kernel_rows(record))


def _cards(records: list[dict]) -> list[str]:
    """The table of cards, and one of kernels for each."""
    text = [
        (
            "Times are means: of a PCG iteration the linear solves over their iterations, of a Newton"
            " iteration the steps over theirs. The copy is read and written."
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
        text += _of_card(record)
    return text


def markdown(records: list[dict], prices: dict) -> str:
    text = [
        "# The CUDA path on cards",
        "",
        (
            "Written by `./bench gpu-report` from the records `results/gpu/*.json`, which"
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


def draw(records: list[dict], stem: Path) -> list[Path]:
    """Rates of kernels over that of a copy, one panel a card. Empty where no kernel has a rate."""
    shown = [
        (record, [k for k in record["kernels"] if k["Bps"] is not None][:MOST_KERNELS]) for record in records
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
        copy = record["device"]["copy"]["on_the_card_Bps"]
        shares = [kernel["Bps"] / copy for kernel in kernels]
        axis.barh([re.sub(r"\w+::", "", kernel["name"]) for kernel in kernels], shares, color="#0072B2")
        axis.axvline(1, color="#666666", linewidth=0.6, gid=style.REFERENCE)
        axis.invert_yaxis()
        axis.set_xlabel("rate of a kernel / rate of a copy")
        axis.set_title(f"{record['device']['card']}, copy {1e-9 * copy:,.0f} GB/s")
        numbers += [
            {
                "card": record["device"]["card"],
                "date": record["date_utc"],
                "kernel": k["name"],
                "Bps": k["Bps"],
                "copy_Bps": copy,
            }
            for k in kernels
        ]
    return style.save(
        fig,
        stem,
        pd.DataFrame(numbers),
        "How fast the longest kernels of the drape at 82 thousand vertices move memory, against a copy on the"
        " same card.",
    )


@tells("gpu-report")
def main(arguments: list[str]) -> int:
    parser = parser_of("gpu-report", __doc__)
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

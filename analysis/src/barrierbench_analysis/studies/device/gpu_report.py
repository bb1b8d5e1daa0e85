"""results/GPU.md and docs/gpu_kernels.png from the records of cards, results/gpu/*.json.

One row a card. Without a record the page says that nothing was timed. Prices are inputs
(results/gpu/prices.json).
"""

import re
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.figure_files import copy_to_page
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.template import filled
from barrierbench_analysis.io.text_table import markdown as table_lines
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of

from . import gpu_tables
from .gpu_evidence import RECORDS, SCHEMA
from .gpu_tables import MOST_KERNELS, copy_rate, mixes_idle

TEMPLATE = ROOT / "configs" / "studies" / "gpu_report.md"
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


def markdown(records: list[dict], prices: dict) -> str:
    """The page, whose template calls functions of gpu_tables. Errors: UserError where a record lacks a
    field.
    """
    about = {"records": records, "prices": prices, "never": NEVER, "large": gpu_tables.LARGE}
    rows = {name: of for name, of in vars(gpu_tables).items() if callable(of)}
    return filled(TEMPLATE, {**about, **rows, "table": lambda head, rows: "\n".join(table_lines(head, rows))})


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


@reported("study gpu-report")
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

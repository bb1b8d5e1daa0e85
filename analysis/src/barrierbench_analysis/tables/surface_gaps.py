"""How close the whole surface came to obstacles and to itself in every run below some folders: ./bench
data surface-gaps RUNS...
"""

import sys
from pathlib import Path

from barrierbench_analysis.io.errors import reported
from barrierbench_analysis.io.input_file import below
from barrierbench_analysis.io.text_table import aligned
from barrierbench_analysis.program.arguments import parser_of

from .records import RecordError, read_record

HEAD = ["run", "outcome", "to obstacles (mm)", "between (mm)", "step ends", "triangles", "edges", "vertices"]


def _cell(audit: dict, name: str) -> str:
    """A gap in mm, or the word that says why there is none; earlier records have neither."""
    value = audit.get(name)
    if value is not None:
        return f"{1e3 * value:.4g}"
    return str(audit.get(f"{name}_status", "not_recorded")) if audit.get("enabled") else "not_audited"


def gap_of(record: dict) -> float | None:
    """Smallest of the two gaps, m; None where neither was measured."""
    audit = record["audit"]
    found = [
        audit[name]
        for name in ("surface_gap_obstacles_m", "surface_gap_between_m")
        if audit.get(name) is not None
    ]
    return min(found, default=None)


def row(run: str, record: dict) -> list[str]:
    audit = record["audit"]
    counts = [
        str(audit.get(name, "-"))
        for name in ("surface_gaps", "obstacle_triangles", "obstacle_edges", "obstacle_vertices")
    ]
    return [
        run,
        record["status"]["outcome"],
        _cell(audit, "surface_gap_obstacles_m"),
        _cell(audit, "surface_gap_between_m"),
        *counts,
    ]


def verdict(records: list[tuple[str, dict]]) -> tuple[str, list[str]]:
    """The line below the table, and what is wrong: runs that are called ok although their surface is in
    something, or that no run that is ok has a gap, so that nothing was judged.
    """
    ok = [(run, gap_of(record)) for run, record in records if record["status"]["outcome"] == "ok"]
    measured = [gap for _, gap in ok if gap is not None]
    below = [run for run, gap in ok if gap is not None and gap < 0]
    text = (
        f"{len(records)} runs, {len(ok)} ok; {len(measured)} of the ok ones with a gap,"
        f" {len(ok) - len(measured)} without (nothing near, not audited, or no such field)"
    )
    if measured:
        text += f"; the smallest is {1e3 * min(measured):.4g} mm"
    faults = [f"{run} is ok with a surface in an obstacle or in another" for run in below]
    return f"{text}; {len(below)} below 0", (
        faults if measured else ["no run that is ok has a measured gap: nothing was judged"]
    )


@reported("data surface-gaps")
def main(arguments: list[str]) -> int:
    parser = parser_of("data surface-gaps")
    parser.add_argument(
        "runs", type=Path, nargs="+", metavar="RUNS", help="folders with records, at any depth"
    )
    records, faults = [], []
    for root in parser.parse_args(arguments).runs:
        for path in below(root, "run.json"):
            try:
                records.append((str(path.parent), read_record(path)))
            except RecordError as error:
                faults.append(str(error))
    for fault in faults:
        print(f"{fault}; left out", file=sys.stderr)
    if not records:
        print("surface-gaps: no run.json below these folders that can be read", file=sys.stderr)
        return 2
    print("\n".join(aligned(HEAD, [row(run, record) for run, record in records], set(range(2, len(HEAD))))))
    text, wrong = verdict(records)
    print(text)
    for line in wrong:
        print(f"surface-gaps: {line}", file=sys.stderr)
    return 1 if wrong else 0

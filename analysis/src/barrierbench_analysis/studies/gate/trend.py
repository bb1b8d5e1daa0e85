"""Class VI: steps in the history of the numbers of a gate. `bench gate --history FILE` appends a line a run,
`bench gate trend FILE` looks for steps.

A history of one metric is fitted by a piecewise constant function: the sum of |value - median of its piece|
plus a penalty for every step is least (L1, exact by dynamic programming). The penalty is twice the median
|difference of neighbours| times log n, as asv chooses it by scale. A step of more than 5 % between the last
two pieces is shown. A trend never blocks: the exit code is 0, 2 for a file that cannot be read.
"""

import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.text_table import aligned
from barrierbench_analysis.io.whole_file import append_line
from barrierbench_analysis.program.arguments import parser_of

from .finding import Finding

SCHEMA = "barrierbench.history/1"
THRESHOLD, FEWEST = 0.05, 5
SHORTEST = 2  # runs of a piece: a single outlier is no step
KEPT = ("III", "IV", "V")


@dataclass(frozen=True)
class Step:
    case: str
    metric: str
    commit: str  # the first after the step
    before: float
    after: float
    runs: int


def pieces(values: list[float]) -> list[tuple[int, int]]:
    """[begin, end) of the pieces of the best fit, O(n^2 log n)."""
    n = len(values)
    differences = [abs(b - a) for a, b in zip(values, values[1:])]
    floor = 1e-3 * median(abs(v) for v in values) if values else 0.0
    penalty = 2 * max(median(differences) if differences else 0.0, floor) * math.log(max(n, 2))
    best, cut = [0.0] + [math.inf] * n, [0] * (n + 1)
    for end in range(1, n + 1):
        for begin in range(end - SHORTEST + 1):
            middle = median(values[begin:end])
            cost = best[begin] + penalty + sum(abs(v - middle) for v in values[begin:end])
            if cost < best[end] - 1e-12 * abs(cost):
                best[end], cut[end] = cost, begin
    found, end = [], n
    while end > 0:
        found.append((cut[end], end))
        end = cut[end]
    return found[::-1]


def last_step(values: list[float]) -> tuple[int, float, float] | None:
    """Index of the first value after the last step, medians before and after; None without a step above the
    threshold. Metrics in log10 are compared in log10, as the gate keeps them: of a condition number of 1e4 a
    step is a factor of 1.6.
    """
    if len(values) < FEWEST or not all(math.isfinite(v) for v in values):
        return None
    found = pieces(values)
    if len(found) < 2:
        return None
    (a, b), (c, d) = found[-2:]
    before, after = median(values[a:b]), median(values[c:d])
    return (c, before, after) if abs(after - before) > THRESHOLD * (abs(before) or 1.0) else None


def line_of(findings: list[Finding], commit: str, utc: str) -> dict:
    """What a gate leaves in the history: every number of classes III to V."""
    values: dict[str, dict[str, float]] = {}
    for f in findings:
        if f.gate_class in KEPT and isinstance(f.value, (int, float)) and math.isfinite(f.value):
            values.setdefault(f.case, {})[f.metric] = f.value
    return {"schema": SCHEMA, "commit": commit, "utc": utc, "values": values}


def append(path: Path, line: dict) -> None:
    append_line(path, json.dumps(line))


def read(path: Path) -> list[dict]:
    """The lines in their order; a torn last one is left out and said. Raises UserError."""
    if not path.is_file():
        raise UserError(f"{path}: not there; ./bench gate --history {path} writes it")
    lines, rows = input_file.read_text(path).splitlines(), []
    for number, text in enumerate(lines, 1):
        try:
            row = json.loads(text)
        except ValueError:
            if number == len(lines):
                print(f"{path}:{number}: torn last line left out", file=sys.stderr)
                continue
            raise UserError(f"{path}:{number}: not JSON") from None
        values = row.get("values") if isinstance(row, dict) else None
        if not isinstance(values, dict) or row.get("schema") != SCHEMA:
            raise UserError(f"{path}:{number}: no line of {SCHEMA}")
        rows.append(row)
    if not rows:
        raise UserError(f"{path}: empty")
    return rows


def steps(rows: list[dict]) -> tuple[list[Step], int]:
    """The last step of every metric, largest ratio first, and how many histories were long enough to be
    looked at.
    """
    series: dict[tuple[str, str], list[tuple[str, float]]] = {}
    for row in rows:
        for case, values in row["values"].items():
            for metric, value in values.items():
                series.setdefault((case, metric), []).append((row["commit"], value))
    found, looked = [], 0
    for (case, metric), history in series.items():
        looked += len(history) >= FEWEST
        if step := last_step([value for _, value in history]):
            index, before, after = step
            found.append(Step(case, metric, history[index][0], before, after, len(history) - index))
    return sorted(found, key=lambda s: -abs(s.after - s.before) / (abs(s.before) or 1.0)), looked


@reported("gate trend")
def main(argv: list[str]) -> int:
    parser = parser_of("gate trend", __doc__)
    parser.add_argument("history", type=Path, help="file of ./bench gate --history")
    args = parser.parse_args(argv)
    rows = read(args.history)
    found, looked = steps(rows)
    head = ["case", "metric", "before", "after", "since", "runs"]
    lines = [
        [s.case, s.metric, f"{s.before:.6g}", f"{s.after:.6g}", s.commit[:12], str(s.runs)] for s in found
    ]
    if lines:
        print("\n".join(aligned(head, lines, {2, 3, 5})))
    end = "" if looked else "; nothing to look at yet"
    print(f"{len(found)} steps in {looked} histories of {FEWEST} or more runs ({len(rows)} runs){end}")
    return 0

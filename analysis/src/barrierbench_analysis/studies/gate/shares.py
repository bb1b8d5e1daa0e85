"""Words of a record as numbers: of all condition numbers, estimates and steps, which share has which status,
method or proof.

A list of words (one for every matrix, say) is a family; the share of a word that a record of the family does
not have is 0. So half of the numbers turned to `bound` is a share that moved, and a word that nobody has seen
before is judged against 0.
"""

from collections import Counter

from .metrics import LOWER_BETTER, TWO_SIDED, UPPER_BETTER, Metric, Tolerance
from .records import Run

UNIT = "share"
SHARE = Tolerance(absolute=0.05)
SEPARATOR = ": "  # between family and word in the name of a metric
GOOD = ("ok", "converged", "number")
BAD = frozenset(
    "bound lower_bound upper_bound failed not_converged not_estimated not_pd singular non_finite nan"
    " infinite unproven not_checked saddle cusp none not_measured matrix_indefinite iteration_cap"
    " linear_failed".split()
)


def metric(family: str, word: str) -> Metric:
    direction = UPPER_BETTER if word in GOOD else LOWER_BETTER if word in BAD else TWO_SIDED
    return Metric(f"{family}{SEPARATOR}{word}", "III", UNIT, direction, SHARE)


def family_of(name: str) -> str:
    return name.split(SEPARATOR)[0]


def _estimate(line: dict, name: str) -> str | None:
    """`number` or the word that stands in its place; None where the line has neither."""
    if line.get(f"{name}_status") is not None:
        return line[f"{name}_status"]
    return "number" if isinstance(line.get(name), (int, float)) else None


def _matrix(entry: dict) -> str:
    """The name that the summary gives to a matrix of the trace."""
    name = f"{entry.get('stage')}/{entry.get('scaling')}"
    return name if entry.get("matrix") == "clamped" else f"{entry.get('matrix')}/{name}"


def families(run: Run) -> dict[str, Counter]:
    """Family -> word -> how many."""
    found: dict[str, Counter] = {}

    def count(family: str, word, n: int = 1) -> None:
        if isinstance(word, str) and n:
            found.setdefault(family, Counter())[word] += n

    conditions = run.section("summary").get("cond")
    for matrix, conditioning in (conditions if isinstance(conditions, dict) else {}).items():
        for word, n in (conditioning.get("statuses") or {}).items():
            count(f"status {matrix}", word, int(n))
    for line in run.trace:
        count("linear_status", line.get("linear_status"))
        count("error_estimate", _estimate(line, "error_estimate_m"))
        for entry in line.get("cond") or []:
            count(f"method {_matrix(entry)}", entry.get("method"))
            count(f"proof {_matrix(entry)}", entry.get("proof"))
    for step in run.record.get("steps") or []:
        count("step_status", step.get("status"))
        count("end_proof", step.get("end_proof"))
        count("end_error", _estimate(step, "end_error_tolerances"))
    return found


def measure(run: Run) -> dict[Metric, float]:
    return {
        metric(family, word): n / words.total()
        for family, words in families(run).items()
        for word, n in words.items()
    }

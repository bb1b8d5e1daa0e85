"""The table of a set of runs: one row a run, failures included."""

import numpy as np
import pandas as pd

from barrierbench_analysis.io.text_table import aligned

from . import run_words
from .records import Records, condition_of, counted

HEADINGS = {
    "group": "scene",
    "series": "formulation",
    "verdict": "outcome",
    "cond_raw_median": "cond raw med",
    "cond_raw_max": "max",
    "cond_bj_median": "cond bJ med",
    "cond_bj_max": "max",
    "newton_iterations": "Newton",
    "probe_pcg": "PCG med",
    "gap_min_rel": "min gap/d_hat",
    "crossings": "crossings",
}
WORDS = ("group", "series", "verdict")  # the first columns; the others are numbers


def _cond(records: Records, run: str, scaling: str) -> tuple[float, float]:
    """Median (of log10) and maximum; NaN without any."""
    c = condition_of(records, run, scaling)
    if c.empty:
        return float("nan"), float("nan")
    values = counted(c).to_numpy()
    if len(values) == 0:
        return float("nan"), float("nan")
    return float(10 ** np.median(np.log10(values))), float(values.max())


def summary_table(records: Records) -> pd.DataFrame:
    rows = []
    for _, run in records.runs.iterrows():
        raw, scaled = _cond(records, run["run"], "none"), _cond(records, run["run"], "block_jacobi")
        words = [run["outcome"], *run_words.judged_words(run), run_words.end_word(run)]
        rows.append(
            {
                "group": run["group"],
                "series": run["series"],
                "verdict": ", ".join(dict.fromkeys(word for word in words if word)),
                "cond_raw_median": raw[0],
                "cond_raw_max": raw[1],
                "cond_bj_median": scaled[0],
                "cond_bj_max": scaled[1],
                "newton_iterations": run["newton_iterations"],
                "probe_pcg": run["probe_pcg_median"],
                "gap_min_rel": run["gap_min_rel_min"],
                "crossings": run["audit_crossings"] if run["audit_enabled"] else None,
            }
            | {pointer: run[pointer] for pointer in swept(records)}
        )
    return pd.DataFrame(rows)


def swept(records: Records) -> list[str]:
    """Columns of pointers that the sweeps of these runs vary, such as /time/dt_s."""
    return [name for name in records.runs.columns if name.startswith("/")]


def _cell(name: str, value) -> str:
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return "-"
    if name.startswith("cond") or name == "gap_min_rel":
        return f"{value:.2e}"
    return f"{value:g}" if isinstance(value, (int, float, np.number)) else str(value)


def as_text(table: pd.DataFrame) -> str:
    """Aligned columns for a terminal; a blank line between groups."""
    pointers = [
        name for name in table.columns if name.startswith("/") and table[name].map(str).nunique() > 1
    ]  # one value distinguishes no run from another
    names = [*HEADINGS, *pointers]
    cells = [[_cell(name, row[name]) for name in names] for _, row in table.iterrows()]
    head, *lines = aligned([*HEADINGS.values(), *pointers], cells, set(range(len(WORDS), len(names))))
    shown = [head]
    for k, line in enumerate(lines):
        shown += ["", line] if k and cells[k][0] != cells[k - 1][0] else [line]
    return "\n".join(shown)

"""How often contact stops a motion: the share of iterations whose bound by ACCD is below 1, counted in the
trace beside the record.
"""

from pathlib import Path

from barrierbench_analysis.io.record_file import read_trace


def bound_share(record: dict, folder: str) -> float | None:
    """Of all iterations of a run. None without a trace. Of al_free an iteration without an advance of the
    anchor is bounded by nothing and counts as one that is free.
    """
    if folder not in record:
        return None
    bounds = [line.get("alpha_ccd") for line in read_trace(record, Path(record[folder]))]
    known = [bound for bound in bounds if bound is not None]
    return sum(bound < 1 for bound in known) / len(known) if known else None

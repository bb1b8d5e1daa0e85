"""Engines at equal seconds and at equal error, between the levels that were run; nothing is extrapolated."""

import numpy as np


def lines(rows: list[dict]) -> dict[tuple[str, str], list[dict]]:
    """(engine, variant) -> its rows that have seconds and an error, by seconds."""
    out: dict[tuple[str, str], list[dict]] = {}
    for row in rows:
        line = out.setdefault((row["engine"], row["variant"]), [])
        if row["outcome"] == "ok" and row.get("error_mean") is not None:
            line.append(row)
    return {who: sorted(line, key=lambda row: row["seconds"]) for who, line in out.items()}


def at(line: list[dict], given: str, value: float, wanted: str) -> float | None:
    """`wanted` where `given` is `value`, on straight lines between levels in logarithms; None outside of what
    was run, and where `given` is not monotonous.
    """
    points = sorted((row[given], row[wanted]) for row in line if row[given] > 0 and row[wanted] > 0)
    if len(points) == 1 and np.isclose(points[0][0], value, rtol=1e-9):
        return points[0][1]
    if len(points) < 2 or not points[0][0] <= value <= points[-1][0]:
        return None
    by_cost = [row[given] for row in line]
    if by_cost != sorted(by_cost) and by_cost != sorted(by_cost, reverse=True):
        return None
    x, y = np.log(np.array(points)).T
    return float(np.exp(np.interp(np.log(value), x, y)))


def equal(rows: list[dict], ours: str) -> list[dict]:
    """Of every engine: the error in the seconds of our first level, and the seconds of its error; None where
    the levels do not reach.
    """
    found = lines(rows)
    own = next((row for row in rows if row["engine"] == ours and row["level"] == 0), None)
    if own is None or own.get("error_mean") is None:
        return []
    return [
        {
            "engine": engine,
            "variant": variant,
            "error_at_equal_seconds": at(line, "seconds", own["seconds"], "error_mean"),
            "seconds_at_equal_error": at(line, "error_mean", own["error_mean"], "seconds"),
        }
        for (engine, variant), line in found.items()
    ]

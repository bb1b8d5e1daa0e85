"""What the starts of a scene say of each engine: median and range of errors and depths, how many cross."""

import numpy as np

from barrierbench_analysis.tables.numbers import significant


def depth_of(row: dict) -> float:
    """The largest depth in an obstacle or a closed body, m."""
    return max(row.get("depth_obstacles_m") or 0.0, row.get("depth_bodies_m") or 0.0)


def crosses(row: dict) -> bool:
    """Whether surfaces cross in a frame, or are in an obstacle."""
    return row.get("frames_crossing", 0) + row.get("frames_in_obstacles", 0) > 0


def spread(values: list[float]) -> tuple[float, float, float] | None:
    """Least, median, most."""
    return (min(values), float(np.median(values)), max(values)) if values else None


def number(value: float | None, scale: float = 1.0) -> str:
    return "" if value is None else significant(value * scale)


def ranged(found: tuple[float, float, float] | None, scale: float) -> str:
    """Median (least to most), the median alone where all are equal as they are written."""
    if found is None:
        return ""
    least, median, most = (number(value, scale) for value in found)
    return median if least == most else f"{median} ({least} to {most})"


def of_rows(one: dict) -> dict[tuple[str, str, int], list[dict]]:
    """(engine, variant, level) -> its rows, one a start that it was run from, in their order."""
    out: dict[tuple[str, str, int], list[dict]] = {}
    for start in one.get("starts", []):
        for row in start["rows"]:
            out.setdefault((row["engine"], row["variant"], row["level"]), []).append(row)
    return out


def scatter(one: dict) -> dict[tuple[str, str, int], dict]:
    """Of every line of a scene: `starts`, of them `ok`; of those least, median and most of `error` (widths)
    and `depth` (m), and how many were `judged`, cross in a frame (`crossing`), are in an obstacle (`inside`),
    have a passage between frames (`passing`).
    """
    out = {}
    for who, rows in of_rows(one).items():
        ran = [row for row in rows if row["outcome"] == "ok"]
        judged = [row for row in ran if row.get("verdict", "not_judged") != "not_judged"]
        out[who] = {
            "starts": len(rows),
            "ok": len(ran),
            "judged": len(judged),
            "error": spread([row["error_mean"] for row in ran if "error_mean" in row]),
            "depth": spread([depth_of(row) for row in judged]),
            "crossing": sum(row["frames_crossing"] > 0 for row in judged),
            "inside": sum(row["frames_in_obstacles"] > 0 for row in judged),
            "passing": sum(row["passages"] > 0 for row in judged),
        }
    return out

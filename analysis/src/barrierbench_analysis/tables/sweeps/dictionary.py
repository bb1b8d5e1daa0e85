"""What the columns of a table of records are: unit, type, place in the record and meaning, from the schemas
that the program makes.
"""

import re

from barrierbench_analysis.io import fields

# The end of a name says its unit, that of a statistic (gap_min_m_median) the end before it.
UNITS = {
    "N_per_m": "N/m",
    "N_per_m2": "N/m^2",
    "kg_per_m2": "kg/m^2",
    "kg_per_m3": "kg/m^3",
    "m_per_s": "m/s",
    "m_per_s2": "m/s^2",
    "per_s": "1/s",
    "m": "m",
    "s": "s",
    "N": "N",
    "J": "J",
    "Pa": "Pa",
    "rad": "rad",
    "bytes": "byte",
}
STATISTICS = ("min", "p05", "median", "p95", "max", "sum", "n")
_END = re.compile(rf"_({'|'.join(sorted(UNITS, key=len, reverse=True))})$")


def unit_of(name: str) -> str:
    """Of a number with this name: `1` where the name says none."""
    base, _, last = name.rpartition("_")
    if last == "n" and base:
        return "1"
    stem = base if last in STATISTICS and base else name
    found = _END.search("_" + stem.rsplit("/", 1)[-1])
    return UNITS[found[1]] if found else "1"


def type_of(values: list) -> str:
    """word, number, integer or truth of the values that are there; empty where none is."""
    known = {type(value) for value in values if value is not None}
    if not known:
        return ""
    if known == {bool}:
        return "truth"
    if known == {int}:
        return "integer"
    return "number" if known <= {int, float} else "word"


def setting(pointer: str) -> str:
    """What a setting of a config means; empty where the schema of configs has no words for it."""
    node: dict = fields.schema("config")
    for key in pointer.strip("/").split("/"):
        node = (
            node.get("properties", {}).get(key) or node.get("items", {}).get("properties", {}).get(key) or {}
        )
    return node.get("description", "")


def describe(column: str) -> tuple[str, str]:
    """Place in the record, and meaning. Columns of fields that have names of their own (`cond_full/none_...`)
    are of the field that they begin with.
    """
    if column.startswith("/"):
        return f"config{column}", setting(column) or "A setting that the sweep varies."
    known = fields.columns("runs")
    if column in known:
        place, meaning = known[column]
        return "/".join(place), meaning
    if begun := [name for name in known if column.startswith(f"{name}_")]:
        place, meaning = known[max(begun, key=len)]
        return "/".join(place), f"{meaning} Here {column.removeprefix(max(begun, key=len) + '_')}."
    return "", {
        "run": "Folder of the record, below that of the sweep.",
        "repetition": "Which of the repetitions of one combination, from 1 on.",
    }.get(column, "")


def rows(table: dict[str, list]) -> list[dict[str, str]]:
    """One row a column of a table. Numbers and integers have a unit."""
    out = []
    for column, values in table.items():
        kind, (place, meaning) = type_of(values), describe(column)
        unit = unit_of(column) if kind in ("number", "integer") else ""
        out.append({"column": column, "unit": unit, "type": kind, "place": place, "meaning": meaning})
    return out

"""The page of a record of ./bench engine compare: its template is configs/engines/page.md."""

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.template import filled

from .compare import NAME, OURS
from .level import equal
from .scatter import depth_of, number, ranged, scatter
from .starts import without_starts

TEMPLATE = ROOT / "configs" / "engines" / "page.md"
SUMMED = ("starts", "ok", "crossing", "inside", "passing")


def _row(row: dict) -> list[str]:
    judged = "verdict" in row and row["verdict"] != "not_judged"
    return [
        f"{row['engine']} {row['variant']}",
        number(row.get("dt_s"), 1e3),
        row["outcome"],
        number(row.get("seconds")),
        number(row.get("iterations_a_step")),
        row.get("verdict", ""),
        str(row.get("frames_crossing", "")),
        str(row.get("frames_in_obstacles", "")),
        number(depth_of(row), 1e3) if judged else "",
        str(row.get("passages", "")),
        number(row.get("error_mean"), 100),
        number(row.get("stretch_most")),
        number(row.get("energy_most_J")),
        number(row.get("energy_last_J")),
    ]


BALANCE = {"gained_J": "gained, all kinds, J", "exchanged_J": "exchanged, J"}


def _balance_of(one: dict) -> list[list[str]]:
    """Heads, then a line a run whose energies of all kinds the judge balanced. Empty where it balanced none.
    A run exchanges as much as one of its energies (of motion, gravity, elasticity) changes at most.
    """
    body = [
        [f"{row['engine']} {row['variant']}", number(row.get("dt_s"), 1e3)]
        + [number(row[key]) for key in BALANCE]
        for row in one["rows"]
        if row.get("gained_J") is not None
    ]
    return [["engine", "dt, ms", *BALANCE.values()], *body] if body else []


def _warnings_of(one: dict) -> list[str]:
    """What engines warned of while they ran: a line a run that has any."""
    return [
        f"{row['engine']} {row['variant']} at {number(row.get('dt_s'), 1e3)} ms: "
        + ", ".join(f"{name} ({count})" for name, count in found.items())
        for row in one["rows"]
        if (found := row.get("notes", {}).get("warnings"))
    ]


def _contacts_of(one: dict) -> int | None:
    """The most contacts that our runs had, where they were counted: without any nothing was promised."""
    counts = (row["notes"]["contacts_most"] for row in one["rows"] if "contacts_most" in row.get("notes", {}))
    return max(counts, default=None)


def _seen_of(record: dict, engine: str) -> list[tuple[str, dict, dict]]:
    """Variant, what the judge found in all of its runs, and in those from jittered starts (if any)."""
    rows = [row for one in record["scenes"] for row in one["rows"] if row["engine"] == engine]
    out = []
    for variant in dict.fromkeys(row["variant"] for row in rows):
        own = [row for row in rows if row["variant"] == variant]
        ran = [row for row in own if row["outcome"] == "ok"]
        seen = {"starts": len(own), "ok": len(ran)} | {
            name: sum(row.get(key, 0) > 0 for row in ran)
            for name, key in zip(SUMMED[2:], ("frames_crossing", "frames_in_obstacles", "passages"))
        }
        found = [
            s for one in record["scenes"] for who, s in scatter(one).items() if who[:2] == (engine, variant)
        ]
        out.append((variant, seen, {key: sum(s[key] for s in found) for key in SUMMED} if found else {}))
    return out


def _starts_of(one: dict) -> list[list[str]]:
    """A line of every engine, variant and level that was run from jittered starts."""
    steps = {(row["engine"], row["variant"], row["level"]): row.get("dt_s") for row in one["rows"]}
    return [
        [
            f"{who[0]} {who[1]}",
            number(steps.get(who), 1e3),
            f"{s['ok']} of {s['starts']}",
            ranged(s["error"], 100),
            ranged(s["depth"], 1e3),
            *(f"{s[key]} of {s['judged']}" for key in SUMMED[2:]),
        ]
        for who, s in scatter(one).items()
    ]


def text_of(record: dict) -> str:
    """Errors: UserError for a template that needs more than there is."""
    name = record["spec"].get("name", NAME)
    values = {
        "record": record,
        "name": name,
        "suffix": f": {name.removeprefix('engines_')}" if name != NAME else "",
        "scenes_without_starts": without_starts(record["spec"]),
        "number": number,
        "worst_of": lambda left: max(left, key=lambda key: abs(left[key])),
        "contacts_of": _contacts_of,
        "rows_of": lambda one: map(_row, one["rows"]),
        "balance_of": _balance_of,
        "warnings_of": _warnings_of,
        "equal_of": lambda one: equal(one["rows"], OURS),
        "starts_of": _starts_of,
        "seen_of": lambda engine: _seen_of(record, engine),
    }
    return filled(TEMPLATE, values).rstrip() + "\n"

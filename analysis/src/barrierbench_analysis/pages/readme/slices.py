"""The log beside the cubic over theta, without a strain limit and with one: the first results of
docs/results/which-barrier.md, from claims.jsonl and gap_map.jsonl of results/studies. Each is the number of
the strongest evidence there is.
"""

import textwrap
from dataclasses import dataclass

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.pages.stated.number import OFF, OWN, SAME, Number, strongest
from barrierbench_analysis.pages.stated.sources import confirmation, of_claim, of_map
from barrierbench_analysis.studies.claims import table as claims_table
from barrierbench_analysis.studies.claims.entry import read_claim, read_sweep
from barrierbench_analysis.studies.claims.judge import missing
from barrierbench_analysis.studies.claims.slices import rows_of
from barrierbench_analysis.studies.claims.table import Table
from barrierbench_analysis.studies.rules.gap_map import size_tables
from barrierbench_analysis.studies.rules.gap_map.table import Map, kept_map

CLAIM = "H1"
METRIC, PAIR = "cond_p95", ("log", "cubic")
AXIS = {OFF: "off", SAME: "log"}  # limit -> its word in the parts of the claim
LIKE_METRICS = (METRIC, "pcg", "newton")
LIKE = (0.1, 0.01, 0.001)  # targets of the comparison in which contact and limiter have one form


@dataclass(frozen=True)
class Headline:
    """What a page states: `number`, which is the strongest of `candidates`; in how many of the runs that it
    is of the other shape did not get through."""

    number: Number
    candidates: tuple[Number, ...]
    failed: int = 0
    of: int = 0


def _slice_parts(parts) -> list[dict]:
    """Those that ask at one theta and strain limit by how much the log is above the cubic."""
    return [part for part in parts if {"theta", "limit", "above"} <= set(part)]


def _failures(table: Table, part: dict) -> tuple[int, int]:
    runs = rows_of(part, table.sweeps[part["sweep"]], read_sweep(part["sweep"]))
    mine = [row["outcome"] for row in runs.rows if row["case"] == part["over"]]
    return sum(word != "ok" for word in mine), len(mine)


def _headline(table: Table, parts: dict[bool, list[dict]], numbers: list[Number], theta: float, limit: str):
    mine = [n for n in numbers if n.conditions == (theta, limit)]
    number = strongest(mine, f"{METRIC} of {' over '.join(PAIR)} at theta {theta:g}, {limit}")
    part = next(p for p in parts[number.confirmed] if (p["theta"], p["limit"]) == (theta, AXIS[limit]))
    return Headline(number, tuple(mine), *_failures(table, part))


def gather(table: Table | None = None, found: Map | None = None) -> dict:
    """slices: limit -> headlines, the largest theta first. like: one row a theta of LIKE, metric -> number;
    confirmed: what confirmed scenes say of the same. size: sentences. Errors: UserError without runs of
    today's sweep.
    """
    table = table or claims_table.read(claims_table.FILE)
    claim = read_claim(CLAIM)
    if lines := missing(claim, table):
        raise UserError(f"{claims_table.FILE}: {lines[0]}")
    parts = {False: _slice_parts(claim.parts), True: _slice_parts(confirmation(claim, table))}
    sweeps = {part["sweep"] for of in parts.values() for part in of}
    every = [n for n in of_claim(claim, table) if n.metric == METRIC]
    numbers = [n for n in every if n.sweep in sweeps]
    confirmed = [n for n in every if n.confirmed and n.limit == OWN]
    thetas = sorted({part["theta"] for part in parts[False]}, reverse=True)
    slices = {limit: [_headline(table, parts, numbers, theta, limit) for theta in thetas] for limit in AXIS}
    found = found or kept_map()
    like = [
        {n.metric: n for n in of_map(found, PAIR[1], "on", theta) if n.metric in LIKE_METRICS}
        for theta in LIKE
    ]
    if not all(like):
        raise UserError("gap map: found no place in which both got through with a limit of their own form")
    return {"slices": slices, "like": like, "confirmed": confirmed, "size": size_tables.sentences(found)}


def headlines(gathered: dict) -> list[Headline]:
    """Every number of these results with what it was chosen from."""
    of_claims = [headline for of in gathered["slices"].values() for headline in of]
    return of_claims + [Headline(n, (n,)) for row in gathered["like"] for n in row.values()]


def _listed(values: list[str]) -> str:
    return f"{', '.join(values[:-1])} and {values[-1]}" if len(values) > 1 else values[0]


def _thetas(values: list[float]) -> str:
    return _listed([f"{value:g}" for value in values])


def _evidence(of: list[Headline]) -> str:
    """Which scenes, and whether a rule was tuned on them."""
    first = of[0].number
    low, high = (f(k for h in of for k in h.number.unknowns) for f in (min, max))
    scenes = sorted({h.number.scenes for h in of})
    count = f"{scenes[0]}" if len(scenes) == 1 else f"{scenes[0]} to {scenes[-1]}"
    kind = "confirmed: scenes that no rule was tuned on" if first.confirmed else "exploratory"
    return f"{count} scenes of {low} to {high} unknowns, {kind}"


def _without(of: list[Headline]) -> str:
    failed, runs = sum(h.failed for h in of), sum(h.of for h in of)
    through = (
        f"the cubic got through all {runs} runs"
        if not failed
        else f"the cubic, whose force has a largest value, did not get through {failed} of {runs} runs"
    )
    alike = [
        f"{h.number.alike} of {h.number.scenes} at theta {h.number.theta:g}"
        for h in of
        if 2 * h.number.alike > h.number.scenes
    ]
    return (
        "Forces are made equal at the gap theta d_hat under the largest load, so that a smaller theta lets"
        " contacts come closer. Without a strain limit the 95th percentile of the logarithm's condition"
        " numbers over a run (cond: how hard a linear system is) is, at theta"
        f" {_thetas([h.number.theta for h in of])}, {_listed([str(h.number) for h in of])} times the cubic's"
        f" (mean over scenes with its 95% interval; {_evidence(of)}; {through})."
    ) + (
        f" The two differ by less than 2% in most scenes ({_listed(alike)}): there contact hardly changes it."
        if alike
        else ""
    )


def _confirmed(numbers: list[Number]) -> str:
    """Beside exploratory numbers what confirmed scenes say of the same quantity, where they do."""
    named = [f"{n} at theta {n.theta:g} over {n.scenes} scenes ({n.places or 'all runs'})" for n in numbers]
    return f"; confirmed scenes have cond {_listed(named)}" if named else ""


def _with_one(of: list[Headline], like: list[dict[str, Number]], confirmed: list[Number]) -> str:
    def row(metric: str) -> str:
        return _listed([str(numbers[metric]) for numbers in like])

    first = like[0][METRIC]
    places = _listed([numbers[METRIC].places for numbers in like])
    return (
        "With a strain limit there are two questions. What contact alone changes, with the same logarithmic"
        f" limiter in every run: at theta {_thetas([h.number.theta for h in of])} cond is"
        f" {_listed([str(h.number) for h in of])} times the cubic's ({_evidence(of)}). What changes when"
        " contact and limiter both have the form that is compared, logarithm throughout or cubic throughout:"
        f" at theta {_thetas([numbers[METRIC].theta for numbers in like])} cond is {row(METRIC)} times the"
        f" cubic's, PCG takes {row('pcg')} and Newton {row('newton')} times the iterations ({first.study},"
        f" exploratory; in the {places} in which both got through{_confirmed(confirmed)})."
    )


def sentences(found: dict, width: int) -> list[str]:
    """The numbered results."""
    texts = [
        _without(found["slices"][OFF]),
        _with_one(found["slices"][SAME], found["like"], found["confirmed"]),
        *found["size"],
    ]
    return [
        line
        for k, text in enumerate(texts, 1)
        for line in textwrap.wrap(
            f"{k}. {text}", width, subsequent_indent="   ", break_long_words=False, break_on_hyphens=False
        )
    ]

"""What a scene of the catalogue is expected to show, each a named check of the record of a run. A check
says whether it holds and what it saw; without a subject (no friction in the scene, no step) it does not
hold. A check is one function here and a word of CHECKS.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from .named import call


@dataclass(frozen=True)
class Finding:
    """holds: None where there was nothing to judge, which is red too."""

    holds: bool | None
    saw: str

    @property
    def red(self) -> bool:
        return self.holds is not True


def _largest(record: dict, name: str) -> float | None:
    """Of a number of the steps, without those that have none."""
    values = [value for step in record["steps"] if (value := step.get(name)) is not None]
    return max(values) if values else None


def no_crossing(record: dict) -> Finding:
    """The audit ran, judged something, and found nothing."""
    audit = record["audit"]
    if not audit["enabled"] or not audit["judged"] or not audit["motions"]:
        return Finding(None, "the audit judged no motion")
    bad = {key: audit[key] for key in ("crossings", "violations", "unproven") if audit[key]}
    words = ", ".join(f"{count} {key}" for key, count in bad.items()) or "no crossing"
    return Finding(not bad, f"{words} in {audit['motions']} motions")


def _is_between(pair: str, pattern: str) -> bool:
    """The sides of a pair have no order."""
    a, _, b = pair.partition("|")
    return any(fnmatchcase(one, pattern) for one in (f"{a}|{b}", f"{b}|{a}"))


def contacts_active(record: dict, between: str = "*|*") -> Finding:
    """Contacts at step ends, gaps below d_hat and a load; `between`: of pairs of bodies whose names are
    like this.
    """
    most, gap = record["summary"]["contacts"]["max"], record["summary"]["gap_min_rel"]["min"]
    if most is None or gap is None:
        return Finding(None, "no step with contacts")
    gaps = record["summary"]["contact_gaps"]
    loads = [gaps[pair]["load_N"] or 0 for pair in gaps if _is_between(pair, between)]
    if not loads:
        return Finding(None, f"no load between {between}")
    saw = f"{between}: {sum(loads):.3g} N; in all {most:.0f} contacts, gap {gap:.2g} d_hat"
    return Finding(most > 0 and gap < 1 and sum(loads) > 0, saw)


def contact_work(record: dict) -> Finding:
    """Energy in the barrier at some step end."""
    most = _largest(record, "contact_J")
    if most is None:
        return Finding(None, "no step")
    return Finding(most > 0, f"B up to {most:.3g} J")


def _friction(record: dict) -> tuple[int, int] | None:
    steps = record["steps"]
    if not steps or all(step.get("friction_dissipation_J") is None for step in steps):
        return None
    return tuple(sum(step[f"friction_{word}"] for step in steps) for word in ("sticking", "sliding"))


def friction_engaged(record: dict) -> Finding:
    """Contacts that carried friction."""
    counts = _friction(record)
    if counts is None:
        return Finding(None, "no friction in this run")
    return Finding(sum(counts) > 0, f"{counts[0]} sticking, {counts[1]} sliding contacts over the steps")


def sticks(record: dict) -> Finding:
    """At the end contacts stick and none slides."""
    if _friction(record) is None:
        return Finding(None, "no friction in this run")
    last = record["steps"][-1]
    return Finding(
        last["friction_sticking"] > 0 and last["friction_sliding"] == 0,
        f"{last['friction_sticking']} sticking, {last['friction_sliding']} sliding at the end",
    )


def limit_engaged(record: dict) -> Finding:
    """The strain limit stored energy."""
    most, stretch = _largest(record, "limit_J"), record["summary"]["max_stretch"]
    if stretch is None or most is None:
        return Finding(None, "no strain limit in this run")
    return Finding(most > 0, f"stretch up to {stretch:.3g}, S up to {most:.3g} J")


def _operations(config: dict, name: str) -> list[dict]:
    body = next((one for one in config["scene"].get("bodies", []) if one["name"] == name), {})
    motions = [body.get("motion") or {}, *(pin.get("motion") or {} for pin in body.get("pins", []))]
    return [step for motion in motions for step in (motion, *motion.get("then", []))]


def turned(record: dict, body: str, turns: float) -> Finding:
    """The largest turn, in turns, that the config asks of the body or its pins until the last step of the
    run. Prescribed vertices are where it says, or the step has not ended; no position is read here.
    """
    spins = [step for step in _operations(record["config"], body) if step.get("angular_velocity_rad_per_s")]
    if not spins or not record["steps"]:
        return Finding(None, f"nothing turns {body}, or no step")
    end = record["steps"][-1]["t_s"]

    def turn(step: dict) -> float:
        start, stop = step.get("start_s") or 0.0, step.get("end_s")
        time = min(end, end if stop is None else stop) - start
        return abs(step["angular_velocity_rad_per_s"]) * max(time, 0.0) / (2 * math.pi)

    most = max(map(turn, spins))
    return Finding(most >= turns, f"{most:.3g} turns")


def came_to_rest(record: dict, share: float) -> Finding:
    """Kinetic energy at the end, as a share of its largest."""
    most = _largest(record, "kinetic_J")
    if not most:
        return Finding(None, "nothing moved")
    left = record["steps"][-1]["kinetic_J"] / most
    return Finding(left <= share, f"{left:.2g} of the kinetic energy is left")


def fell(record: dict, share: float) -> Finding:
    """How far the bodies fell: gravity's work, as a share of the largest kinetic energy."""
    steps, most = record["steps"], _largest(record, "kinetic_J")
    if not steps or not most:
        return Finding(None, "nothing moved")
    work = steps[0]["gravity_J"] - steps[-1]["gravity_J"]
    return Finding(work >= share * most, f"gravity did {work:.3g} J")


def carries(record: dict, load_N: float, within: float) -> Finding:
    """The sum of all contact forces at the end, against the one that rest asks for."""
    load = record["steps"][-1].get("contact_load_sum_N") if record["steps"] else None
    if load is None:
        return Finding(None, "no contact at the end")
    return Finding(abs(load / load_N - 1) <= within, f"{load:.4g} N, {load_N:g} N at rest")


def bounced(record: dict, share: float) -> Finding:
    """Kinetic energy at the end, against that of the first step; contact has had most of it in between."""
    steps = record["steps"]
    if not steps or not steps[0]["kinetic_J"]:
        return Finding(None, "nothing moved")
    first, last = steps[0]["kinetic_J"], steps[-1]["kinetic_J"]
    least = min(step["kinetic_J"] for step in steps)
    saw = f"{last / first:.4g} of the kinetic energy is back, {least / first:.2g} was left at the turn"
    return Finding(abs(last / first - 1) <= share and least < 0.9 * first, saw)


def rejected(record: dict, outcome: str, says: str) -> Finding:
    """The run did not begin, for this reason, and the message names `says`."""
    status = record["status"]
    if record["steps"]:
        return Finding(None, f"it made {len(record['steps'])} steps")
    return Finding(
        status["outcome"] == outcome and says in status["detail"], f"{status['outcome']}: {status['detail']}"
    )


CHECKS = (
    *(no_crossing, contacts_active, contact_work, friction_engaged, sticks, limit_engaged),
    *(turned, came_to_rest, fell, carries, bounced, rejected),
)


def check_of(expected: dict, path: Path = Path(), place: str = "expect") -> Callable[[dict], Finding]:
    """What an expectation names, as a function of a record. Errors: as call."""
    return call(CHECKS, "check", expected, path, place, own=("because",))


def judge(record: dict, expectations: list[dict]) -> list[tuple[str, Finding]]:
    """Name of each expected check, and what it found."""
    return [(one["check"], check_of(one)(record)) for one in expectations]

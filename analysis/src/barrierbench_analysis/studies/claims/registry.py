"""What was registered before confirmation runs: of each claim the hash of its rule, of its sweeps and of the
files that these name (claims/confirmation/registry.json).
"""

import json
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.git import NoHistory
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.module_code import bare, code_of, sha_of
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.studies.kit import success
from barrierbench_analysis.studies.kit.metrics import METRICS
from barrierbench_analysis.studies.kit.success import COMMON, read_for

from . import fresh
from .entry import ROOT, Claim, read_sweep
from .history import brought
from .inputs import inputs_of
from .outcomes import LEVEL
from .table import Table
from .verdict import LEVELS, SCENES, STARTS

KEPT = "claims/confirmation/registry.json"
FILE = ROOT / KEPT
NAME = "barrierbench.confirmation/1"
# What a rule means beside its parts. A change of how verdicts are computed is a change here, and of every
# hash. What takes a verdict away for want of a subject (numbers.with_subject) gives none and is not here.
STATISTICS = {
    "interval": "95%, Student's t over scenes, a scene the mean over levels of the mean over starts",
    "sign_test": LEVEL,
    "scenes": SCENES,
    "levels": LEVELS,
    "starts_where_they_matter": STARTS,
    "sign": "of a scene's mean share of runs",
    "outcomes": "of scenes and levels that have what is needed",
    "thresholds": "above, below and beyond are strict, within has its ends",
}
RUN_BEFORE = "run_before"  # of an entry
NONE, NOT_RUN, UNVERIFIED = "-", "registered, not run", "not verifiable here"


def confirmed_parts(claim: Claim) -> list[dict]:
    """The deciding parts with their confirmation sweeps, and what else `confirm` replaces, in the place of
    those they were tuned on.
    """
    return [
        {key: value for key, value in {**part, **part.get("confirm", {})}.items() if key != "confirm"}
        for part in claim.deciding
    ]


def confirmable(claim: Claim) -> bool:
    """Whether every deciding part that takes runs has a confirmation sweep, and some part does."""
    runs = [part for part in claim.deciding if "sweep" in part]
    return bool(runs) and not claim.waits_for and all("confirm" in part for part in runs)


def read_as(name: str) -> str:
    """Hash of how a metric is read from a record: its meaning, its unit and its code without comments; what
    that calls is not in it.
    """
    meaning, unit, _, reader = METRICS[name]
    bound = [cell.cell_contents for cell in reader.__closure__ or ()]
    return sha_of([meaning, unit, bare(reader), [x for x in bound if isinstance(x, (str, tuple))]])[:16]


def rule_of(claim: Claim) -> dict:
    parts = confirmed_parts(claim)
    metrics = {
        name
        for part in parts
        for name in (part.get("metric"), *read_for(part.get("bad")), (part.get("equal") or {}).get("metric"))
        if name
    }
    common = {"success": code_of(success)} if any(part.get("bad") == COMMON for part in parts) else {}
    return {
        "parts": parts,
        "metrics": {name: read_as(name) for name in sorted(metrics)},
        "statistics": STATISTICS,
        **common,
    }


def read(file: Path = FILE) -> dict:
    if not file.is_file():
        return {}
    data = read_object(file)
    if data.get("schema") != NAME or not isinstance(data.get("claims"), dict):
        raise UserError(f"{file}: schema {data.get('schema')!r}; {NAME!r} with claims is needed")
    return data["claims"]


def differences(old, new, place: str = "") -> list[str]:
    """Where two JSON values differ: pointer, what was registered, what is there now."""
    if isinstance(old, dict) and isinstance(new, dict):
        return [
            line
            for key in sorted(old.keys() | new.keys())
            for line in differences(old.get(key), new.get(key), f"{place}/{key}")
        ]
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        return [line for k, (a, b) in enumerate(zip(old, new)) for line in differences(a, b, f"{place}/{k}")]
    return [] if old == new else [f"{place}: registered {json.dumps(old)}, now {json.dumps(new)}"]


def register(claim: Claim, table: Table, file: Path = FILE, run_before: str = "") -> dict:
    """Writes the entry of a claim. run_before: when its scenes were run before and by which rule, where they
    were; the page says so. Errors: UserError when it has no confirmation, a scene is not fresh, or its sweeps
    have been run.
    """
    if not confirmable(claim):
        raise UserError(
            f"claims/{claim.id}.json: /parts: every deciding part that takes runs needs confirm.sweep, a"
            " sweep of claims/confirmation"
        )
    entries = read(file)
    run = [name for name, runs in table.sweeps.items() if runs.rows and name not in claim.sweeps]
    for name in claim.confirmation_sweeps:
        fresh.check(read_sweep(name), own=map(read_sweep, claim.sweeps))
        if name in table.sweeps and table.sweeps[name].rows:
            raise UserError(
                f"{claim.id}: {name} has been run ({table.sweeps[name].about.get('date')}): a rule is"
                " registered before the first run of its sweep"
            )
        if not run_before and (other := fresh.shared(read_sweep(name), map(read_sweep, run))):
            raise UserError(
                f"{claim.id}: {name} has scenes of {other}, which has been run: --run-before TEXT says"
                " when and with what, and the page repeats it"
            )
    rule = rule_of(claim)
    entries[claim.id] = ({RUN_BEFORE: run_before} if run_before else {}) | {
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%d"),
        "rule_sha256": sha_of(rule),
        "sweeps": {name: read_sweep(name).sha256 for name in claim.confirmation_sweeps},
        "inputs": {name: inputs_of(read_sweep(name)) for name in claim.confirmation_sweeps},
        "rule": rule,
    }
    write_whole(file, json.dumps({"schema": NAME, "claims": dict(sorted(entries.items()))}, indent=1) + "\n")
    return entries[claim.id]


@dataclass(frozen=True)
class State:
    """Where the confirmation of a claim stands. verified: its verdict may be computed and shown."""

    word: str = NONE
    why: str = ""
    verified: bool = False

    @property
    def refused(self) -> bool:
        return self.word == "refused"


def _refused(why: str) -> State:
    return State("refused", why)


def _changed(claim: Claim, entry: dict) -> str:
    """What is no longer as registered; empty when all is."""
    place = f"{KEPT}: /claims/{claim.id}"
    if sha_of(entry.get("rule")) != entry.get("rule_sha256"):
        return f"{place}/rule: its sha256 is not the rule_sha256 beside it"
    if lines := differences(entry["rule"], rule_of(claim)):
        return (
            f"claims/{claim.id}.json: the rule is another than the one registered on {entry['date']}: "
            + "; ".join(lines)
        )
    for name, sha in entry.get("sweeps", {}).items():
        if read_sweep(name).sha256 != sha:
            return (
                f"{read_sweep(name).file}: sha256 {read_sweep(name).sha256[:12]}, registered {sha[:12]} on"
                f" {entry['date']}"
            )
        registered = entry.get("inputs", {}).get(name, "")
        if (now := inputs_of(read_sweep(name))) != registered:
            then = "the entry has none: register it before another first run"
            if registered:
                then = f"registered {registered[:12]} on {entry['date']}"
            return f"{read_sweep(name).file}: base config, presets and meshes have sha256 {now[:12]}, {then}"
        try:
            fresh.check(read_sweep(name), own=map(read_sweep, claim.sweeps))
        except UserError as error:
            return str(error)
    return ""


def _records(claim: Claim, table: Table, entry: dict) -> State | None:
    """What is wrong with the records, or that there are none; None when all are there and of the registered
    sweep.
    """
    for name, sha in entry["sweeps"].items():
        runs, expected = table.sweeps.get(name), len(read_sweep(name).cases)
        if not runs or not runs.rows:
            return State(NOT_RUN, read_sweep(name).command)
        if (copy := runs.about.get("sha256", "")) != sha:
            return _refused(
                f"results/runs/claims/{name}/sweep.json: the records are of a sweep with sha256"
                f" {copy[:12] or 'unknown'}, registered {sha[:12]} on {entry['date']}"
            )
        if (inputs := runs.about.get("inputs_sha256", "")) != entry["inputs"][name]:
            return _refused(
                f"the records of {name} are of base config, presets and meshes with sha256"
                f" {inputs[:12] or 'unknown'}, registered {entry['inputs'][name][:12]} on {entry['date']}"
            )
        if len(runs.rows) < expected:
            return State(f"registered, {len(runs.rows)} of {expected} runs", read_sweep(name).command)
    return None


def _committed(claim: Claim, table: Table, entry: dict, root: Path) -> State:
    """The commit that brought the entry is an ancestor of HEAD and older than the first run."""
    place = f"{KEPT}: /claims/{claim.id}"
    try:
        commit = brought(root, KEPT, ("claims", claim.id), entry)
    except NoHistory as error:
        return State(UNVERIFIED, f"{place}: no git history here ({error})")
    if commit is None:
        return _refused(
            f"{place}: this entry is in no commit that leads to HEAD, but its sweeps have been run"
        )
    for name in entry["sweeps"]:
        text = table.sweeps[name].about.get("first_started_utc", "")
        started = datetime.fromisoformat(text.replace("Z", "+00:00")) if text else None
        if started is None or (started <= commit.at and commit.oldest):
            why = (
                "the history here is shallow"
                if started
                else f"the records of {name} keep no time of their start: {claim.command} collects them again"
            )
            return State(UNVERIFIED, f"{place}: {why}")
        if started <= commit.at:
            return _refused(
                f"{place}: committed {commit.at:%Y-%m-%d %H:%M:%S} UTC ({commit.sha[:10]}), after the first"
                f" run of {name} ({text})"
            )
    when = (
        f"before the run of these numbers; an earlier run of these scenes was seen: {entry[RUN_BEFORE]}"
        if entry.get(RUN_BEFORE)
        else "before the first run"
    )
    return State("verified", f"registered {entry['date']} in {commit.sha[:10]}, {when}", True)


def state(claim: Claim, table: Table, entries: dict, root: Path = ROOT) -> State:
    if not confirmable(claim):
        return State()
    entry = entries.get(claim.id)
    if entry is None:
        run = [name for name in claim.confirmation_sweeps if name in table.sweeps and table.sweeps[name].rows]
        before = f"not registered before {', '.join(run)} was run"
        return State(NONE, before if run else f"not registered: ./bench study claims --register {claim.id}")
    if changed := _changed(claim, entry):
        return _refused(changed)
    return _records(claim, table, entry) or _committed(claim, table, entry, root)


def ready(claim: Claim, entries: dict, root: Path = ROOT) -> None:
    """Before a first confirmation run: the entry is committed and nothing has changed since. Errors:
    UserError, so that no scene is used up in vain.
    """
    now = state(claim, Table(), entries, root)
    if now.refused:
        raise UserError(f"{claim.id}: no confirmation is run: {now.why}")
    try:
        commit = brought(root, KEPT, ("claims", claim.id), entries[claim.id])
    except NoHistory:
        return  # it will not be verifiable here, which is said then
    if commit is None:
        runs = ", ".join(claim.confirmation_sweeps)
        raise UserError(f"{claim.id}: commit {KEPT} before the first run of {runs}")


def as_confirmation(claim: Claim) -> Claim:
    """The same claim over its confirmation sweeps."""
    return replace(claim, parts=tuple(confirmed_parts(claim)), frontier={})

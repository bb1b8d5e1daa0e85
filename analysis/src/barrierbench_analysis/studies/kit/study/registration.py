"""What was fixed before the runs of a study whose spec has `registered`: configs/studies/registered/NAME.json
lists, oldest first, the hash of its spec and of the code of its rule, with date, commit and reason.

`run` makes no row, and no page is written, of a spec or of a rule that is not the last one of the list. A row
has the hashes of the entry that it was made after, and a page takes no row without one.
"""

import importlib
import json
import pkgutil
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from pathlib import Path
from types import ModuleType

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.git import NoHistory, git
from barrierbench_analysis.io.json_file import read_of_schema
from barrierbench_analysis.io.module_code import DIGITS, code_of, sha_of
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.tables import estimate, statistics

from .spec import Study
from .store import Row

SCHEMA = "barrierbench.registered/1"
MARK = "registered"  # in the origin of a row
LATER = ("page", "question", "parts")  # keys of a spec that no number depends on


@dataclass(frozen=True)
class Entry:
    """date: of UTC. commit: that the entry was made on. why: what was registered, or why it was changed."""

    date: str
    commit: str
    spec: str
    rule: str
    why: str


def file_of(study: Study) -> Path:
    return study.file.parent / "registered" / f"{study.file.stem}.json"


def _modules(module: ModuleType) -> list[ModuleType]:
    """A rule and, where it is a folder, the modules in it, in the order of their names, but those that only
    show its numbers (SHOWS of the rule)."""
    names = {one.name for one in pkgutil.iter_modules(getattr(module, "__path__", []))}
    names = sorted(names - set(getattr(module, "SHOWS", ())))
    return [module, *(importlib.import_module(f"{module.__name__}.{name}") for name in names)]


def now(study: Study) -> tuple[str, str]:
    """Hashes of the spec, and of the code of the rule and of the statistics that it uses, without comments
    and docstrings.
    """
    spec = {key: value for key, value in study.data.items() if key not in LATER}
    cells = [cell.key for cell in study.cells]
    used = (*_modules(study.module), *getattr(study.module, "USES", ()), estimate, statistics)
    code = [code_of(module) for module in used]
    return sha_of([spec, cells])[:DIGITS], sha_of(code)[:DIGITS]


def entries(study: Study) -> list[Entry]:
    """Oldest first; none where nothing is registered. Errors: UserError for another file."""
    file = file_of(study)
    if not file.is_file():
        return []
    data = read_of_schema(file, SCHEMA)
    try:
        return [Entry(**one) for one in data["entries"]]
    except (KeyError, TypeError) as fault:
        raise UserError(
            f"{file}#/entries: found {fault}; allowed: a list of {{{', '.join(Entry.__annotations__)}}}"
        ) from None


def register(study: Study, why: str) -> Entry:
    """Adds an entry with the hashes of today. Errors: UserError where they are registered already, without a
    reason, or for a spec that asks for none.
    """
    if not study.data.get("registered"):
        raise UserError(f'{study.file}#/registered: found none; allowed: "registered": true')
    if not why.strip():
        raise UserError(
            "--register: found an empty reason; allowed: a text that says what is registered, and why"
        )
    kept, (spec, rule) = entries(study), now(study)
    if kept and (kept[-1].spec, kept[-1].rule) == (spec, rule):
        raise UserError(
            f"{file_of(study)}: found these hashes already, of {kept[-1].date}; nothing was added"
        )
    try:
        commit = git(ROOT, "rev-parse", "--short=10", "HEAD").strip()
    except NoHistory:
        commit = "none"
    entry = Entry(datetime.now(timezone.utc).date().isoformat(), commit, spec, rule, why)
    data = {"schema": SCHEMA, "entries": [asdict(one) for one in (*kept, entry)]}
    write_whole(file_of(study), json.dumps(data, indent=1) + "\n")
    return entry


def require(study: Study) -> None:
    """Errors: UserError where a study that has to be registered is not, or is no longer what was
    registered.
    """
    if not study.data.get("registered"):
        return
    kept, names = entries(study), ("spec", "rule")
    command = f'{study.command} run --register "WHY"'
    if not kept:
        raise UserError(
            f"{file_of(study)}: found no registration; allowed: one before the first run ({command})"
        )
    for name, found, known in zip(names, now(study), (kept[-1].spec, kept[-1].rule), strict=True):
        if found != known:
            raise UserError(
                f"{study.file}: found the {name} {found}; allowed: {known}, registered on {kept[-1].date}, or"
                f" a further registration that says why it changed ({command})"
            )


def mark(study: Study) -> dict[str, str]:
    """What the origin of a row has of the last entry; nothing of a study that is not registered."""
    kept = entries(study) if study.data.get("registered") else []
    return {MARK: _mark(kept[-1])} if kept else {}


def _mark(entry: Entry) -> str:
    return f"{entry.spec} {entry.rule}"


def checked(study: Study, rows: list[Row]) -> list[Row]:
    """The rows as they are. Errors: UserError for one that was made after no entry of the list."""
    if not study.data.get("registered"):
        return rows
    known = {_mark(entry) for entry in entries(study)}
    other = next((row for row in rows if row.origin.get(MARK) not in known), None)
    if other is not None:
        raise UserError(
            f"{study.name}: found a row of the registration {other.origin.get(MARK, 'none')!r}"
            f" ({' '.join(other.place.values())}); allowed: {', '.join(sorted(known)) or 'none yet'}"
        )
    return rows


def sentences(study: Study) -> list[str]:
    """Of a page: when and on which commit what was registered, and every later change with its reason."""
    return [f"{e.date}, on commit {e.commit}: spec {e.spec}, rule {e.rule}. {e.why}" for e in entries(study)]

"""Makes the pages of docs/reference from what the program prints now, and finds those that are not so."""

import json
from collections.abc import Callable
from itertools import groupby
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program import verbs
from barrierbench_analysis.program.start import started

from . import MARK, fields, settings, text

FOLDER = "docs/reference"
ONE_PAGE = 200  # rows of a format that stands on one page
SMALL = 14  # rows of a section that stands on the page of its format itself
COMMAND = "./bench dev readme --reference"


def _said(*words: str) -> str:
    """What the program prints. Errors: UserError where it fails or is not built."""
    done = started(*words)
    if done.returncode != 0:
        raise UserError(f"bench {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout


Sections = dict[str, tuple[int, list[str]]]  # name -> number of rows, and blocks


def _format(name: str, title: str, sentence: str, sections: Sections) -> dict[str, str]:
    """Pages of one format: a long section has a page of its own where the format does not fit on one."""
    total = sum(rows for rows, _ in sections.values())
    limit = SMALL if total > ONE_PAGE else total
    long = {of: blocks for of, (rows, blocks) in sections.items() if rows > limit and of}
    links = [f"[`{of}`]({of}.md)" for of in long]
    here = [block for of, (_, blocks) in sections.items() if of not in long for block in blocks]
    others = [f"Pages of their own: {', '.join(links)}."] if links else []
    home = f"{FOLDER}/{name}/index.md" if long else f"{FOLDER}/{name}.md"
    found = {home: text.page(title, sentence, *others, *here)}
    for of, blocks in long.items():
        found[f"{FOLDER}/{name}/{of}.md"] = text.page(f"{title}: {of}", *blocks)
    return found


def _settings(name: str, title: str) -> dict[str, str]:
    every = settings.places(_said("help", name))
    sections: Sections = {}
    for place in every:
        section = settings.section_of(place.pointer)
        rows, blocks = sections.get(section, (0, []))
        sections[section] = rows + len(place.settings), [*blocks, text.place_block(place)]
    sentence = (
        f"Every setting of a {name}, as `./bench help {name}` prints it. `N` is an element of a list. A key"
        " without a default may be left out."
    )
    return _format(name, title, sentence, sections)


def _fields(name: str, title: str, section: Callable[[str], str]) -> dict[str, str]:
    every = fields.fields(_said("help", name))
    groups = {key: list(of) for key, of in groupby(every, key=lambda field: section(field.name))}
    sections = {key: (len(of), [text.field_block(key, of)]) for key, of in groups.items()}
    sentence = (
        f"Every field of a {name}, as `./bench help {name}` prints it. `[]` is an element of a list, and `*`"
        " any name. A field that may be null says which reasons there are."
    )
    return _format(name, title, sentence, sections)


def made() -> dict[str, str]:
    """Page, from the root -> its text. Errors: UserError where the program is not built or says otherwise."""
    return {
        **_settings("config", "Config"),
        **_settings("sweep", "Sweep file"),
        **_fields("record", "Record", fields.section_of),
        **_fields("trace", "Trace", lambda name: "trace"),
        f"{FOLDER}/eval.md": text.eval_page(json.loads(_said("eval", "--schema"))),
        f"{FOLDER}/verbs.md": text.verbs_page(verbs.every()),
    }


def kept(root: Path) -> dict[str, str]:
    """The same of the pages that are there: those of the folder with the mark."""
    every = {path: input_file.read_text(path) for path in sorted((root / FOLDER).rglob("*.md"))}
    return {path.relative_to(root).as_posix(): page for path, page in every.items() if MARK in page}


def stale(root: Path) -> list[str]:
    """One line for every page that is missing, left over, or not what the program prints now."""
    there, wanted = kept(root), made()
    return [
        f"{page}: {'is not there' if page not in there else 'is not what the program prints now'}; {COMMAND}"
        " mends it"
        for page in sorted(there.keys() | wanted.keys())
        if there.get(page) != wanted.get(page)
    ]


def write(root: Path) -> list[str]:
    """Writes the pages and removes those that are left over. Returns the names of what changed."""
    there, wanted = kept(root), made()
    for page in there.keys() - wanted.keys():
        (root / page).unlink()
    changed = [page for page, words in wanted.items() if there.get(page) != words]
    for page in changed:
        (root / page).parent.mkdir(parents=True, exist_ok=True)
        write_whole(root / page, wanted[page])
    return [*changed, *sorted(there.keys() - wanted.keys())]

"""A report as the text of one HTML file: templates of this folder, filled; nothing in it is fetched."""

from functools import cache
from pathlib import Path

import jinja2

from barrierbench_analysis.io import input_file
from barrierbench_analysis.tables.words import counted, listed

from . import answer, apart, methods, tables, verdict
from .figures import Figures
from .gather import Folder
from .players import Players

HERE = Path(__file__).resolve().parent
SECTIONS = [
    (name.lower().replace("scenes in motion", "players"), name)
    for name in "Answer;Verdict;Scenes in motion;Failures;Comparison;Figures;Runs;Methods".split(";")
]
TABLES = {
    "failures": apart.failures,
    "reserved": apart.reserved,
    "apart": apart.not_compared,
    "runs": tables.runs,
}


@cache
def _templates() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def filled(template: str, **values) -> str:
    """A template of this folder; texts from records are escaped."""
    css, js = (input_file.read_text(HERE / name) for name in ("page.css", "page.js"))
    return _templates().get_template(template).render(css=css, js=js, **values) + "\n"


def about(folder: Folder) -> str:
    """One line: what is on the page."""
    scenes = dict.fromkeys(entry.row["scene"] for entry in folder.entries)
    names = dict.fromkeys(entry.row["formulation"] for entry in folder.entries)
    return (
        f"{counted(len(folder.entries), 'run')} of {counted(len(names), 'formulation')} in"
        f" {counted(len(scenes), 'scene')}: {listed(list(scenes))}."
    )


def title(folder: Folder) -> str:
    """The path in this repository; of a folder elsewhere the name, since a page is sent to others."""
    path = tables.shown_path(folder.place)
    return path.name or path.resolve().name if path.is_absolute() else str(path)


def commands(folder: Folder) -> list[str]:
    """Of the whole page: its sweeps, the figures, the page."""
    root = tables.shown_path(folder.place)
    return [*methods.sweep_commands(folder), f"./bench draw figures {root}", f"./bench report {root}"]


def page(folder: Folder, out: Path, figures: Figures, players: Players) -> str:
    """out: where it will lie; links to records are from there."""
    found, verdicts = answer.of(folder), verdict.verdict(folder)
    there = {"figures": figures.shown or figures.notes, "players": players.shown or players.notes}
    return filled(
        "page.html",
        **{key: make(folder, out) for key, make in TABLES.items()},
        title=title(folder), about=about(folder),
        sections=[(key, name) for key, name in SECTIONS if there.get(key, True)],
        answer=answer.table(found), answer_notes=found.notes(),
        badges=tables.badges(folder), is_loud=any(one.tone == verdict.BAD for one in verdicts),
        verdict=verdicts, limits=verdict.limits(folder), comparison=tables.comparison(folder),
        figures=figures,
        players=players.shown, player_notes=players.notes, library=players.library,
        methods=methods.text(folder), commands=commands(folder), count=counted(len(folder.entries), "record"),
    )  # fmt: skip

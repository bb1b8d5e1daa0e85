"""Catalogue: what a run of each scene shows, beside what the scene expects (`expect` in configs/catalogue).

A run is red where an expectation is not fulfilled or has no subject, and where a scene that the program
should start does not end `ok`.
"""

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from barrierbench_analysis.io.text_table import aligned, markdown
from barrierbench_analysis.studies.catalogue.cells import cells as cells
from barrierbench_analysis.studies.catalogue.checks import judge
from barrierbench_analysis.studies.catalogue.entry import names, read_entry
from barrierbench_analysis.studies.kit.study import collect
from barrierbench_analysis.studies.kit.study.spec import Cell, Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.tables.outcomes import OK, outcome_of
from barrierbench_analysis.tables.words import counted

PARTIAL = True
SHOWN = "log"  # the formulation of the picture, and of what was seen in each scene
MEASURED = {
    "red": "expectations of the scene that do not hold or have no subject, and what was seen",
    "seen": "expectations of the scene that hold, and what was seen",
}


def measure(study: Study, cell: Cell, record: dict) -> dict:
    entry, outcome = read_entry(cell.place["scene"]), outcome_of(record)
    found = judge(record, entry.data["expect"])
    ends = [] if outcome == OK or entry.is_rejected else [f"ends_ok: {outcome}"]
    return {
        "red": [*ends, *(f"{name}: {finding.saw}" for name, finding in found if finding.red)],
        "seen": [f"{name}: {finding.saw}" for name, finding in found if not finding.red],
    }


HEAD = ("scene", "formulation", "outcome")


def _run(row: Row) -> list[str]:
    return [row.place["scene"], row.place["formulation"], row.outcome]


def _seconds(row: Row) -> str:
    return f"{round(row.seconds, 1):g} s"


def _cell(row: Row) -> str:
    """Outcome and seconds; bold where something is red."""
    text, red = f"{row.outcome}, {_seconds(row)}", ", ".join(one.split(":")[0] for one in row.values["red"])
    return f"**{text}, red: {red}**" if red else text


def _text(words: str) -> str:
    return words.replace("|", "/").replace("\n", " ")


def _outcomes(study: Study, of_scene: dict[str, list[Row]]) -> list[str]:
    labels = list(dict.fromkeys(cell.place["formulation"] for cell in study.cells))
    body = []
    for scene, rows in of_scene.items():
        found = ["; ".join(_cell(row) for row in rows if row.place["formulation"] == one) for one in labels]
        size = f"{rows[0].values['vertices']}/{rows[0].values['triangles']}"
        body.append([scene, size, *(cell or "-" for cell in found)])
    return markdown(["scene", "vertices/triangles with a membrane", *labels], body)


def _red(rows: list[Row]) -> list[str]:
    body = [
        [*_run(row), _text("; ".join(row.values["red"]))[:300], _text(row.values["detail"])[:200]]
        for row in rows
        if row.values["red"]
    ]
    return markdown([*HEAD, "red", "what the record says"], body) if body else ["Nothing."]


def _described(of_scene: dict[str, list[Row]]) -> Iterator[str]:
    """Of every scene where it comes from, what it stresses, how it deviates and what was seen."""
    for scene, rows in of_scene.items():
        data = read_entry(scene).data
        seen = [one for row in rows if row.place["formulation"] == SHOWN for one in row.values["seen"]]
        yield from (f"### {scene}: {data['title']}", "")
        yield from (f"From {data['source']}. Stresses {data['stresses']}.", "")
        yield from (f"- deviates: {word}." for word in data["deviations"])
        yield from (f"- seen with {SHOWN}: {_text(word)}." for word in seen)
        yield ""


def rule(study: Study, rows: list[Row]) -> dict:
    """The tables of the page."""
    of_scene = {scene: list(mine) for scene, mine in groupby(rows, key=lambda row: row.place["scene"])}
    picture = study.figures / f"{study.name}.png"
    return {
        "scenes": len(of_scene),
        "of": len(names()),
        "runs": len(rows),
        "expected": sum(not row.values["red"] for row in rows),
        "picture": picture.name if picture.is_file() else "",
        "outcomes": "\n".join(_outcomes(study, of_scene)),
        "red": "\n".join(_red(rows)),
        "described": "\n".join(_described(of_scene)).rstrip(),
    }


def judged(study: Study, rows: list[Row]) -> tuple[list[str], bool]:
    """A line for each run of a call of some cells, for each red one of a call of all."""
    red = [row for row in rows if row.values["red"]]
    lines = []
    for row in red if len(rows) == len(study.cells) else rows:
        found = "; ".join(row.values["red"]) or "as expected"
        lines.append([*_run(row), _seconds(row), f"{row.values['newton']}", found[:150]])
    scenes = counted(len({row.place["scene"] for row in rows}), "scene")
    end = f"{len(rows) - len(red)} of {counted(len(rows), 'run')} of {scenes} end as expected"
    return [*aligned([""] * 6, lines)[1:], end], not red


def draw(study: Study, rows: list[Row], numbers: dict, folder: Path) -> list[Path]:
    """One picture of the last state of every scene that starts, where the records of all these runs are
    there; none otherwise.
    """
    from barrierbench_analysis.figures.pictures.frame_pixels import Look
    from barrierbench_analysis.figures.pictures.stills import COLUMNS, PIXELS, VIEW, Still, sheet

    data = {name: entry.data for name in names() if not (entry := read_entry(name)).is_rejected}
    shown = [cell for cell in study.cells if cell.place["formulation"] == SHOWN]
    drawn = [cell for cell in shown if cell.place["scene"] in data]
    runs = collect.folders(study, drawn) if drawn else {}
    if not drawn or len(runs) < len(drawn):
        return []

    stills = []
    for cell in drawn:
        scene = data[cell.place["scene"]]
        view, hidden = tuple(scene.get("view_deg", VIEW)), tuple(scene.get("hidden_bodies", ()))
        look = Look(view=view, size=PIXELS, bare=True, hidden=hidden)
        stills.append(Still(scene["name"], runs[cell.key], look))
    return [sheet(stills, folder / f"{study.name}.png", COLUMNS)]

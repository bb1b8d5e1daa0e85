"""What pages say in a sentence and show in a table too: how many runs there are, how many ended in which way.
Each side is a statement, so that they are compared like two pages.
"""

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.io.errors import UserError

from .statement import Statement, cells_of, section, tables

# study in the table of costs -> what its runs are called
STUDIES = {name: f"{name} runs" for name in ("claims", "gap map", "work-precision", "catalogue", "ablation")}
STUDIES |= {"Pareto fronts": "Pareto runs", "stress suite": "stress runs"}
SAID = "as it is said"
SHOWN = "as its tables add up"


def _said(pattern: str, text: str, page: str, *quantities: str) -> Iterator[Statement]:
    """The groups of the first match, in the order of these quantities; nothing without one."""
    if found := re.search(pattern, text):
        for quantity, number in zip(quantities, found.groups()):
            yield Statement(f"{page}, {SAID}", quantity, "", number.replace(",", ""))


def _shown(page: str, **quantities: int) -> Iterator[Statement]:
    for quantity, number in quantities.items():
        yield Statement(f"{page}, {SHOWN}", quantity.replace("_", " "), "", str(number))


def _rows(text: str, title: str) -> list[str]:
    """Lines of the first table below a heading."""
    lines = [line for line in section(text, title).splitlines() if line.startswith("|")]
    return lines[2:]


def _outcomes(cell: str) -> int:
    """`ok 2, stall_overload` are three runs."""
    return sum(int(n or 1) for n in re.findall(r"[a-z_]+(?: (\d+))?", cell.strip("*_ ")))


def stress(text: str, page: str) -> Iterator[Statement]:
    """Runs, relations and counts of the stress suite."""
    parts = (
        r"(\d+) of (\d+) runs ended as .*?",
        r"(\d+) of (\d+) relations .*?",
        r"(\d+) of (\d+) counts of geometry",
    )
    what = "runs as expected;runs;relations that hold;relations;counts as expected;counts;subjects".split(";")
    said = "; ".join(parts) + r" \((\d+) subjects\)"
    yield from _said(said, text, page, *(f"stress {quantity}" for quantity in what))
    relations, geometry = _rows(text, "Relations between runs"), _rows(text, "Geometry")
    outcomes = [cells_of(line)[1:] for line in _rows(text, "Outcomes")]
    outcomes += [cells[1:2] for title, _, cells in tables(text) if re.match(r"[SM]\d\d ", title)]
    runs = sum(_outcomes(cell) for row in outcomes for cell in row)
    bold = sum(
        _outcomes(part) for row in outcomes for cell in row for part in re.findall(r"\*\*(.+?)\*\*", cell)
    )
    yield from _shown(
        page,
        stress_runs=runs,
        stress_runs_as_expected=runs - bold,
        stress_relations=len(relations),
        stress_relations_that_hold=sum("| holds |" in line for line in relations),
        stress_counts=len(geometry),
        stress_counts_as_expected=sum(line.endswith("| yes |") for line in geometry),
        stress_subjects=sum(int(cells_of(line)[3].split()[0]) for line in geometry),
    )


def catalogue(text: str, page: str) -> Iterator[Statement]:
    """Scenes and runs of the catalogue, and the outcome of each run that is not as expected."""
    quantities = ("catalogue scenes", "catalogue runs", "catalogue runs as expected")
    yield from _said(r"(\d+) of \d+; (\d+) runs, (\d+) of which end as expected", text, page, *quantities)
    heads, runs = [], []
    for title, heads, cells in tables(text):
        if title == "Outcomes":
            runs += [(cells[0], label, cell) for label, cell in zip(heads[2:], cells[2:]) if cell != "-"]
    red = [run for run in runs if run[2].startswith("**")]
    yield from _shown(
        page,
        catalogue_scenes=len(_rows(text, "Outcomes")),
        catalogue_runs=len(runs),
        catalogue_runs_as_expected=len(runs) - len(red),
        catalogue_runs_not_as_expected=len(red),
    )
    told = [cells_of(line) for line in _rows(text, "Not as expected")]
    yield Statement(f"{page}, Not as expected", "catalogue runs not as expected", "", str(len(told)))
    yield Statement(f"{page}, Scenes", "catalogue scenes", "", str(section(text, "Scenes").count("\n### ")))
    for place, cases in (
        ("Outcomes", [(a, b, c.strip("*").split(",")[0]) for a, b, c in red]),
        ("Not as expected", [tuple(cells[:3]) for cells in told]),
    ):
        for scene, label, outcome in cases:
            yield Statement(f"{page}, {place}", f"catalogue: outcome of {scene}", label, outcome)


def work_precision(text: str, page: str) -> Iterator[Statement]:
    """Runs of each scene and those that failed, and problems of a formulation."""
    total = 0
    for part in text.split("\n## ")[1:]:
        scene = part.partition("\n")[0]
        for judged, references in re.findall(r"\. (\d+) runs(?: and (\d+) of references)?, ", part)[:1]:
            total += int(judged) + int(references or 0)
            yield from _of_scene(scene, judged, part, page)
        for _, heads, cells in tables(f"## {part}"):
            if heads[1] == "problems":
                yield Statement(f"{page}, {cells[0]}", "work-precision problems", "", cells[1])
    yield Statement(f"{page}, {SHOWN}", "work-precision runs", "", str(total))


def _of_scene(scene: str, judged: str, part: str, page: str) -> Iterator[Statement]:
    """What the part of a scene says of its runs. A formulation has them with both solvers."""
    runs, failed = f"work-precision runs of {scene}", f"work-precision failed runs of {scene}"
    names = [cells[0] for _, heads, cells in tables(part) if heads[1] == "runs that count"]
    yield Statement(f"{page}, {scene}, {SAID}", runs, "", judged)
    if names:
        each = int(judged) / len(names) / 2
        yield Statement(f"{page}, {SHOWN}", f"{runs}, of a formulation and solver", "", f"{each:g}")
    if found := re.search(r"Failed or not valid, (\d+) of (\d+): (.*)\.", part):
        yield Statement(f"{page}, {scene}, failed runs", runs, "", found[2])
        yield Statement(f"{page}, {scene}, failed runs", failed, "", found[1])
        yield Statement(f"{page}, {scene}, failed runs, listed", failed, "", str(found[3].count(";") + 1))


def work_precision_caption(text: str, page: str) -> Iterator[Statement]:
    """What figures of it say of the same."""
    words = " ".join(text.split())
    if found := re.match(r"(\w+), \w+ against what it cost: (\d+) runs of every formulation", words):
        quantity = f"work-precision runs of {found[1]}, of a formulation and solver"
        yield Statement(page, quantity, "", found[2])
    if found := re.search(r"(\d+) problems a formulation", words):
        yield Statement(page, "work-precision problems", "", found[1])


ENDS = ("ended ok", "crossing in a frame", "in an obstacle", "passing between frames")


def engines(text: str, page: str) -> Iterator[Statement]:
    """How the runs of each engine ended: of its own start, and of jittered ones. Those of a study of another
    name are other runs.
    """
    engine, variant, study = "", "", "" if page == "results/ENGINES.md" else f"{Path(page).stem}, "
    for line in section(text, "What was promised, and what was seen").splitlines():
        if found := re.match(r"- \*\*(\S+) \S+\*\* promises", line):
            engine = found[1]
        elif numbers := re.search(
            r"(\d+) of (\d+) (?:runs )?ended ok; (\d+) .*?, (\d+) .*?, (\d+) with", line
        ):
            own = re.match(r"  - (\S+):", line)
            variant = own[1] if own else variant
            starts = "own start" if own else "jittered starts"
            ok, runs, *others = numbers.groups()
            for quantity, number in zip(("runs", *ENDS), (runs, ok, *others)):
                yield Statement(f"{page}, {SAID}", f"{study}{engine} {variant}: {quantity}", starts, number)
    ends = _ends_of_tables(text)
    for starts in () if study else ("own start", "jittered starts"):
        mine = [
            n for (label, *of), n in ends.items() if label.startswith("mujoco ") and of == [starts, "runs"]
        ]
        quantity = f"mujoco, all variants: runs of {'the ' * (starts == 'own start')}{starts}"
        yield Statement(f"{page}, {SHOWN}", quantity, "", str(sum(mine)))
    for (label, starts, quantity), number in ends.items():
        if not label.startswith("barrierbench"):  # nothing is promised of ours
            yield Statement(f"{page}, {SHOWN}", f"{study}{label}: {quantity}", starts, str(number))


def _ends_of_tables(text: str) -> Counter:
    """(engine and variant, start, quantity) -> runs."""
    found: Counter = Counter()
    for _, heads, cells in tables(text):
        row = dict(zip(heads, cells))
        if "outcome" in row and "frames crossing" in row:
            keys = ("frames crossing", "frames in obstacles", "passages")
            numbers = [1, row["outcome"] == "ok", *(row[key] not in ("", "0") for key in keys)]
            starts = "own start"
        elif "ended ok" in row:
            ok, _, runs = row["ended ok"].partition(" of ")
            keys = ("cross in a frame", "in an obstacle", "pass between frames")
            numbers = [int(runs), int(ok), *(int(row[key].partition(" of ")[0] or 0) for key in keys)]
            starts = "jittered starts"
        else:
            continue
        for quantity, number in zip(("runs", *ENDS), numbers):
            found[row["engine"], starts, quantity] += int(number)
    return found


def engines_in_words(text: str, page: str) -> Iterator[Statement]:
    """What docs/results/engines.md says of MuJoCo."""
    own, jittered = r"Of MuJoCo's (\d+) runs no frame", r"in an obstacle, in (\d+) runs"
    yield from _said(own, text, page, "mujoco, all variants: runs of the own start")
    yield from _said(jittered, text, page, "mujoco, all variants: runs of jittered starts")


def cluster(text: str, page: str) -> Iterator[Statement]:
    """Runs of studies in the table of their cost. Errors: UserError for a study without a name."""
    for title, heads, cells in tables(text):
        if heads[0] == "study":
            if cells[0] not in STUDIES:
                raise UserError(
                    f"{page}: found a row {cells[0]!r}, whose runs nothing is compared with; STUDIES of"
                    f" analysis/src/barrierbench_analysis/pages/stated/counted.py has {', '.join(STUDIES)}"
                )
            yield Statement(f"{page}, {title}", STUDIES[cells[0]], "", cells[2])


CELLS = "gap map cells"
OF_CELLS = tuple(
    f"gap map cells: {what}" for what in ("gap", "cannot reach", "no contact", "failed", "not run")
)


def gap_map(text: str, page: str) -> Iterator[Statement]:
    """Cells and runs of the gap map, on its page, in its captions and in docs/results/which-barrier.md."""
    words, runs = " ".join(text.split()), STUDIES["gap map"]
    yield from _said(r"(\d+) of (\d+) cells are not run", words, page, OF_CELLS[-1], CELLS)
    yield from _said(r"(\d+) cells, (\d+) runs of", words, page, CELLS, runs)
    ends = r"(\d+) reached a gap; (\d+) cannot reach .*?, (\d+) no contact, (\d+) failed, (\d+) not run"
    yield from _said(ends, words, page, *OF_CELLS)
    yield from _said(r"Of (\d+) cells \d+ are decided, with (\d+) runs", words, page, CELLS, runs)
    yield from _said(r"unknowns; (\d+) are not run yet", words, page, OF_CELLS[-1])


def mentions(text: str, page: str) -> Iterator[Statement]:
    """Runs of studies in sentences that are written by hand."""
    yield from _said(r"expected of each: (\d+) runs", text, page, "stress runs")

"""Studies as subjects of figures: their kept numbers, which are made where that is allowed, and their figures
in one column width.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.figures.plots.drawing import Drawing
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.gap_map import entry as gap_map
from barrierbench_analysis.studies.gap_map import figure as gap_figure
from barrierbench_analysis.studies.gap_map import kept as gap_kept
from barrierbench_analysis.studies.gap_map import size_figure
from barrierbench_analysis.studies.gap_map.judge import counts
from barrierbench_analysis.studies.gap_map.size import drawn_sizes
from barrierbench_analysis.studies.gap_map.spec import read_spec as read_gap_map
from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.kit.study.verb import make_rows
from barrierbench_analysis.studies.rules.pareto import figure as pareto_figure
from barrierbench_analysis.studies.rules.work_precision import figure as work_figure
from barrierbench_analysis.tables.outcomes import OK


@dataclass(frozen=True)
class Study:
    """One of the studies. read: a spec; table: the kept file as its figures take it, after a look whether it
    is of this spec; make: runs what is missing and writes the kept file.
    """

    verb: str
    kept: str
    default: Path
    read: Callable
    table: Callable
    make: Callable


def _gap_make(spec, kept: Path, jobs: int) -> None:
    words = [str(spec.path), "--runs", str(kept.parent / "records"), "--jobs", str(jobs)]
    gap_map.make_map(gap_map.arguments(words), spec, kept)


STUDIES = {
    "barrierbench.gap_map/1": Study(
        "gap-map",
        "gap_map.json",
        gap_map.DEFAULT,
        read_gap_map,
        lambda spec, kept: gap_kept.read_for(kept, spec),
        _gap_make,
    ),
}


KIT = "barrierbench.study/1"  # specs of the study kit


def _of_kit(file: Path, runs: Path, may_run: bool, jobs: int) -> dict:
    """The numbers that the rule makes of the kept rows, as of_file has tables."""
    study = read_study(str(file))
    if not study.is_ours:
        study = read_study(str(file), runs / f"{study.rule}-{file.stem}")
    try:
        return page.numbers_of(study)
    except UserError as error:
        if not may_run or study.is_ours:
            raise UserError(f"{error}" + (f" with --out {study.out}" if study.out else "")) from None
    make_rows(study, jobs=jobs)
    return page.numbers_of(study)


def of_file(file: Path, runs: Path, may_run: bool, jobs: int):
    """The table of a study from its kept numbers: of the default spec those in results/, of another those
    below `runs`, made where they are missing and may be. Errors: UserError with the command.
    """
    named = read_object(file).get("schema")
    if named == KIT:
        return _of_kit(file, runs, may_run, jobs)
    if named not in STUDIES:
        raise UserError(f"{file}#/schema: found {named!r}; one of {', '.join((KIT, *STUDIES))} is needed")
    study = STUDIES[named]
    spec, is_default = study.read(file), file == study.default.resolve()
    folder = ROOT / "results" if is_default else runs / f"{study.verb}-{file.stem}"
    kept = folder / study.kept
    again = f"; this makes them: ./bench study {study.verb} {file}" + (
        "" if is_default else f" --results {folder}"
    )
    try:
        if kept.is_file():
            return study.table(spec, kept)
        missing = f"{kept}: not there"
    except UserError as error:
        missing = str(error)
    if not may_run or is_default:
        raise UserError(f"{missing}{again}")
    study.make(spec, kept, jobs)
    return study.table(spec, kept)


def pareto_fronts(numbers: dict, drawing: Drawing) -> list[Path]:
    paths, runs = [], numbers["runs"]
    for scene in runs.scenes:
        rows = [row for row in runs.rows if row.place["scene"] == scene]
        stem = drawing.stem.with_name(f"{drawing.stem.name}_{scene}")
        facts = Facts(
            f"{len(rows)} runs, of which {sum(row.outcome != OK for row in rows)} failed;"
            f" {numbers['starts']} starts",
            "geometric mean over starts",
            "none; compare along a vertical line",
            f"scene {scene}, {numbers['unknowns']} unknowns, {numbers['matching']}, vary {numbers['vary']}",
        )
        paths += drawing.state(pareto_figure.draw(runs, scene, stem, drawing.width_in), facts)
    return paths


def gap_maps(found, drawing: Drawing) -> list[Path]:
    seen = counts(found.rows)
    if not any(row["outcome"] == "ok" for row in found.rows):
        raise drawing.nothing("no run of the map reached a gap")
    facts = Facts(
        f"{len(found.rows)} cells: " + ", ".join(f"{n} {word}" for word, n in seen.items() if n),
        "geometric mean over scenes, resolutions averaged first",
        "the log at its first target in the same place",
        f"scenes {', '.join(found.about['scenes'])}; {found.about['unknowns'][0]} to"
        f" {found.about['unknowns'][1]} unknowns; limit {', '.join(found.limits)}",
    )
    return drawing.state(gap_figure.draw_all(found, drawing.stem.parent, drawing.width_in), facts)


def gap_sizes(found, drawing: Drawing) -> list[Path]:
    if not drawn_sizes(found.rows):
        raise drawing.nothing(
            "no place of the map has a run of the log and one of the cubic that got through"
        )
    return size_figure.draw(found, drawing.stem, drawing.width_in, drawing.title)


def work_precisions(numbers: dict, drawing: Drawing) -> list[Path]:
    scenes = numbers["scenes"]
    ranks, paths = work_figure.by_rank(scenes), []
    for scene in scenes:
        rows = scene["rows"]
        if all(row["error"] is None for row in rows):
            raise drawing.nothing(f"no run of {scene['name']} counts")
        facts = Facts(
            f"{len(rows)} runs, of which {sum(row['error'] is None for row in rows)} do not count",
            "of single runs; lines: those that no cheaper run of the same formulation equals",
            scene["references"][0]["name"],
            f"scene {scene['name']}, {scene['about']['unknowns']} unknowns",
        )
        stem = drawing.stem.with_name(f"{drawing.stem.name}_{scene['name']}")
        paths += drawing.state(work_figure.draw(scene, stem, ranks), facts)
    return paths

"""Studies as subjects of figures: their kept numbers, which are made where that is allowed, and their figures
in one column width.
"""

from pathlib import Path

from barrierbench_analysis.figures.captions import Facts
from barrierbench_analysis.figures.plots.drawing import Drawing
from barrierbench_analysis.studies.kit.study import page
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.kit.study.verb import make_rows
from barrierbench_analysis.studies.rules.gap_map import figures as gap_figures
from barrierbench_analysis.studies.rules.gap_map import size_figure
from barrierbench_analysis.studies.rules.gap_map.size import drawn_sizes
from barrierbench_analysis.studies.rules.pareto import figure as pareto_figure
from barrierbench_analysis.studies.rules.work_precision import figure as work_figure
from barrierbench_analysis.tables.outcomes import OK


def of_file(file: Path, runs: Path, may_run: bool, jobs: int) -> dict:
    """The numbers that the rule of a study makes of its kept rows: of a spec in configs/studies those in
    results/, of another those below `runs`, made where they are missing and may be. Errors: UserError with
    the command.
    """
    study = read_study(str(file))
    if not study.is_ours:
        study = read_study(str(file), runs / f"{study.rule}-{file.stem}")
        if may_run:
            make_rows(study, jobs=jobs)
    return page.numbers_of(study)


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


def gap_maps(numbers: dict, drawing: Drawing) -> list[Path]:
    found, seen = numbers["map"], numbers["n"]
    if not seen[OK]:
        raise drawing.nothing("no run of the map reached a gap")
    facts = Facts(
        f"{len(found.rows)} cells: " + ", ".join(f"{n} {word}" for word, n in seen.items() if n),
        "geometric mean over scenes, resolutions averaged first",
        "the log at its first target in the same place",
        f"scenes {', '.join(found.scenes)}; {numbers['unknowns']} unknowns; limit {', '.join(found.limits)}",
    )
    return drawing.state(gap_figures.draw_all(found, drawing.stem.parent, drawing.width_in), facts)


def gap_sizes(numbers: dict, drawing: Drawing) -> list[Path]:
    found = numbers["map"]
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

"""A study of some scenes of the catalogue with a spec of one's own."""

import json

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit.study import collect
from barrierbench_analysis.studies.kit.study.spec import FOLDER, Study, read_study


def written(folder, rule, scenes, labels=("log",), seeds=None, **settings) -> Study:
    spec = json.loads((FOLDER / f"{rule}.json").read_text())
    cases = [case for case in json.loads((FOLDER / "catalogue.json").read_text())["axes"][0]["cases"] if case["label"] in labels]
    spec |= {"name": "mine", "rule": rule, "base": str(ROOT / "configs/scenes/hang.json"), "about": {"scenes": list(scenes)}}
    spec |= {"axes": [{"names": ["formulation"], "cases": cases}], "set": spec["set"] | settings, "seeds": seeds or spec["seeds"]}
    folder.mkdir(exist_ok=True)
    (folder / "mine.json").write_text(json.dumps(spec))
    return read_study(str(folder / "mine.json"), folder)


def run(study: Study) -> tuple[list, list]:
    """Rows, and the folders of their runs, of all cells."""
    rows = collect.run_cells(study, study.cells)
    return rows, list(collect.folders(study, study.cells).values())

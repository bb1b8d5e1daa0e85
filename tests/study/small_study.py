"""A study of eight small cells, and rows of them."""

import json
from datetime import datetime, timezone

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit import alone
from barrierbench_analysis.studies.kit.study import store
from barrierbench_analysis.studies.kit.study.spec import Study, read_study

BASE = json.loads((ROOT / "configs/scenes/drape2d.json").read_text())
SPEC = {
    "schema": "barrierbench.study/1",
    "name": "small",
    "question": "Does it work?",
    "base": "base.json",
    "set": {"/threads": 1, "/time/steps": 2},
    "axes": [
        {
            "names": ["scene", "level"],
            "cases": [{"label": "strip a", "set": {}}, {"label": "strip b", "set": {"/time/dt_s": 0.005}}],
        },
        {
            "names": ["formulation"],
            "cases": [
                {"label": "one", "set": {"/formulation": "log"}},
                {"label": "two", "set": {"/formulation": "cubic"}},
            ],
        },
    ],
    "seeds": [1, 2],
    "metrics": {"newton": "newton", "steps": "/summary/steps"},
    "page": "results/SMALL.md",
}


def written(folder, **changes) -> Study:
    (folder / "base.json").write_text(json.dumps(BASE))
    (folder / "small.json").write_text(json.dumps({**SPEC, **changes}))
    return read_study(str(folder / "small.json"))


def row(cell, outcome="ok", **values) -> store.Row:
    origin = {"date": "2026-01-01", "machine": "m", "commit": "c", "build": "b"}
    return store.Row(
        cell.key, cell.place, outcome, {"newton": 3.0, "steps": 2.0, **values}, SPEC["metrics"], 12, 0.5, "r", origin
    )


def without_record(**more) -> dict:
    return alone.without_record("crash", "the program ended with -11: oh", datetime(2026, 1, 1, tzinfo=timezone.utc), **more)

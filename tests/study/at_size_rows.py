"""Made rows of the study at size."""

import numpy as np

from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.rules.at_size import measured
from barrierbench_analysis.studies.rules.at_size.pairs import Rows, Where

STUDY = read_study("at_size")
SHELLS = [s["label"] for s in STUDY.about["scenes"] if s["kind"] != "solid"]
EVERY = [s["label"] for s in STUDY.about["scenes"]]


def row(scene, arm, where=None, outcome="ok", **values):
    place = {"scene": scene, "arm": arm, **(where or Where()).__dict__}
    empty = dict.fromkeys([*measured.MEASURED, "gap_min"])
    return Row(f"{place}", place, outcome, empty | values, {}, 12, 1.0, "r", {"build": "b", "machine": "m", "date": "d"})


def two(scene, metric, ratio, where=None, **more):
    return [row(scene, "log", where, **{metric: 10 * ratio}, **more), row(scene, "cubic", where, **{metric: 10.0}, **more)]


def answered(question, rows):
    return question(Rows(STUDY, rows))


def spread(middle, n, by=0.02):
    """n ratios round a middle, none alike."""
    return middle * np.exp(by * np.linspace(-1, 1, n))

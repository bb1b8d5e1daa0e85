"""Ablation: a factorial sweep, a balanced fraction of it that is run in each scene, and what its factors do
(docs/results/method/ablation.md).
"""

import math
from collections.abc import Iterator
from pathlib import Path

from barrierbench_analysis.studies.kit.study.spec import Case, Cell, Study
from barrierbench_analysis.studies.kit.study.store import Row
from barrierbench_analysis.studies.kit.success import FAILURES

from . import figure
from .design import drawn, seldom
from .effects import LEAST_SCENES, LEVEL, METRICS, SHARES, main_effects, pair_effects
from .factors import Factorial, read_factorial
from .report import texts

PARTIAL = True
MEASURED = {"failed": "words of kit/success.py in which the run falls short of the common success"}
WHERE = "without a strain limit, fixed stiffnesses matched to the load of the scene at 0.1 d_hat"


def cells(study: Study) -> Iterator[Case]:
    """The fraction of each scene. Errors: UserError for a spec that does not fit its sweep."""
    factorial = read_factorial(study)
    for scene in factorial.scenes.labels:
        for one in drawn(factorial, scene):
            levels = zip((f.name for f in factorial.factors), factorial.labels_of(one), strict=True)
            yield Case({"scene": scene, **dict(levels)}, factorial.settings_of(scene, one))


def measure(_study: Study, _cell: Cell, record: dict) -> dict:
    return {"failed": " ".join(word for word, (_, read) in FAILURES.items() if read(record))}


def _design(factorial: Factorial, rows: list[Row]) -> dict:
    """How many combinations there are, are allowed, belong to the fraction and have a row."""
    scenes, each = factorial.scenes.labels, factorial.about["combinations"]
    rarest = [seldom(factorial, drawn(factorial, scene)) for scene in scenes]
    excluded = zip(factorial.sweep.get("exclude", []), factorial.about["excluded"], strict=True)
    return {
        "sweep": factorial.sweep["name"],
        "every": math.prod(factorial.sizes) * len(scenes),
        "allowed": len(factorial.allowed) * len(scenes),
        "fraction": each * len(scenes),
        "each": each,
        "missing": each * len(scenes) - len(rows),
        "scene_names": ", ".join(scenes),
        "n_scenes": len(scenes),
        "axes": ", ".join(f"{f.name} ({', '.join(f.levels)})" for f in factorial.factors),
        "rarest": f"{min(rarest)} to {max(rarest)}",
        "excluded": [f"{' with '.join(entry['labels'])}: {reason}" for entry, reason in excluded],
        "left_out": factorial.about["left_out"],
    }


def rule(study: Study, rows: list[Row]) -> dict:
    """Counts, sentences and tables of the page, and the effects for its figure."""
    factorial = read_factorial(study)
    mains, pairs = (
        {metric: of(factorial, rows, metric) for metric in (*METRICS, *SHARES)}
        for of in (main_effects, pair_effects)
    )
    counts = {
        "runs": len(rows),
        "ok": sum(map(SHARES["ok"], rows)),
        "common": sum(map(SHARES["common"], rows)),
        "scenes": len({row.place["scene"] for row in rows}),
        "build": ", ".join(sorted({row.origin["build"] for row in rows})),
        "where": WHERE,
        "level": f"{LEVEL:g}",
        "least_scenes": LEAST_SCENES,
        "main_effects": mains,
        "pair_effects": pairs,
    }
    return counts | _design(factorial, rows) | texts(factorial, rows, mains, pairs)


def draw(study: Study, _rows: list[Row], numbers: dict, folder: Path) -> list[Path]:
    return figure.draw(read_factorial(study), numbers, folder / f"{study.name}.png")

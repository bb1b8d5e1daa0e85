"""The figures of a work-precision study: which panels and which formulations stand in them."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from barrierbench_analysis.figures import style
from barrierbench_analysis.studies.rules.work_precision import figure

NAMES = ("log", "log_squared", "quadratic", "cubic", "two_stage", "ipc2020", "cubic_dynamic")
COSTS = np.geomspace(10, 400, 9)


def rows(name: str, worse: float, factorizations, products) -> list[dict]:
    found = []
    for k, cost in enumerate(COSTS):
        both = {"formulation": name, "axis": "d_hat_m" if k else "anchor", "factor": 0.5**k, "outcome": "ok", "error": worse / cost, "newton": cost, "seconds": 10 / cost, "run": "",
                "factorizations": factorizations(cost), "products": products(cost)}
        found += [both | {"solver": "direct"}, both | {"solver": "pcg"}]
    return found


def scene(names=NAMES, factorizations=lambda n: n, products=lambda n: n**1.7) -> dict:
    return {"name": "made", "error": "e_traj", "targets": [0.1, 0.01], "references": [{"dt_factor": 1.0, "name": "a truth", "band": {}}],
            "about": {"unknowns": 9, "date": "2024-01-31", "machine": "a cpu", "commit": "0"},
            "rows": [r for k, name in enumerate(reversed(names)) for r in rows(name, 1.0 + k, factorizations, products)][::-1]}


@pytest.fixture
def figures(monkeypatch):
    found, save = {}, style.save
    monkeypatch.setattr(style, "save", lambda fig, stem, *rest: found.setdefault(stem.name, fig) and save(fig, stem, *rest))
    yield found
    plt.close("all")


def said(tmp_path, name) -> str:
    return " ".join((tmp_path / f"{name}.txt").read_text().split())


def x_labels(fig) -> list[str]:
    return [axis.get_xlabel() for axis in fig.axes if axis.get_xlabel()]


def test_a_cost_that_repeats_another_has_no_panel(tmp_path, figures):
    figure.draw(scene(("log", "cubic")), tmp_path / "f")
    assert x_labels(figures["f"]) == ["seconds", "Newton iterations", "matrix products of PCG"]
    assert "Left out: factorisations: Newton iterations times 1 (" in said(tmp_path, "f")
    assert "(a), (b): direct solver; (c): conjugate gradients" in said(tmp_path, "f")
    assert "factorizations," in (tmp_path / "f.csv").read_text()  # the numbers are kept


def test_costs_that_differ_have_theirs(tmp_path, figures):
    figure.draw(scene(("log", "cubic"), factorizations=lambda n: n**1.3), tmp_path / "f")
    assert len(x_labels(figures["f"])) == 4 and "Left out" not in said(tmp_path, "f")


def test_products_of_one_a_solve_repeat_iterations_too(tmp_path, figures):
    figure.draw(scene(("log", "cubic"), products=lambda n: n), tmp_path / "f")
    assert x_labels(figures["f"]) == ["seconds", "Newton iterations"] and "conjugate" not in said(tmp_path, "f").split("Left out")[0]


def test_the_profile_has_no_column_twice(tmp_path, figures):
    figure.draw_profile([scene(("log", "cubic"))], tmp_path / "p")
    assert x_labels(figures["p"]) == ["budget: Newton iterations", "budget: matrix products of PCG"] and "Left out: factorisations" in said(tmp_path, "p")


def test_five_formulations_and_the_rest_beside_them(tmp_path, figures):
    """Those that the project compares, then who solves most: of the others ipc2020 has the smallest errors, then two_stage; log_squared and quadratic solve as many."""
    assert figure.by_rank([scene()]) == ["log", "cubic", "cubic_dynamic", "ipc2020", "two_stage", "log_squared", "quadratic"]
    figure.draw(scene(), tmp_path / "f")
    figure.draw_profile([scene()], tmp_path / "p")
    for name in ("f", "p"):
        shown = [[text.get_text() for text in figures[n].legends[0].get_texts()] for n in (name, f"{name}_more")]
        assert shown == [["log", "cubic", "two_stage", "ipc2020", "cubic_dynamic"], ["log", "log_squared", "quadratic"]]
        assert f"Other series: {name}_more: log_squared, quadratic." in said(tmp_path, name)


def test_crosses_are_said_where_there_are_some(tmp_path, figures):
    found = scene(("log", "cubic"))
    figure.draw(found, tmp_path / "f")
    assert "Crosses" not in said(tmp_path, "f")
    next(r for r in found["rows"] if r["solver"] == "direct").update(error=None, outcome="newton_stall")
    figure.draw(found, tmp_path / "f")
    assert "what they had cost by then (1 of 18 with the direct solver)." in said(tmp_path, "f")

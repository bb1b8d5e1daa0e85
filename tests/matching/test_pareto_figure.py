"""The figures of a Pareto study: failed runs have no place on the axes, and are named."""

import math

import matplotlib.pyplot as plt
import pandas as pd
from made_runs import METRICS, row, runs_of

from barrierbench_analysis.figures import style
from barrierbench_analysis.studies.rules.pareto import figure as pareto_figure
from barrierbench_analysis.studies.rules.pareto.fronts import Runs

SCALES = (0.01, 0.1, 1.0, 10.0, 100.0)
NAMES = ("log", "quadratic", "cubic", "cubic_dynamic_lagged", "cubic_dynamic_consistent", "two_stage")


def values(scale: float) -> dict:
    metrics = {name: 5.0 * (k + 1) + scale ** (0.1 * (k + 1)) for k, name in enumerate(METRICS)}
    return metrics | {"cond_no_contact_p95": 2 * metrics["cond_p95"], "cond_no_contact_no_limit_p95": 296.0, "gap": 0.1 * (3 + math.log10(scale)) / 2}


def made(names=("log", "cubic"), failed=lambda name, scale, seed: name == "cubic" and (scale == 0.01 or (scale, seed) == (0.1, 2))) -> Runs:
    return runs_of([row("block", n, scale, seed, **values(scale) | ({"outcome": "penetration", "gap": None} if failed(n, scale, seed) else {}))
                    for n in names for scale in SCALES for seed in (1, 2)])


def drawn(runs: Runs, tmp_path, monkeypatch) -> dict:
    figures, save = {}, style.save
    monkeypatch.setattr(style, "save", lambda fig, stem, *rest: figures.setdefault(stem.name, fig) and save(fig, stem, *rest))
    pareto_figure.draw(runs, "block", tmp_path / "p")
    return figures


def said(tmp_path, name="p") -> str:
    return " ".join((tmp_path / f"{name}.txt").read_text().split())


def test_a_failed_run_is_nowhere_on_the_axes(tmp_path, monkeypatch):
    figure = drawn(made(), tmp_path, monkeypatch)["p"]
    gaps = {r.values["gap"] for r in made().rows if r.values["gap"]}
    for axis in figure.axes:
        x = {v for line in axis.lines for v in line.get_xdata() if v == v}
        assert x and all(min(abs(v / g - 1) for g in gaps) < 1e-9 for v in x), "an abscissa that no run has"
        assert not [line for line in axis.lines if line.get_gid() == style.REFERENCE]
    plt.close("all")


def test_failed_runs_are_in_caption_and_csv(tmp_path, monkeypatch):
    drawn(made(), tmp_path, monkeypatch)
    assert "have no gap: cubic at x0.01, x0.1 (1 of 2 starts)." in said(tmp_path)
    table = pd.read_csv(tmp_path / "p.csv")
    failed = table[table["failed"] > 0]
    assert set(zip(failed["formulation"], failed["scale"], failed["failed"])) == {("cubic", 0.01, 2), ("cubic", 0.1, 1)} and failed["gap"].isna().all()
    drawn(made(failed=lambda *_: False), tmp_path, monkeypatch)
    assert "Not drawn" not in said(tmp_path)


def test_flat_and_repeated_panels_are_left_out_and_named(tmp_path, monkeypatch):
    titles = [axis.get_title() for axis in drawn(made(), tmp_path, monkeypatch)["p"].axes]
    assert "cond, raw" in titles and not {"cond, no contact", "cond, no contact, no limit"} & set(titles)
    assert "cond, no contact: cond, raw times 2; cond, no contact, no limit: one flat line at 296" in said(tmp_path)


def test_a_sixth_formulation_stands_in_a_supplement(tmp_path, monkeypatch):
    figures = drawn(made(NAMES), tmp_path, monkeypatch)
    shown = {name: [text.get_text() for text in figure.legends[0].get_texts()] for name, figure in figures.items()}
    assert shown == {"p": [n for n in NAMES if n != "two_stage"], "p_more": ["log", "two_stage"]}
    assert "have no gap: cubic at" in said(tmp_path) and "cubic" not in said(tmp_path, "p_more")

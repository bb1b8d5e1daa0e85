"""At most five series in a figure, the rest beside it, by one rule."""

import pandas as pd
import pytest

from barrierbench_analysis.tables import series
from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.plots import condition, over_time
from barrierbench_analysis.tables.records import load
from synthetic import write_run

NAMES = ("quadratic", "cubic x s", "cubic_dynamic_consistent", "cubic_dynamic_lagged", "cubic_dynamic", "cubic", "log", "ipc2020", "cubic_dynamic published")


def runs(published="ando2024") -> pd.DataFrame:
    return pd.DataFrame([{"series": name, "formulation": name.split()[0], "folder": name, "comparability_reference_run": "" if name == "log" else "log",
                          "method": published if "published" in name else ""} for name in NAMES])


def test_the_main_figure_has_the_reference_published_methods_and_what_the_project_compares():
    main, more = series.parts_of_runs(runs(), "gaps")
    assert set(main[0].names) == {"log", "cubic_dynamic published", "cubic", "cubic_dynamic", "cubic_dynamic_consistent"}
    assert list(main[1]["series"]) == [name for name in NAMES if name in main[0].names]  # in the order of the sweep
    assert more[0].names == ("log", "quadratic", "cubic x s", "cubic_dynamic_lagged", "ipc2020") and more[0].suffix == "_more"
    assert main[0].says == "Other series: gaps_more: quadratic, cubic x s, cubic_dynamic_lagged, ipc2020."
    assert more[0].says == "The series that gaps leaves out, beside log."


def test_a_changed_method_is_no_published_one():
    main, _ = series.parts_of_runs(runs("ando2024, changed"), "gaps")
    assert "cubic_dynamic published" not in main[0].names and "quadratic" in main[0].names


def test_what_a_figure_is_about_is_in_it():
    main, _ = series.parts_of_runs(runs(), "gaps", first=["cubic x s"])
    assert {"log", "cubic x s"} <= set(main[0].names)


@pytest.mark.parametrize(("count", "sizes"), [(1, [1]), (5, [5]), (6, [5, 2]), (9, [5, 5]), (10, [5, 5]), (11, [5, 4, 4]), (16, [5, 5, 5, 4])])
def test_no_figure_has_more_than_five_and_none_is_lost(count, sizes):
    names = [f"n{k}" for k in range(count)]
    found = series.parts(names, names, "f")
    assert [len(part.names) for part in found] == sizes
    assert {name for part in found for name in part.names} == set(names) and len({part.suffix for part in found}) == len(found)


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize("draw", [condition.figure, over_time.iterations, over_time.gaps])
def test_every_figure_of_a_large_group_keeps_to_it(tmp_path, monkeypatch, draw):
    for k, name in enumerate(NAMES):
        write_run(tmp_path / "runs", name.split()[0], 1.0 + k, 0.1, note=f"strip: {name}", folder=f"run{k}")
    drawn, save = {}, style.save
    monkeypatch.setattr(style, "save", lambda fig, stem, *rest: drawn.setdefault(stem.name, fig) and save(fig, stem, *rest))
    draw(load(tmp_path / "runs"), "strip", tmp_path / "out")
    labels = {name: [text.get_text() for text in fig.legends[0].get_texts()] for name, fig in drawn.items()}
    assert len(labels) == 2 and all(len(found) <= series.MOST for found in labels.values())
    assert {name for found in labels.values() for name in found} == set(NAMES)
    main = next(name for name in labels if not name.endswith("_more"))
    assert f"Other series: {main}_more" in " ".join((tmp_path / "out" / f"{main}.txt").read_text().split())

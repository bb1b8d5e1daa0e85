"""Pictures of a report: those over time for few runs, a mark for each of many; captions are their text."""

import base64

from barrierbench_analysis.pages.report import figures
from barrierbench_analysis.pages.report.gather import gathered


def test_few_runs_are_drawn_over_time_and_each_picture_has_its_caption(runs):
    found = figures.drawn(gathered(runs))
    assert [figure.caption.split(":")[0] for figure in found.shown] == ["strip"] * 3 and found.notes == []
    for figure in found.shown:
        data = base64.b64decode(figure.uri.removeprefix("data:image/png;base64,"))
        assert data.startswith(b"\x89PNG") and figure.width > 800 and figure.height > 300
        assert figure.settings.startswith("Settings: ") and figure.caption.startswith(figure.first)
    assert "the smallest gap between any two surfaces" in found.shown[2].first


def test_many_runs_are_marks_and_that_is_said(runs, monkeypatch):
    monkeypatch.setattr(figures, "MOST_RUNS", 3)
    found = figures.drawn(gathered(runs))
    assert len(found.shown) == 1 and "A mark is a run." in found.shown[0].caption
    assert found.notes == ["Groups of more than 3 runs (strip) have a mark for each run instead of lines over time."]


def test_a_trace_that_is_not_the_records_costs_its_group_the_figures(runs):
    for folder in runs.iterdir():
        (folder / "trace.jsonl").write_text("")
    found = figures.drawn(gathered(runs))
    assert found.shown == [] and found.notes[0].startswith("strip has no figures: ") and "no run.json" in found.notes[0]

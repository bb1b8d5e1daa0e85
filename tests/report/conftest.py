"""Records that the tests of reports share."""

import pytest

from barrierbench_analysis.pages.report import figures
from report_runs import write_records


@pytest.fixture
def runs(tmp_path):
    return write_records(tmp_path / "runs")


@pytest.fixture
def without_figures(monkeypatch):
    """Pages whose pictures are not looked at: drawing them takes seconds."""
    monkeypatch.setattr(figures, "drawn", lambda folder, kept=None: figures.Figures())

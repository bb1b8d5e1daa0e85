"""Records that the tests of tables and figures share."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from analysis.records import load
from synthetic import write_set


@pytest.fixture
def records(tmp_path):
    write_set(tmp_path / "runs")
    return load(tmp_path / "runs")


@pytest.fixture
def unpainted(monkeypatch):
    """Figures are made whole, but their pictures are empty files: painting is nearly all the time of a test of what stands beside them."""
    monkeypatch.setattr(Figure, "savefig", lambda self, path, **_: Path(path).touch())

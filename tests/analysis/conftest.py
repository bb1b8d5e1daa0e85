"""Records that the tests of tables and figures share."""

import pytest

from barrierbench_analysis.tables.records import load
from synthetic import write_set


@pytest.fixture
def records(tmp_path):
    write_set(tmp_path / "runs")
    return load(tmp_path / "runs")

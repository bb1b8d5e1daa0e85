import pytest
from registered import Repository

from barrierbench_analysis.studies.claims import registry


@pytest.fixture
def repository(tmp_path, monkeypatch):
    made = Repository(tmp_path / "repository")
    monkeypatch.setattr(registry, "read_sweep", made.sweep)
    return made

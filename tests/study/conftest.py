"""A small study of four runs, made once."""

import pytest
from study_files import sweep_of_four


@pytest.fixture(scope="session")
def kept_study(program, tmp_path_factory):
    return sweep_of_four(program, tmp_path_factory.mktemp("kept"))


@pytest.fixture
def built(program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)

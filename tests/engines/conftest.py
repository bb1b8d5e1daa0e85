"""What the tests of engines share."""

import sys

import pytest

from barrierbench_analysis.studies.engines import environment


@pytest.fixture
def here(monkeypatch):
    """This Python, which has numpy, is the environment of the template; nothing is fetched."""
    monkeypatch.setattr(environment, "python", lambda card: sys.executable)
    monkeypatch.setattr(environment, "why_not", lambda card: "" if card.name not in ("mujoco", "newton") else f"not installed: ./bench engine {card.name} setup")

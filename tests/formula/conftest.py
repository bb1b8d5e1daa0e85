"""Formulas that every test here compiles go to one cache, made once a session."""

import os

import pytest

pytest.importorskip("sympy")


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory):
    """A cache of formulas of its own, unless BARRIERBENCH_CACHE names one."""
    before = os.environ.get("BARRIERBENCH_CACHE")
    folder = before or str(tmp_path_factory.mktemp("cache"))
    os.environ["BARRIERBENCH_CACHE"] = folder
    yield folder
    if before is None:
        del os.environ["BARRIERBENCH_CACHE"]

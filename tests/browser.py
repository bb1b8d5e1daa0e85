"""Headless Chromium for tests of pages; skipped where it or playwright is absent: ./bench test --browser installs both."""

import importlib.util
import os
import shutil
from contextlib import contextmanager
from pathlib import Path

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
SOFTWARE_GL = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
NAMES = {"HOME": ".", "XDG_CONFIG_HOME": "config", "XDG_CACHE_HOME": "cache", "XDG_DATA_HOME": "data"}

needs_browser = pytest.mark.skipif(
    CHROMIUM is None or importlib.util.find_spec("playwright") is None,
    reason="chromium or playwright is not installed (./bench test --browser)",
)


def launched(play, home: Path, patience_ms: int):
    """A browser whose home is this folder: beside its profile it keeps certificates (~/.pki), settings and caches."""
    own = {name: str(home / folder) for name, folder in NAMES.items()}
    return play.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_GL, timeout=patience_ms, env=os.environ | own)


@contextmanager
def opened_browser(home: Path, patience_ms: int):
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        started = launched(play, home, patience_ms)
        yield started
        started.close()

"""The player in headless Chromium: pixels follow the slider, the colours and the camera, nothing is requested of a network, and no
error is said. Skipped where Chromium or playwright is absent: ./bench test --browser installs both.
"""

import io

import matplotlib.pyplot as plt
import numpy as np
import pytest

from barrierbench_analysis.pages.play import verb
from tests.browser import needs_browser, opened_browser

DARK_GROUND = np.array([0x14, 0x17, 0x1C]) / 255
PATIENCE_MS = 120_000  # a machine without a card that does other things too


class Opened:
    """A page with its requests and its messages."""

    def __init__(self, browser, file, width=1000, height=700, scheme="light"):
        self.context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, offline=True)
        self.page = self.context.new_page()
        self.errors, self.requests = [], []
        self.page.on("console", lambda said: said.type in ("error", "warning") and self.errors.append(said.text))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda asked: self.requests.append(asked.url))
        self.page.goto(file.as_uri())
        self.page.wait_for_function("document.body.dataset.ready === 'yes' || !document.getElementById('error').hidden", timeout=PATIENCE_MS)

    def pixels(self, view: int) -> np.ndarray:
        """[height, width, 3] in 0..1 of a view, once two pictures in a row are the same."""
        place = self.page.locator(".plot").nth(view)
        before, now = None, place.screenshot()
        while now != before:
            before, now = now, place.screenshot()
        return plt.imread(io.BytesIO(now))[..., :3]

    def slide(self, key: str, place: int) -> None:
        self.page.get_by_role("slider", name="Time").press(key)
        self.page.wait_for_function(f"document.body.dataset.shown === '{place}'", timeout=PATIENCE_MS)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with opened_browser(tmp_path_factory.mktemp("browser"), PATIENCE_MS) as started:
        yield started


@pytest.fixture(scope="module")
def both(library, log_run, cubic_run, tmp_path_factory):
    file = tmp_path_factory.mktemp("pages") / "both.html"
    verb.play([log_run, cubic_run], file, "body")
    return file


def share_that_differs(one: np.ndarray, two: np.ndarray) -> float:
    return float((np.abs(one - two).max(axis=-1) > 0.02).mean())


@needs_browser
def test_pixels_follow_slider_colours_and_camera_and_nothing_is_asked_of_a_network(browser, both):
    opened = Opened(browser, both)
    page = opened.page
    assert page.locator("figcaption").all_inner_texts() == [f"{name} · outcome ok\nt = 0 s (start)" for name in ("log", "cubic")]
    start = [opened.pixels(view) for view in (0, 1)]
    for picture in start:
        drawn = np.abs(picture - picture[0, 0]).max(axis=-1) > 0.05
        assert 0.03 < drawn.mean() < 0.9 and len(np.unique(picture.round(2).reshape(-1, 3), axis=0)) > 20  # bodies, shaded
    assert share_that_differs(*start) == 0  # the same start, seen by the same camera

    opened.slide("End", 5)
    assert page.locator("#now").inner_text() == "t = 0.05 s (6 of 6)"
    assert page.locator("figcaption").first.inner_text() == "log · outcome ok\nt = 0.05 s (end of step 4)"
    end = [opened.pixels(view) for view in (0, 1)]
    assert min(share_that_differs(a, b) for a, b in zip(start, end)) > 0.01
    opened.slide("Home", 0)
    assert share_that_differs(opened.pixels(0), start[0]) == 0

    opened.slide("End", 5)
    for colour, unit in (("gap", "d_hat"), ("stretch", "%"), ("contact force", "N")):
        before = opened.pixels(0)
        page.get_by_label("Colour", exact=True).select_option(label=colour)
        page.wait_for_function(f"document.querySelector('#bar .name')?.textContent.endsWith(', {unit}')")
        assert share_that_differs(opened.pixels(0), before) > 0.01
    assert "ball (obstacle)" in page.locator("#bar").inner_text()

    before = [opened.pixels(view) for view in (0, 1)]
    page.get_by_role("img", name="View 1: bodies with log, run log").press("ArrowLeft")
    turned = [opened.pixels(view) for view in (0, 1)]
    assert min(share_that_differs(a, b) for a, b in zip(before, turned)) > 0.01  # one camera for both
    page.get_by_role("button", name="Reset view").click()
    assert share_that_differs(opened.pixels(1), before[1]) == 0

    assert opened.errors == [] and opened.requests == [both.as_uri()]
    opened.context.close()


@needs_browser
def test_play_runs_to_the_end_and_stops(browser, both):
    opened = Opened(browser, both)
    button = opened.page.get_by_role("button", name="Play")
    assert opened.page.get_by_label("Speed").input_value() == "0.01"  # 0.05 s in 5 s
    opened.page.get_by_label("Speed").select_option("0.1")
    button.click()
    opened.page.wait_for_function("document.body.dataset.shown === '5'", timeout=PATIENCE_MS)
    button.wait_for(timeout=PATIENCE_MS)  # it says Play again
    assert opened.errors == []
    opened.context.close()


@needs_browser
def test_on_a_telephone_in_the_dark(browser, both):
    opened = Opened(browser, both, 375, 740, "dark")
    assert opened.page.evaluate("document.documentElement.scrollWidth") == 375
    boxes = [opened.page.locator(".plot").nth(view).bounding_box() for view in (0, 1)]
    assert boxes[1]["y"] > boxes[0]["y"] + boxes[0]["height"] and boxes[0]["width"] > 330
    picture = opened.pixels(0)
    np.testing.assert_allclose(picture[3, 3], DARK_GROUND, atol=0.02)
    assert share_that_differs(picture, np.broadcast_to(picture[3, 3], picture.shape)) > 0.02
    assert opened.errors == []
    opened.context.close()


@needs_browser
def test_forces_are_arrows_that_can_be_hidden(browser, library, forces_run, log_run, tmp_path):
    verb.play([forces_run], tmp_path / "forces.html", "body")
    opened = Opened(browser, tmp_path / "forces.html")
    assert "Force arrows" in opened.page.locator("#arrows").inner_text()
    opened.slide("End", 5)
    shown = opened.pixels(0)
    opened.page.get_by_label("Force arrows").uncheck()
    hidden = opened.pixels(0)
    assert share_that_differs(shown, hidden) > 1e-3
    opened.page.get_by_label("Force arrows").check()
    assert share_that_differs(opened.pixels(0), shown) == 0
    assert opened.errors == []
    opened.context.close()
    verb.play([log_run], tmp_path / "plain.html", "force")
    plain = Opened(browser, tmp_path / "plain.html")
    assert plain.page.locator("#arrows").is_hidden() and plain.errors == []
    plain.context.close()

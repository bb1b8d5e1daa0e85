"""Reports in headless Chromium without a network: tables sort and filter, nothing is requested of anyone and no error is printed, a
telephone scrolls no page sideways, text can be read in light and dark, everything has a name. Skipped where Chromium or playwright
is absent: ./bench test --browser installs both.
"""

import importlib.util
import json
import os
import shutil
import time
from pathlib import Path

import pytest

from barrierbench_analysis.pages.report import diff_page, figures, players, verb
from barrierbench_analysis.pages.report.diff import diff_of
from barrierbench_analysis.pages.report.figures import figure_of
from barrierbench_analysis.pages.report.gather import gathered
from barrierbench_analysis.pages.report.page import page
from report_runs import changed, conditions, write_records
from tests.browser import needs_browser, opened_browser
from tests.play.play_runs import run_of

PATIENCE_MS = 240_000  # a machine without a card that does other things too
MANY = 1000
# Seconds of processor time of such a page. Making it took 6; the other two are wide bounds that still have to be narrowed on a
# machine that does nothing else.
MAKE_S, READY_S, SORT_S = 30, 60, 20

pytestmark = needs_browser

# Text whose contrast with what lies behind it is too low (WCAG 2, 4.5, or 3 for large text): [ratio, text, colour, ground].
CONTRAST = """() => {
  const parts = (colour) => (colour.match(/[\\d.]+/g) || []).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((c) => c / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
  const ground = (node) => {
    for (let n = node; n; n = n.parentElement) {
      const colour = parts(getComputedStyle(n).backgroundColor);
      if (colour.length === 3 || colour[3] === 1) return colour;
    }
    return [255, 255, 255];
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), bad = [];
  let judged = 0;
  while (walker.nextNode()) {
    const node = walker.currentNode.parentElement, text = walker.currentNode.textContent.trim();
    if (!text || !node.getClientRects().length || ["SCRIPT", "STYLE", "OPTION"].includes(node.tagName)) continue;
    const style = getComputedStyle(node), a = light(parts(style.color)), b = light(ground(node));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), size = parseFloat(style.fontSize);
    judged += 1;
    if (ratio < (size >= 24 || (size >= 18.66 && style.fontWeight >= 700) ? 3 : 4.5)) bad.push([ratio, text.slice(0, 40), style.color, ground(node)]);
  }
  return {judged, bad};
}"""

# What takes part in the page and has no name, and what a table, a heading or a landmark lacks.
NAMELESS = """() => {
  const bad = [], named = (n) => (n.getAttribute('aria-label') || n.textContent || n.title || n.alt || (n.labels && n.labels[0]?.textContent) || '').trim();
  for (const n of document.querySelectorAll('button, a, input, select, iframe, img, [role=region], nav, form')) if (!named(n)) bad.push(n.outerHTML.slice(0, 80));
  for (const t of document.querySelectorAll('table')) {
    if (!t.caption) bad.push('a table without a caption');
    for (const h of t.querySelectorAll('th')) if (!h.scope) bad.push('a head without a scope: ' + h.textContent);
    for (const r of t.tBodies[0].rows) if (r.cells[0].tagName !== 'TH') bad.push('a row without a head');
  }
  const levels = [...document.querySelectorAll('h1, h2, h3')].map((h) => Number(h.tagName[1]));
  if (levels.filter((l) => l === 1).length !== 1) bad.push('not one h1');
  if (levels.some((l, k) => k && l > levels[k - 1] + 1)) bad.push('a heading is skipped');
  for (const mark of ['main', 'header', 'nav', 'footer']) if (document.querySelectorAll('body > ' + mark + ', header > ' + mark).length !== 1) bad.push('not one ' + mark);
  const ids = [...document.querySelectorAll('[id]')].map((n) => n.id);
  if (new Set(ids).size !== ids.length) bad.push('an id twice');
  if (!document.documentElement.lang || !document.title) bad.push('no language or title');
  return bad;
}"""


class Opened:
    """A page with its requests and its messages."""

    def __init__(self, browser, file, width=1200, height=800, scheme="light"):
        self.context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, offline=True)
        self.context.grant_permissions(["clipboard-read", "clipboard-write"])
        self.page = self.context.new_page()
        self.page.set_default_timeout(PATIENCE_MS)
        self.errors, self.asked = [], []
        self.page.on("console", lambda said: said.type in ("error", "warning") and self.errors.append(said.text))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda asked: asked.url.startswith("data:") or self.asked.append(asked.url))
        self.page.goto(file.as_uri())
        self.page.locator("html[data-ready='yes']").wait_for(state="attached")  # no script of ours: the page refuses them
        self.file = file

    def column(self, table: str, number: int) -> list[str]:
        rows = f"#{table} tbody tr:not([hidden])"
        return [text.strip() for text in self.page.locator(f"{rows} > :nth-child({number})").all_inner_texts()]

    def unfold(self) -> None:
        self.page.evaluate("document.querySelectorAll('details').forEach((d) => { d.open = true; })")

    def clean(self) -> None:
        assert self.errors == [] and self.asked == [self.file.as_uri()]
        self.context.close()


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with opened_browser(tmp_path_factory.mktemp("browser"), PATIENCE_MS) as started:
        yield started


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> Path:
    """A page with failures, factors and a picture."""
    runs = write_records(tmp_path_factory.mktemp("report") / "runs")
    (runs / "torn").mkdir()
    (runs / "torn/run.json").write_text("{")
    folder, out = gathered(runs), runs / "report.html"
    png = next((Path(__file__).resolve().parents[2] / "docs").glob("condition_demo_long.png"))
    shown = [figure_of("strip", png)]
    verb.write_page(out, page(folder, out, figures.Figures(shown, ["A note."]), players.Players()))
    return out


@pytest.fixture(scope="module")
def of_two(report) -> Path:
    other = report.parent.with_name("other")
    shutil.copytree(report.parent, other)
    changed(other / "cubic", summary={"newton_iterations": 60, "cond": conditions(900)})
    shutil.rmtree(other / "cubic_dynamic")
    out = other / "two.html"
    verb.write_page(out, diff_page.page(diff_of(gathered(report.parent), gathered(other)), out))
    return out


def test_tables_sort_filter_and_copy_and_nothing_is_asked_of_a_network(browser, report):
    opened = Opened(browser, report)
    opened.unfold()
    page, cond = opened.page, opened.page.locator("#runs").get_by_role("button", name="cond raw")
    assert opened.column("runs", 6) == ["250", "300", "100", "400"]
    cond.click()
    assert opened.column("runs", 6) == ["100", "250", "300", "400"]
    assert page.locator("#runs th[aria-sort]").all_inner_texts()[0].startswith("cond raw") and page.locator("#runs th[aria-sort=ascending]").count() == 1
    cond.press("Enter")
    assert opened.column("runs", 6) == ["400", "300", "250", "100"] and page.locator("#runs th[aria-sort=descending]").count() == 1
    for _ in range(2):  # a run without a time is the last one in both directions
        page.locator("#runs").get_by_role("button", name="time s").click()
        assert opened.column("runs", 4)[-1] == "newton_stall"

    page.get_by_label("outcome").select_option("ok")
    assert opened.column("runs", 4) == ["ok"] * 3 and page.locator("#runs output").inner_text() == "3 of 4 shown"
    page.get_by_label("Find").fill("DYNAMIC")
    assert opened.column("runs", 3) == ["cubic_dynamic"]
    page.get_by_role("button", name="Show all").click()
    page.locator("#runs output").filter(has_text="4 of 4 shown").wait_for()

    page.locator("#runs").get_by_role("button", name="Copy the command of cubic", exact=True).click()
    page.locator("#runs").get_by_role("button", name="Copy the command of cubic", exact=True).filter(has_text="Copied").wait_for()
    assert page.evaluate("navigator.clipboard.readText()") == f"./bench run {report.parent}/cubic/run.json"
    opened.clean()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("which", ["report", "of_two"])
def test_text_can_be_read_and_everything_has_a_name(browser, which, scheme, request):
    opened = Opened(browser, request.getfixturevalue(which), scheme=scheme)
    opened.unfold()
    found = opened.page.evaluate(CONTRAST)
    assert found["bad"] == [] and found["judged"] > 100
    ground = opened.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert ground == ("rgb(20, 23, 28)" if scheme == "dark" else "rgb(255, 255, 255)")
    assert opened.page.evaluate(NAMELESS) == []
    opened.clean()


@pytest.mark.parametrize("which", ["report", "of_two"])
def test_a_telephone_scrolls_tables_and_never_the_page(browser, which, request):
    opened = Opened(browser, request.getfixturevalue(which), 375, 740)
    opened.unfold()
    assert opened.page.evaluate("document.documentElement.scrollWidth") == 375
    wide = opened.page.evaluate("[...document.querySelectorAll('.scroll')].map((box) => [box.scrollWidth > box.clientWidth, box.getBoundingClientRect().right <= 375])")
    assert len(wide) >= 3 and any(scrolls for scrolls, _ in wide) and all(fits for _, fits in wide)
    opened.clean()


def test_a_telephone_shows_the_answer_first_and_a_link_opens_its_section(browser, report):
    opened = Opened(browser, report, 375, 740)
    top = opened.page.evaluate("document.querySelector('#answer tbody tr').getBoundingClientRect().bottom")
    assert top < 740 and opened.page.evaluate("document.documentElement.scrollWidth") == 375
    cells = opened.page.evaluate("[...document.querySelectorAll('#answer tbody > tr > *')].map((c) => c.getBoundingClientRect()).map((r) => [r.left, r.right])")
    assert len(cells) >= 16 and all(left >= 0 and right <= 375 for left, right in cells)
    assert not opened.page.locator("#runs table").is_visible()
    opened.page.locator("nav").get_by_role("link", name="Runs").click()
    assert opened.page.locator("#runs table").is_visible()
    opened.clean()


def test_the_focus_is_seen_and_the_keyboard_reaches_the_first_table(browser, report):
    opened = Opened(browser, report)
    opened.page.keyboard.press("Tab")
    assert opened.page.evaluate("document.activeElement.textContent") == "To the answer"
    opened.unfold()
    opened.page.locator("#runs").get_by_role("button", name="Newton").focus()
    opened.page.keyboard.press("Shift+Tab")
    assert opened.page.evaluate("parseFloat(getComputedStyle(document.activeElement).outlineWidth)") >= 2
    opened.clean()


def test_a_player_starts_when_it_is_asked_to(browser, program, tmp_path):
    if importlib.util.find_spec("k3d") is None:
        pytest.skip("k3d is not installed (./bench setup)")
    (tmp_path / "runs").mkdir()
    run_of(program, tmp_path / "runs/log")
    folder, out = gathered(tmp_path / "runs"), tmp_path / "runs/report.html"
    verb.write_page(out, page(folder, out, figures.Figures(), players.made(folder)))
    opened = Opened(browser, out)
    assert opened.page.locator("iframe").count() == 0
    opened.page.get_by_role("button", name="Start the player of").click()
    inside = opened.page.frame_locator("iframe")
    inside.locator("body[data-ready=yes]").wait_for()
    assert inside.locator("#now").inner_text() == "t = 0 s (1 of 6)" and not inside.locator("#error").is_visible()
    assert opened.page.get_by_title("Player: bodies: log").count() == 1
    opened.context.close()
    assert opened.errors == []


def test_a_page_of_many_runs_stays_quick(browser, tmp_path):
    write_records(tmp_path / "few")
    for k in range(MANY):
        name = ("log", "cubic", "cubic_dynamic", "quadratic")[k % 4]
        shutil.copytree(tmp_path / "few" / name, tmp_path / "runs" / f"{k // 4:03}" / name)
        changed(tmp_path / "runs" / f"{k // 4:03}" / name, summary={"newton_iterations": 6 + k, "cond": conditions(100 + k)})
    begun = time.process_time(), sum(os.times()[2:4])
    assert verb.main([str(tmp_path / "runs")]) == 0
    made = time.process_time() - begun[0] + sum(os.times()[2:4]) - begun[1]
    out = tmp_path / "runs/report.html"
    opened = Opened(browser, out)
    clock = opened.page.context.new_cdp_session(opened.page)

    def seconds() -> float:
        """Processor time that the page has taken, so that what else the machine does is not counted."""
        return next(m["value"] for m in clock.send("Performance.getMetrics")["metrics"] if m["name"] == "TaskDuration")

    clock.send("Performance.enable", {"timeDomain": "threadTicks"})
    opened.page.reload()
    opened.page.locator("html[data-ready='yes']").wait_for(state="attached")  # no script of ours: the page refuses them
    opened.unfold()
    took = [seconds()]
    opened.page.evaluate("""() => { [...document.querySelectorAll('#runs thead button')].find((b) => b.textContent === 'Newton').click();
      document.body.offsetHeight; }""")
    took.append(seconds())
    opened.page.evaluate("""() => { const find = document.querySelector('#runs input'); find.value = 'quadratic';
      find.dispatchEvent(new Event('input', {bubbles: true})); document.body.offsetHeight; }""")
    took.append(seconds())
    ready, sort, find = took[0], took[1] - took[0], took[2] - took[1]
    print(json.dumps({"made_s": made, "megabytes": out.stat().st_size / 1e6, "ready_s": ready, "sort_s": sort, "filter_s": find}))
    assert opened.page.locator("#runs output").inner_text() == f"250 of {MANY} shown"
    assert out.stat().st_size < 5e6 and made < MAKE_S
    assert 0 < ready < READY_S and 0 < sort < SORT_S and 0 < find < SORT_S
    assert opened.errors == [] and set(opened.asked) == {out.as_uri()}
    opened.context.close()

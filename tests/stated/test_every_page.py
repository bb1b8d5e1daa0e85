"""On every page with numbers a disagreement, planted here, is told: with the same page, and with the others."""

import re

import pytest

from analysis.places import ROOT
from analysis.stated import check, counted, pages, whole_page


def other(number: str) -> str:
    """Another number of the same look."""
    digit = next(k for k in reversed(range(len(number))) if number[k].isdigit())
    return number[:digit] + str((int(number[digit]) + 1) % 10) + number[digit + 1 :]


def planted(text: str):
    """The page with a row, or a paragraph, that stands there twice, the second time with another number in one place."""
    lines = text.splitlines()
    for k, line in enumerate(lines):
        if line.startswith("|") and k and lines[k - 1].startswith("|") and not line.startswith("|---"):
            for found in re.finditer(r"(?<![\w.])\d[\d.]*(?![\w.])", line):
                yield [*lines[: k + 1], line[: found.start()] + other(found[0]) + line[found.end() :], *lines[k + 1 :]]
    for title, block in whole_page._blocks(text):
        if not block[0].startswith("|"):
            for found in re.finditer(r"\d+", " ".join(block)):
                said = " ".join(block)
                yield [*lines, "", f"## {title}" if title else "", "", said[: found.start()] + other(found[0]) + said[found.end() :]]


@pytest.mark.parametrize("page", pages.pages_of(ROOT))
def test_a_page_that_states_one_thing_twice_and_differently_is_told(page):
    text = (ROOT / page).read_text()
    assert check.contradictions(whole_page.everything(text, page)) == []
    for tried, lines in enumerate(planted(text)):
        told = check.contradictions(whole_page.everything("\n".join(lines), page))
        if told:
            assert len(told) <= 2 and told[0].count(page) >= 2
            return
        assert tried < 200
    pytest.fail(f"{page}: nothing could be planted")


CHANGES = [  # page, what stands there, what is planted, what is told of
    ("results/STRESS.md", "1349 of 1349 runs", "1349 of 1348 runs", "stress runs"),
    ("results/STRESS.md", "1349 of 1349 runs", "1348 of 1349 runs", "stress runs as expected"),
    ("results/STRESS.md", "26 of 26 relations", "25 of 26 relations", "stress relations that hold"),
    ("results/STRESS.md", "(5606 subjects)", "(5607 subjects)", "stress subjects"),
    ("results/CATALOGUE.md", "135 runs, 122 of which", "135 runs, 123 of which", "catalogue runs as expected"),
    ("results/CATALOGUE.md", "27 of 27;", "26 of 27;", "catalogue scenes"),
    ("results/CATALOGUE.md", "| belt | cubic | pin_infeasible |", "| belt | cubic | newton_stall |", "catalogue: outcome of belt"),
    ("results/WORK_PRECISION.md", "Failed or not valid, 4 of 286", "Failed or not valid, 3 of 286", "work-precision failed runs of bounce"),
    ("results/WORK_PRECISION.md", "286 runs and 8 of references", "294 runs and 8 of references", "work-precision runs of strip_on_disk"),
    ("results/WORK_PRECISION.md", "| log | 42 |", "| log | 41 |", "work-precision problems"),
    ("results/ENGINES.md", "3 with surfaces that cross in a frame", "2 with surfaces that cross in a frame", "newton vbd: crossing in a frame"),
    ("results/ENGINES.md", "100 of 100 ended ok", "100 of 101 ended ok", "mujoco cg: runs"),
    ("docs/engines.md", "in an obstacle, in 250 runs", "in an obstacle, in 300 runs", "mujoco, all variants: runs of jittered starts"),
    ("docs/engines.md", "Of MuJoCo's 25 runs", "Of MuJoCo's 24 runs", "mujoco, all variants: runs of the own start"),
    ("docs/verbs.md", "expected of each: 1349 runs", "expected of each: 1350 runs", "stress runs"),
    ("docs/jobs/cluster.md", "| 1048 |", "| 1034 |", "work-precision runs"),
    ("docs/work_precision_bounce.txt", "13 runs of every", "12 runs of every", "work-precision runs of bounce, of a formulation and solver"),
    ("docs/work_precision_profile.txt", "42 problems a", "41 problems a", "work-precision problems"),
]  # fmt: skip
OF_COUNTS = {"stress", "catalogue", "work_precision", "work_precision_caption", "engines", "engines_in_words", "mentions", "cluster"}


@pytest.fixture(scope="module")
def counts() -> dict:
    """Page -> what its readers of counts read."""
    return {page: [one for reader in pages._readers(page) if reader.__name__ in OF_COUNTS for one in reader((ROOT / page).read_text(), page)] for page in pages.pages_of(ROOT)}


def test_every_count_stands_in_two_places_that_agree(counts):
    found = [one for of in counts.values() for one in of]
    assert len(found) > 200 and check.contradictions(found) == []
    times = {one.quantity: sum(o.quantity == one.quantity for o in found) for one in found}
    assert [quantity for quantity, n in times.items() if n < 2] == []
    assert {reader.__name__ for page in counts for reader in pages._readers(page)} >= OF_COUNTS <= set(vars(counted))


@pytest.mark.parametrize(("page", "stands", "plant", "quantity"), CHANGES, ids=[f"{page} {plant}" for page, _, plant, _ in CHANGES])
def test_a_count_that_its_tables_or_another_page_do_not_have_is_told(counts, page, stands, plant, quantity):
    text = (ROOT / page).read_text()
    assert stands in text
    changed = [one for reader in pages._readers(page) if reader.__name__ in OF_COUNTS for one in reader(text.replace(stands, plant, 1), page)]
    told = check.contradictions([*(one for name, of in counts.items() if name != page for one in of), *changed])
    assert any(line.startswith((f"{quantity}:", f"{quantity} (")) and page in line for line in told), told

"""A number that stands with the same words under the same heading of one page is reported where it stands there otherwise, and counts also where
the tables, another page or the kept data have another one.
"""

import random
import re

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.pages.stated import check, counted, kept, pages, whole_page


def other(number: str) -> str:
    """Another number of the same look."""
    digit = next(k for k in reversed(range(len(number))) if number[k].isdigit())
    return number[:digit] + str((int(number[digit]) + 1) % 10) + number[digit + 1 :]


def paragraphs(text: str):
    """Heading and text of every paragraph and item of a list, cut here and not by the code under test."""
    title = ""
    for block in re.sub(r"(?ms)^```.*?^```$", "", text).split("\n\n"):
        for item in re.split(r"\n(?=\s*[-*] |\s*\d+\. |#|\|)", block.strip("\n")):
            if item.startswith("#"):
                title, _, item = item.lstrip("# ").partition("\n")
            if item.strip() and not item.startswith("|"):
                yield title, " ".join(item.split())


def planted(text: str, page: str) -> list[list[str]]:
    """Of every number of the page: its lines with the row, or the paragraph, a second time, and another number in that place."""
    lines, found = text.splitlines(), []
    for k, line in enumerate(lines):
        if line.startswith("|") and k and lines[k - 1].startswith("|") and not line.startswith("|---"):
            for number in re.finditer(r"(?<![\w.])\d[\d.]*(?![\w.])", line):
                found.append((lines[: k + 1], line, number, lines[k + 1 :]))
    for title, said in paragraphs(text) if page not in whole_page.ELSEWHERE else ():
        for number in re.finditer(r"\d+", said):
            found.append(([*lines, "", f"## {title}" if title else "", ""], said, number, []))
    return [[*above, said[: number.start()] + other(number[0]) + said[number.end() :], *below] for above, said, number, below in found]


TRIED = 12  # plants of a page
TOLD = 0.9  # share of them that is reported at least, over all pages; the others stand in what names a row, or in few words


def test_a_page_that_states_one_thing_twice_and_differently_is_told():
    """Each number of a page has the same chance to be among those that are tried."""
    told, tried = {}, 0
    for page in (page for page in pages.pages_of(ROOT) if page not in pages.NO_NUMBERS):
        text = (ROOT / page).read_text()
        assert check.contradictions(whole_page.everything(text, page)) == []
        every = planted(text, page)
        sample = random.Random(page).sample(every, min(TRIED, len(every)))
        if page in pages.NO_NUMBERS:
            continue
        assert sample, page
        faults = [check.contradictions(whole_page.everything("\n".join(lines), page)) for lines in sample]
        assert all(len(of) <= 2 and of[0].count(page) >= 2 for of in faults if of)
        told[page], tried = sum(map(bool, faults)), tried + len(sample)
    assert tried > 600 and sum(told.values()) >= TOLD * tried, (sum(told.values()) / tried, told)
    assert [page for page, n in told.items() if n == 0] == []


CHANGES = [  # page, what stands there, what is planted, what is reported
    ("results/STRESS.md", "1349 of 1349 runs", "1349 of 1348 runs", "stress runs"),
    ("results/STRESS.md", "1349 of 1349 runs", "1348 of 1349 runs", "stress runs as expected"),
    ("results/STRESS.md", "26 of 26 relations", "25 of 26 relations", "stress relations that hold"),
    ("results/STRESS.md", "(5606 subjects)", "(5607 subjects)", "stress subjects"),
    ("results/CATALOGUE.md", "160 runs, 149 of which", "160 runs, 150 of which", "catalogue runs as expected"),
    ("results/CATALOGUE.md", "32 of 32;", "31 of 32;", "catalogue scenes"),
    ("results/CATALOGUE.md", "| belt | cubic | pin_infeasible |", "| belt | cubic | newton_stall |", "catalogue: outcome of belt"),
    ("results/WORK_PRECISION.md", "Failed or not valid, 4 of 286", "Failed or not valid, 3 of 286", "work-precision failed runs of bounce"),
    ("results/WORK_PRECISION.md", "286 runs and 8 of references", "294 runs and 8 of references", "work-precision runs of strip_on_disk"),
    ("results/WORK_PRECISION.md", "| log | 42 |", "| log | 41 |", "work-precision problems"),
    ("results/ENGINES.md", "3 with surfaces that cross in a frame", "2 with surfaces that cross in a frame", "newton vbd: crossing in a frame"),
    ("results/ENGINES.md", "100 of 100 ended ok", "100 of 101 ended ok", "mujoco cg: runs"),
    ("docs/results/engines.md", "in an obstacle, in 250 runs", "in an obstacle, in 300 runs", "mujoco, all variants: runs of jittered starts"),
    ("docs/results/engines.md", "Of MuJoCo's 25 runs", "Of MuJoCo's 24 runs", "mujoco, all variants: runs of the own start"),
    ("docs/guides/verbs.md", "expected of each: 1349 runs", "expected of each: 1350 runs", "stress runs"),
    ("docs/guides/cluster.md", "| 1048 |", "| 1034 |", "work-precision runs"),
    ("docs/guides/cluster.md", "| 12423 |", "| 12422 |", "claims runs"),
    ("docs/guides/cluster.md", "| 2325 |", "| 2324 |", "gap map runs"),
    ("docs/guides/cluster.md", "| 525 |", "| 524 |", "Pareto runs"),
    ("docs/guides/cluster.md", "| 1152 |", "| 1151 |", "ablation runs"),
    ("results/GAP_MAP.md", "4864 cells, 2325 runs", "4864 cells, 2326 runs", "gap map runs"),
    ("results/GAP_MAP.md", "**2007 of 4864 cells", "**2006 of 4864 cells", "gap map cells: not run"),
    ("results/GAP_MAP.md", "2241 reached a gap", "2242 reached a gap", "gap map cells: gap"),
    ("docs/results/which-barrier.md", "Of 4864 cells", "Of 4865 cells", "gap map cells"),
    ("docs/work_precision_bounce.txt", "13 runs of every", "12 runs of every", "work-precision runs of bounce, of a formulation and solver"),
    ("docs/work_precision_profile.txt", "42 problems a", "41 problems a", "work-precision problems"),
]  # fmt: skip
OF_COUNTS = {"stress", "catalogue", "work_precision", "work_precision_caption", "engines", "engines_in_words", "mentions", "cluster", "gap_map"}


@pytest.fixture(scope="module")
def counts() -> dict:
    """Page -> what its readers of counts read; and what the kept data say."""
    of_data = [one for one in kept.kept(ROOT / "results") if ", log over " not in one.quantity and "slope" not in one.quantity]
    return {"kept": of_data} | {page: [one for reader in pages._readers(page) if reader.__name__ in OF_COUNTS for one in reader((ROOT / page).read_text(), page)] for page in pages.pages_of(ROOT)}


def test_every_count_stands_in_two_places_that_agree(counts):
    found = [one for of in counts.values() for one in of]
    assert len(found) > 200 and check.contradictions(found) == []
    times = {one.quantity: sum(o.quantity == one.quantity for o in found) for one in found}
    assert [quantity for quantity, n in times.items() if n < 2] == []
    assert {reader.__name__ for page in counts if page != "kept" for reader in pages._readers(page)} >= OF_COUNTS <= set(vars(counted))


@pytest.mark.parametrize(("page", "stands", "plant", "quantity"), CHANGES, ids=[f"{page} {plant}" for page, _, plant, _ in CHANGES])
def test_a_count_that_its_tables_or_another_page_do_not_have_is_told(counts, page, stands, plant, quantity):
    text = (ROOT / page).read_text()
    assert stands in text
    changed = [one for reader in pages._readers(page) if reader.__name__ in OF_COUNTS for one in reader(text.replace(stands, plant, 1), page)]
    told = check.contradictions([*(one for name, of in counts.items() if name != page for one in of), *changed])
    assert any(line.startswith((f"{quantity}:", f"{quantity} (")) and page in line for line in told), told


@pytest.mark.parametrize(("row", "head"), [("| 0.01 | below 1000 |", "raw cond, log over cubic"), ("| 0.01 | 5 | 108 to 4704 |", "raw cond, slope of log over cubic"), ("| off | 0.01 |", "raw cond, log over cubic")])
def test_a_table_by_size_that_the_kept_data_do_not_have_is_told(row, head):
    text, of_data = (ROOT / "results/GAP_MAP.md").read_text(), list(kept.kept(ROOT / "results"))
    assert check.contradictions([*of_data, *pages.pair(text, "GAP_MAP.md")]) == []
    [line] = [line for line in text.splitlines() if line.startswith(row)]
    number = pages.NUMBER.search(line)
    changed = line[: number.start()] + other(number[0]) + line[number.end() :]
    [told] = check.contradictions([*of_data, *pages.pair(text.replace(line, changed), "GAP_MAP.md")])
    assert head in told and "in studies/gap_map.jsonl" in told and "in GAP_MAP.md" in told


def test_a_study_without_a_name_is_a_fault():
    text = (ROOT / "docs/guides/cluster.md").read_text().replace("| ablation |", "| another |")
    with pytest.raises(UserError, match="docs/guides/cluster.md: found a row 'another'"):
        list(counted.cluster(text, "docs/guides/cluster.md"))

"""Numbers with an identity: the strongest is the headline, and two statements on one thing that disagree are found."""

from dataclasses import replace

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.pages.claims import parts_file
from barrierbench_analysis.pages.readme import slices, verb
from barrierbench_analysis.pages.reference import MARK
from barrierbench_analysis.pages.stated import check, pages, several
from barrierbench_analysis.pages.stated.statement import tables
from barrierbench_analysis.pages.stated.number import OFF, OWN, SAME, Number, strongest

ONE = Number("cond_p95", "log", "cubic", 0.01, OFF, "H1", False, 5, (9, 576), 7.3, 3.95, 13.5, True, "", "contact_slices")
CONFIRMED = replace(ONE, confirmed=True, scenes=10, unknowns=(108, 600), value=1.95, lower=1.10, upper=3.47, sweep="shells_slices")


@pytest.fixture(scope="module")
def kept() -> dict:
    return verb.kept()


def test_confirmed_stands_before_exploratory_and_larger_before_smaller():
    assert strongest([ONE, CONFIRMED], "x") is CONFIRMED
    assert strongest([replace(ONE, scenes=50), CONFIRMED], "x") is CONFIRMED  # however many scenes
    more = replace(ONE, scenes=7)
    assert strongest([more, ONE], "x") is more
    finer = replace(ONE, unknowns=(9, 5000))
    assert strongest([ONE, finer], "x") is finer
    with pytest.raises(UserError, match="no number"):
        strongest([], "cond at theta 0.01")
    with pytest.raises(UserError, match="several quantities or conditions"):
        strongest([ONE, replace(CONFIRMED, theta=0.1)], "x")


def test_every_headline_is_of_the_strongest_evidence(kept):
    """docs/results/which-barrier.md states each with its interval; among the candidates are confirmed and exploratory ones, or the rule has had nothing to choose."""
    page = " ".join((ROOT / "docs/results/which-barrier.md").read_text().split())
    found = slices.headlines(kept["slices"])
    assert len(found) == 8 + 9
    for headline in found:
        assert headline.number == strongest(headline.candidates, "headline") and str(headline.number) in page
        assert headline.number.lower is not None
    chosen = [h for h in found if len(h.candidates) > 1]
    assert len(chosen) == 8 and all(h.number.confirmed and not all(c.confirmed for c in h.candidates) for h in chosen)


def test_where_a_headline_is_exploratory_a_confirmed_number_of_the_same_stands_beside_it(kept):
    """Of all studies, also where only comparable runs count: contact and limiter of one form at theta 0.1."""
    page, beside = " ".join((ROOT / "docs/results/which-barrier.md").read_text().split()), 0
    for headline in slices.headlines(kept["slices"]):
        mine = headline.number
        rivals = [n for n in kept["several"] if (n.quantity, n.conditions) == (mine.quantity, mine.conditions)]
        assert rivals
        for rival in rivals:
            if rival.confirmed and not mine.confirmed:
                assert f"confirmed scenes have cond {rival} at theta {rival.theta:g}" in page
                beside += 1
    assert beside > 0


def test_where_a_page_ranks_shapes_by_exploratory_numbers_it_says_so():
    """docs/results/which-barrier.md: the sentences of the gap map, beside which confirmed numbers of log and cubic exist."""
    before, _, _ = (ROOT / "docs/results/which-barrier.md").read_text().partition("<!-- numbers: gap_map -->")
    assert before.rstrip().endswith("All of this is exploratory; of the log beside the cubic the confirmed numbers are the first results of this page.")


def test_the_table_of_verdicts_has_the_confirmed_number():
    """results/CLAIMS.md: where scenes confirmed a claim, or refuted it, its number is theirs."""
    rows = [cells for _, heads, cells in tables((ROOT / "results/CLAIMS.md").read_text()) if heads[0] == "claim" and "confirmed" in heads]
    judged = [cells for cells in rows if cells[3] not in ("-", "closed form")]
    assert len(judged) > 15
    assert [cells[0] for cells in judged if pages.NUMBER.search(cells[5]) and not cells[5].endswith("confirmed scenes")] == []


def test_pages_hold_no_two_statements_that_disagree(kept):
    found = pages.by_page(ROOT)
    assert len(found) > 75 and all(of or page in pages.NO_NUMBERS for page, of in found.items()) and sum(map(len, found.values())) > 12000
    assert {"README.md", "results/CLAIMS.csv", "docs/results/claims.md", "results/STRESS.md", "results/CATALOGUE.md", "results/ENGINES.md", "results/WORK_PRECISION.md"} <= set(found)
    assert set(found) - {"results/CLAIMS.csv"} == {path.relative_to(ROOT).as_posix() for path in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "docs").rglob("*.txt"), *(ROOT / "results").glob("*.md")] if MARK not in path.read_text()}
    assert check.faults(ROOT, kept["several"]) == []


LAW = (
    "Raw: the law, contact making both: {} of 1868 pairs, ln(measured/predicted) +0.11 in the mean with standard deviation 0.53 (a factor {});"
    " the law with its floor, contact making the log's: 187 of 1868 pairs, ln(measured/predicted) +0.03 in the mean with standard deviation 0.24 (a factor 1.27);"
)


def test_a_caption_with_another_scatter_than_its_page_is_told():
    page, caption = (list(pages._law(LAW.format(n, factor), name)) for n, factor, name in ((92, 1.70, "page.md"), (32, 2.33, "caption.txt")))
    assert check.contradictions([*page, *page]) == []
    [told] = check.contradictions([*page, *caption])
    assert "the law, contact making both (Raw)" in told and "a factor 1.7) in page.md" in told and "a factor 2.33) in caption.txt" in told


def claim(evidence: str, sweep: str, number: str, scenes: str, verdict: str = "holds") -> dict:
    value, lower, upper = number.split()
    return {"claim": "H1", "evidence": evidence, "measures": "95th percentile of cond over a run, raw: log / cubic", "number": value, "lower": lower, "upper": upper, "interval": "95% over scenes",
            "conditions": "theta 0.1, limit off", "counted_and_left_out": "21 pairs count", "by_scene": scenes, "verdict": verdict, "sweep": sweep}


def read(*rows: dict) -> list:
    return list(pages._claims(parts_file.as_csv(parts_file.COLUMNS, iter(rows)), "c.csv"))


def test_parts_of_claims_are_read_with_slice_scenes_and_evidence():
    one = claim("exploratory", "a", "1.2 0.9 1.6", "ball 1 (1 to 1 at 3, n = 3); big-box 2 (1 to 3 at 3, n = 3)")
    first, second = read(one, claim("confirmed", "b", "1.3 1 1.7", "bar 1 (1 to 1 at 3, n = 3)", "not decided"), {**one, "interval": "least and largest"})
    assert (first.page, first.quantity, first.number, first.verdict) == ("c.csv, H1, exploratory", "95th percentile of cond over a run, raw: log / cubic", "1.2 [0.9, 1.6]", "holds")
    assert first.conditions == "theta 0.1, limit off; ball, big-box; 21 pairs count; `a`" and second.page == "c.csv, H1, confirmed" and second.verdict == "not decided"
    [told] = check.contradictions([first, second, *read({**one, "number": "1.25"})])
    assert "1.2 [0.9, 1.6], holds in c.csv, H1, exploratory; 1.25" in told
    assert check.contradictions([first, *read({**one, "number": "1.25", "by_scene": one["by_scene"].replace("ball", "sack")})]) == []


def test_a_page_in_which_nothing_is_read_is_no_page_without_faults(tmp_path):
    for page in pages.READERS:
        (tmp_path / page).parent.mkdir(exist_ok=True, parents=True)
        (tmp_path / page).write_text((ROOT / page).read_text())
    assert set(pages.by_page(tmp_path)) == set(pages.READERS)
    (tmp_path / "docs/more.md").write_text("# More\n\nNothing here.\n")
    [told] = check.silent(pages.by_page(tmp_path))
    assert told.startswith(f"docs/more.md: no statement is read, of {len(pages.READERS) + 1} pages")
    (tmp_path / "results/GAP_MAP.md").write_text("# Gap map\n\nwritten otherwise\n")
    with pytest.raises(UserError, match="results/GAP_MAP.md: no statement is found of the kind map"):
        pages.by_page(tmp_path)


def root_with(tmp_path, several_page: str, claims: str, ablation: str):
    (tmp_path / "docs/results").mkdir(parents=True), (tmp_path / "results").mkdir()
    for name, text in ((check.SEVERAL, several_page), ("results/CLAIMS.md", claims), ("results/ABLATION.md", ablation)):
        (tmp_path / name).write_text(text)
    return tmp_path


def test_what_one_study_decides_and_another_leaves_open_has_to_lead_to_both(tmp_path):
    """The two-stage activation: K16 leaves it open, the ablation decides it after block Jacobi."""
    k16 = Number("bj_p95", "log", "two_stage", 0.1, SAME, "K16", True, 9, (108, 600), 0.995, 0.919, 1.08, False, "", "shells_shapes")
    effect = replace(k16, limit=OFF, study="ablation", confirmed=False, value=0.78, lower=0.636, upper=0.958, decided=True, sweep="")
    assert several.apart([k16, effect]) == {("bj_p95", "two_stage"): {0, -1}} and several.apart([k16, k16]) == {}
    link = "[x](../docs/results/several-studies.md)"
    root = root_with(tmp_path, "\n".join(several.table_lines([k16, effect])), f"| [K15](x) | a {link} |\n| [K16](x) | not decided |\n| [K17](x) | b {link} |\n", link)
    [told] = check.unreconciled(root, [k16, effect])
    assert told.startswith("results/CLAIMS.md, K16: bj_p95 of the log over two_stage is decided differently") and check.SEVERAL in told
    (root / "results/CLAIMS.md").write_text(f"| [K16](x) | not decided {link} |\n")
    assert check.unreconciled(root, [k16, effect]) == []
    (root / check.SEVERAL).write_text("no table")
    assert check.unreconciled(root, [k16, effect]) == ["docs/results/several-studies.md: no row on two_stage, of which studies decide bj_p95 differently"]


def test_the_table_has_a_number_of_claims_once_and_the_confirmed_one():
    lines = several.table_lines([ONE, CONFIRMED, replace(CONFIRMED, study="K3"), replace(ONE, study="gap map", sweep="", places="22 places of 6 scenes", decided=False), replace(ONE, limit=OWN)])
    rows = [line for line in lines if line.startswith("| `cubic`")]
    assert rows[0].startswith("| `cubic` | H1, K3, confirmed | theta 0.01, no strain limit | 10, 108 to 600 | **1.95 [1.1, 3.47]** | - ")
    assert len(rows) == 3 and "gap map, exploratory" in rows[1] and "| 7.3 [3.95, 13.5] |" in rows[1] and OWN in rows[2]
    assert several.shapes_of_table("\n".join(lines)) == {"cubic"}


def test_a_number_of_the_first_page_that_no_study_has_is_told(tmp_path):
    known = [pages.Statement("results/x.md", "q", "c", "1.95 [1.1, 3.47]"), pages.Statement("results/x.md", "q", "d", "0.5 [0.25, 0.8]")]
    root = root_with(tmp_path, "Turned it is 2 [1.25, 4], in few digits 1.9 [1.1, 3.5].", "", "")
    (root / "README.md").write_text("It is 1.95 [1.1,\n3.47], and once it was 7.3 [3.95, 13.5].")
    for page in check.PROSE[1:]:
        (root / page).write_text("It is 1.95 [1.1, 3.47].")
    [told] = check.unfounded(root, known, [])
    assert told == "README.md: 7.3 [3.95, 13.5]: no page of results/ has this number"
    assert check.unfounded(root, known, [ONE]) == []
    (root / check.SEVERAL).write_text("no number")
    with pytest.raises(UserError, match=f"{check.SEVERAL}: no number with an interval"):
        check.unfounded(root, known, [ONE])


@pytest.mark.parametrize("number, digits", [("1.95", 3), ("1.1", 2), ("0.0114", 3), ("2", 2), ("1.53e+07", 3), ("-0.02", 2)])
def test_a_page_may_state_fewer_digits(number, digits):
    assert check.digits(number) == digits

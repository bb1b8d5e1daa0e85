"""README.md and docs/results: every snippet works, and generated numbers are those of the kept records."""

import json
import math
from dataclasses import replace
from pathlib import Path

import re

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.pages.readme import verb as readme
from barrierbench_analysis.studies.claims.entry import read_claim, read_sweep
from barrierbench_analysis.studies.claims.inputs import inputs_of
from barrierbench_analysis.studies.claims.table import Runs, Table
from barrierbench_analysis.studies.rules.gap_map.table import COLUMNS, Map
from barrierbench_analysis.pages.readme import templates as gap_map
from barrierbench_analysis.pages.readme import numbers, slices, snippets, templates
from barrierbench_analysis.pages.stated import sources
from barrierbench_analysis.pages.stated.number import OFF, OWN, SAME, Number

ROOT = Path(__file__).resolve().parents[2]


def row(group, series, **more):
    return {"group": group, "series": series, "outcome": "ok", "verdict": "comparable", "step_solver": "line_search", "crossings": 0, "violations": 0, "unproven": 0, "judged": 9,
            "steps": 12, "scale": None, "valid": True, "cond_raw_median": 5000.0, "cond_raw_max": 44000.0, "cond_bj_median": 351.0, "cond_bj_max": 698.0, "newton_iterations": 83,
            "probe_pcg": 142.0, "gap_min_rel": 0.1024, "cond_raw_p95": 20000.0, "cond_steps": {1: 400.0, 2: 900.0}, "run": "0" * 64} | more


def kept(**changed):
    runs = [row("demo_drape", "log"), row("demo_long", "formula log"), row("demo_long", "formula cubic", cond_raw_max=11000.0, cond_raw_median=10000.0, cond_raw_p95=8000.0, probe_pcg=157.0, cond_steps={0: 1.0, 1: 800.0, 2: 300.0}),
            row("demo_long", "mesh log", probe_pcg=12.0), row("demo_long", "mesh cubic", cond_raw_max=22000.0, verdict="not_comparable"),
            row("demo_drape", "cubic_dynamic published", step_solver="accumulated_toi", steps=120),
            row("demo_drape", "cubic_dynamic", outcome="newton_stall", steps=10, gap_min_rel=None, **changed),
            row("demo_drape", "cubic_dynamic x s", scale=2.41, verdict="not_comparable"), row("demo_article", "log", step_solver="article_literal", crossings=7)]
    about = {"processor": "Some CPU", "cores": "2", "blas_kernel": "Haswell", "compiler": "g++ 12", "flags": "-O2", "commit": "0123456789abcdef", "days": "2026-01-02", "runs": 5,
             "long": {"duration_s": 0.25, "every": 7}}
    return {"schema": numbers.NAME, "about": about, "runs": runs}


def rows_of(name: str, ratios, **changed) -> Runs:
    """A run of every case of a sweep over theta and the limit. ratios: theta, whether there is a limit -> the log's condition number over the cubic's."""
    sweep, rows = read_sweep(name), []
    for note, (scene, level, case, seed) in sweep.cases.items():
        of = sweep.more[note]
        ratio = ratios(of["theta"], of["enabled"]) if case == "log" else 1.0
        row = {"scene": scene, "level": level, "case": case, "seed": seed, "outcome": "ok", "comparability": "not_comparable", "gap_rel": 0.1, "run": note, "pair": "", "gaps": {},
               "cond_p95": 100.0 * ratio, "cond_bj_p95": 50.0, "pcg_probe": 10.0, **of}
        if scene == "block" and of["theta"] < 0.1 and not of["enabled"] and case == "cubic":
            row |= {"outcome": "stall_overload"}
        rows.append(row | changed)
    return Runs({"sha256": sweep.sha256, "inputs_sha256": inputs_of(sweep), "unknowns": "108 to 600" if name.startswith("shells") else "9 to 576"}, rows)


@pytest.fixture
def alone(monkeypatch):
    """The parts of the claim over theta and the limit without its other parts, whose sweeps would be needed too."""
    whole = read_claim(slices.CLAIM)
    part = replace(whole, parts=tuple(p for p in whole.parts if p.get("sweep") == "contact_slices"))
    monkeypatch.setattr(slices, "read_claim", lambda _: part)
    return part


def of_slices(**changed) -> Table:
    """Tuned on: the log's condition number is 2/theta^(1/2) times the cubic's without a limit, and 1.5 times with one; but in block."""
    return Table({"contact_slices": rows_of("contact_slices", lambda theta, limited: 1.5 if limited else 2 / math.sqrt(theta), **changed)})


def the_map() -> Map:
    """Two places of two scenes, in which the log takes 4 times the cubic's cond, 1.2 times its PCG and 1.5 times its Newton iterations with limits of their own forms."""
    every = []
    for scene in ("a", "b"):
        for theta in slices.LIKE:
            for shape, factor in (("log", 1.0), ("cubic", 0.0)):
                row = dict.fromkeys(COLUMNS) | {"scene": scene, "resolution": "1", "shape": shape, "limit": "on", "theta": theta, "outcome": "ok", "gap": theta, "unknowns": 100}
                every.append(row | {"cond_p95": 4.0**factor, "bj_p95": 3.0**factor, "pcg": 1.2**factor, "newton": 1.5**factor})
    return Map({"shapes": [{"label": s, "shape": s, "argument": "gap"} for s in ("log", "cubic")], "main": ["log", "cubic"], "gaps": list(slices.LIKE), "limits": ["on"]}, every)


def gathered() -> dict:
    number = Number("cond_p95", "log", "cubic", 0.5, OFF, "H1", True, 10, (108, 600), 1.5, 1.1, 2.0, True, "", "shells_slices")
    like = [{m: replace(number, metric=m, theta=theta, limit=OWN, study="gap map", confirmed=False, sweep="", places="2 places of 2 scenes") for m in slices.LIKE_METRICS} for theta in slices.LIKE]
    return {"slices": {limit: [slices.Headline(replace(number, limit=limit, theta=theta), (), 0, 30) for theta in (0.5, 0.1)] for limit in slices.AXIS}, "like": like, "confirmed": [], "size": ["Sizes."]}


def everything():
    at_size = dict.fromkeys(("sentences", "by_size", "arms_s", "verdicts"), "| b |")
    return kept() | {"answer": "| a |", "at_size": at_size, "slices": gathered(), "gap_map": ["With no limit raw 0.01.", "Of 4 cells 3 are decided."], "several": [gathered()["slices"][OFF][0].number],
                     "cost": [{"study": "claims", "command": "./bench study claims", "runs": 3, "core_s": 7200.0}]}


def test_slices_are_those_of_theta_and_limit(alone):
    found = slices.gather(of_slices(), the_map())
    off, on = (found["slices"][limit] for limit in (OFF, SAME))
    assert [h.number.theta for h in off] == [0.5, 0.1, 0.01, 0.001] and not any(h.number.confirmed for h in off)
    assert [h.number.value for h in off] == pytest.approx([2 / math.sqrt(t) for t in (0.5, 0.1, 0.01, 0.001)])
    assert [h.number.value for h in on] == pytest.approx([1.5] * 4)
    assert [(h.number.scenes, h.failed, h.of) for h in off] == [(7, 0, 21), (7, 0, 21), (6, 3, 21), (6, 3, 21)]
    text = " ".join(" ".join(slices.sentences(found, 140)).split())
    assert text.startswith("1. Forces are made equal") and "2.83 [2.83, 2.83], 6.32 [6.32, 6.32], 20 [20, 20] and 63.2 [63.2, 63.2] times the cubic's" in text
    assert "6 to 7 scenes of 9 to 576 unknowns, exploratory; the cubic, whose force has a largest value, did not get through 6 of 84 runs" in text
    assert "2. With a strain limit there are two questions." in text and "cond is 4 [4, 4], 4 [4, 4] and 4 [4, 4] times the cubic's, PCG takes 1.2 [1.2, 1.2]" in text
    assert "(gap map, exploratory; in the 2 places of 2 scenes, 2 places of 2 scenes and 2 places of 2 scenes in which both got through)" in text


def test_a_headline_is_of_the_confirmed_scenes_where_there_are_any(alone):
    both = of_slices()
    both.sweeps["shells_slices"] = rows_of("shells_slices", lambda theta, limited: 1.2 if limited else 1.3)
    both.sweeps["shells_slices"].about["first_started_utc"] = "2026-11-24T14:10:51.333Z"
    slices.confirmation, before = (lambda claim, _: [{**part, "sweep": "shells_slices"} for part in claim.parts]), slices.confirmation
    sources.confirmation, kept_ = slices.confirmation, sources.confirmation
    try:
        found = slices.gather(both, the_map())
    finally:
        slices.confirmation, sources.confirmation = before, kept_
    for limit, value in ((OFF, 1.3), (SAME, 1.2)):
        assert [h.number.value for h in found["slices"][limit]] == pytest.approx([value] * 4)
        assert all(h.number.confirmed and h.number.scenes == 10 and (h.failed, h.of) == (0, 30) and len(h.candidates) == 2 for h in found["slices"][limit])
    text = " ".join(" ".join(slices.sentences(found, 140)).split())
    assert "10 scenes of 108 to 600 unknowns, confirmed: scenes that no rule was tuned on; the cubic got through all 120 runs" in text and "2.83" not in text


def test_where_most_scenes_are_alike_it_is_said(alone):
    """A mean near 1 over scenes that contact does not reach says nothing of the barriers."""
    runs = rows_of("contact_slices", lambda theta, limited: 1.01 if theta == 0.5 else 3.0)
    text = " ".join(" ".join(slices.sentences(slices.gather(Table({"contact_slices": runs}), the_map()), 140)).split())
    assert "The two differ by less than 2% in most scenes (7 of 7 at theta 0.5): there contact hardly changes it." in text


def test_slices_without_runs_are_no_sentence(alone):
    of_another_sweep, too_few = of_slices(), of_slices()
    of_another_sweep.sweeps["contact_slices"].about["sha256"] = "0" * 64
    too_few.sweeps["contact_slices"].rows.pop()
    for table, why in ((Table(), "504 of 504 records"), (of_another_sweep, "are of another"), (too_few, "1 of 504 records")):
        with pytest.raises(UserError, match=f"contact_slices.*{why}|{why}.*contact_slices"):
            slices.gather(table, the_map())
    with pytest.raises(UserError, match="cond_p95 of log over cubic at theta 0.5, no strain limit: no number of it is there"):
        slices.gather(of_slices(outcome="newton_stall"), the_map())
    with pytest.raises(UserError, match="no place in which both got through"):
        slices.gather(of_slices(), Map(the_map().about, [row | {"outcome": "newton_stall"} for row in the_map().rows]))


def test_the_table_has_every_run_and_names_its_processors():
    lines = templates.demo_table(kept())
    text = " ".join(lines)
    assert "Some CPU" in text and "class of processors" in text and "0123456789" in text and "2026-01-02" in text
    assert "| log | ok | 5.0e3, 4.4e4 | 351, 698 | 83 | 142 | 0.102 |" in lines
    assert any(line.startswith("| cubic_dynamic (ours: per iteration, to convergence) | newton_stall in step 9 |") and line.endswith("| - |") for line in lines)
    assert any(line.startswith("| cubic_dynamic x s (s = 2.4) | ok, not comparable |") for line in lines)
    assert len([line for line in lines if line.startswith("| ")]) == 1 + 4


def said(numbers_):
    return " ".join(" ".join(templates.result_sentences(everything() | numbers_)).split())


def test_the_sentences_say_what_the_numbers_say():
    text = said(kept())
    assert "In all 7 runs" in text and "as a formula the logarithm's median is 0.5, its 95th percentile 2.5 and its largest 4 times the cubic's" in text and "142 against 157" in text
    assert "as a mesh the logarithm's median is 1, its 95th percentile 1 and its largest 2 times" in text and "12 against 142" in text and "with the mesh the cubic's contacts rest at other gaps" in text
    assert "stops in time step 9 (`newton_stall`)" in text and "of our 1 variants" in text and "1 end `ok`" in text and "ends `ok` after 120 steps" in text
    text = said(kept(crossings=1))
    assert "In 1 of 7 runs" in text and "cubic_dynamic of demo_drape" in text
    nothing_judged = kept()
    nothing_judged["runs"][0]["judged"] = 0
    assert "In 1 of 7 runs" in said(nothing_judged)


def test_the_drape_is_judged_by_steps_that_end_in_contact_with_both():
    text = " ".join(templates.drape_sentences(everything()))
    assert "in 1 of 2 with the sphere as a formula (0.5 to 3 times the cubic's)" in text and "in 0 of 2 with the sphere as a mesh (1 to 1 times" in text
    never = kept()
    for one in never["runs"]:
        one["cond_steps"] = {}
    with pytest.raises(UserError, match="no time step ends in contact"):
        templates.drape_sentences(everything() | never)


def test_only_generated_parts_change_and_an_unknown_one_is_refused(tmp_path):
    page = "before\n<!-- numbers: result -->\nold\n<!-- /numbers -->\nafter <!-- numbers -->\n"
    made = templates.filled(page, everything(), "a.md")
    assert made.startswith("before\n<!-- numbers: result -->\n1. In all") and made.endswith("<!-- /numbers -->\nafter <!-- numbers -->\n") and "old" not in made
    assert templates.filled(made, everything(), "a.md") == made
    with pytest.raises(UserError, match="a.md: .*other.*allowed: answer, demo, result, drape, slices"):
        templates.filled(page.replace("result", "other"), everything(), "a.md")


def test_kept_numbers_come_back_as_they_were(tmp_path):
    path = tmp_path / "demo.json"
    numbers.write(kept(), path)
    assert numbers.read(path) == kept()
    for text in ("", "{", "[]", '{"schema": "x"}'):
        path.write_text(text)
        with pytest.raises(UserError, match="demo.json"):
            numbers.read(path)
    with pytest.raises(UserError, match="./bench demo"):
        numbers.read(tmp_path / "none.json")


def test_pages_whose_numbers_are_others_are_named(tmp_path):
    for page, parts in templates.PARTS.items():
        (tmp_path / page).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / page).write_text("".join(f"<!-- numbers: {name} -->\nold\n<!-- /numbers -->\n" for name in parts))
    assert len(readme.stale(tmp_path, everything())) == len(templates.PARTS) == 6
    assert readme.write_pages(tmp_path, everything()) == list(readme.PAGES)
    assert readme.stale(tmp_path, everything()) == [] and readme.write_pages(tmp_path, everything()) == []


def test_a_page_that_lost_its_marks_is_no_page_that_is_right(tmp_path):
    for page in templates.PARTS:
        (tmp_path / page).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / page).write_text("")
    (tmp_path / "README.md").write_text("<!-- numbers: answer -->\nold\n")  # the end is gone
    (tmp_path / "docs/guides/cluster.md").write_text("<!-- numbers: cost -->\nold\n<!-- /numbers -->\n")
    found = readme.stale(tmp_path, everything())
    lost = [page for page in templates.PARTS for _ in templates.PARTS[page] if page != "docs/guides/cluster.md"]
    assert [line.partition(":")[0] for line in found] == [*lost, "docs/guides/cluster.md"]
    assert "no <!-- numbers: result -->" in found[len(templates.PARTS["README.md"])] and "its numbers are not" in found[-1]
    with pytest.raises(UserError, match="README.md: no <!-- numbers: answer -->"):
        readme.write_pages(tmp_path, everything())


def test_a_sentence_on_no_run_is_none():
    none = kept()
    none["runs"] = [one | {"step_solver": "article_literal"} for one in none["runs"]]
    with pytest.raises(UserError, match="no run with the step solver line_search"):
        templates.result_sentences(everything() | none)


@pytest.mark.parametrize("fence", ["bash", "console", "c++", "py", "jsonc x=1"])
def test_a_fence_that_nothing_checks_is_a_fault(fence):
    page = f"text\n```\nshown\n```\n```text\nshown\n```\n```{fence}\nls\n```\n"
    found = snippets.faults(page, "a.md")
    assert found == [f"a.md:9: a fence of {fence!r}, which nothing checks; allowed: sh, json, python, and text for what is no snippet"]


def test_numbers_are_gathered_from_records_of_the_program(program, tmp_path):
    from barrierbench_analysis.tables.records import load
    from small_sweep import sweep_of

    records = load(sweep_of(program, tmp_path))
    rows = numbers._rows(records, numbers.summary_table(records))
    assert len(rows) == 2 and {row["series"] for row in rows} == {"log", "cubic"}
    for found in rows:
        assert found["outcome"] == "ok" and found["steps"] == 30 and found["judged"] > 0
        assert found["cond_steps"] and all(1 <= value <= found["cond_raw_max"] for value in found["cond_steps"].values())
        assert 1 <= found["cond_raw_median"] < found["cond_raw_p95"] <= found["cond_raw_max"]
    assert json.loads(json.dumps(rows)) and numbers._about(records.runs)["runs"] == 2
    with pytest.raises(UserError, match="no records of demo_drape"):
        numbers.gather(tmp_path / "out")


# --- snippets

GOOD = """```sh
./bench list shapes                    # answers
echo '{"kind": "rho", "shape": "cubic", "u": 0.5}' | ./bench eval
./bench check configs/scenes/resting_block_1d.json --set /time/steps=3 && ./bench help record
./bench draw figures results/runs/demo
```
```python
from barrierbench_analysis import load
records = load("results/runs/demo")
print(records.runs[["outcome", "gap_min_rel_min"]])
```
"""


@pytest.mark.parametrize("wrong, place, said", [
    ("", "", ""),
    ("```sh\n\n./bench lst shapes\n```\n", "a.md:14", "lst"),
    ("```sh\n./bench run configs/scenes/none.json\n```\n", "a.md:13", "configs/scenes/none.json: not there"),
    ("```sh\n./bench run configs/scenes/drape.json --set /time/stps=3\n```\n", "a.md:13", "/time/stps"),
    ("```sh\n./bench run configs/scenes/drape.json --st /time/steps=3\n```\n", "a.md:13", "--st"),
    ("```sh\n./bench test -L nowhere\n```\n", "a.md:13", "no tests of a module nowhere"),
    ("```sh\n./bench test -R barriers\n```\n", "a.md:13", "-L takes a module"),
    ("```sh\npython3 examples/ci/toy_solver.py --record run.json\n```\n", "a.md:13", ".venv/bin/python"),
    ("```json\n{\"schema\": \"barrierbench.sweep/1\", \"name\": \"a\", \"base\": \"../scenes/drape.json\", \"axes\": [{\"pointer\": \"/time/steps\", \"values\": [1]}]}\n```\n", "a.md:13", "../scenes/drape.json"),
    ("```sh\n./bench study score log --jobs 2 --thetas 0.5\n```\n", "a.md:13", "score has no --thetas"),
    ("```sh\necho '{\"kind\": \"none\"}' | ./bench eval\n```\n", "a.md:13", "kind"),
    ("```json\n{\"schema\": \"barrierbench.sweep/1\", \"name\": \"a\", \"base\": \"configs/scenes/drape.json\", \"axes\": [{\"pointer\": \"/time/x\", \"values\": [1]}]}\n```\n", "a.md:13", "/time/x"),
    ("```json\n{\"schema\":\n```\n", "a.md:13", "not JSON"),
    ("```python\nfrom barrierbench_analysis import load\nload('results/runs/demo').runs['gap_min_rel']\n```\n", "a.md:13", "KeyError"),
])
def test_a_snippet_that_does_not_work_is_named_with_its_line(program, wrong, place, said):
    found = snippets.faults(GOOD + wrong, "a.md")
    if not wrong:
        assert found == []
    else:
        assert len(found) == 1 and found[0].startswith(place) and said in found[0], found


@pytest.mark.parametrize("line, faulty", [("/home/of/nobody/card/run.sh --out /home/of/nobody/raw", False), ("~/of/nobody.sh", False), ("experiments/of_nobody.sh", True), ("./of_nobody.sh", True), ("of_nobody x", True)])
def test_a_path_outside_the_tree_is_a_placeholder(line, faulty):
    """Whether it is there says what somebody once made on this machine."""
    assert bool(snippets.faults(f"```sh\n{line}\n```\n", "a.md")) is faulty


@pytest.mark.parametrize("page", readme.pages_with_snippets(ROOT))
def test_every_snippet_of_the_pages_works(program, page):
    text = (ROOT / page).read_text()
    assert snippets.snippets(text, page) or not page.startswith(("README.md", "docs/guides/", "CONTRIBUTING.md"))
    assert snippets.faults(text, page) == []


def test_a_link_of_a_page_leads_somewhere():
    """Files of this repository that README and docs name as links."""
    links = [(page, link) for page in readme.pages_with_snippets(ROOT) for link in re.findall(r"\]\(([^)#:]+)[^):]*\)", (ROOT / page).read_text())]
    assert len(links) > 40
    assert [(page, link) for page, link in links if not ((ROOT / page).parent / link).exists()] == []


def test_the_readme_fits_on_a_few_screens():
    lines = (ROOT / "README.md").read_text().splitlines()
    assert len(lines) <= 160 and len(list((ROOT / "docs/guides").glob("*.md"))) >= 8
    assert all(f"(docs/guides/{path.name})" in "\n".join(lines) for path in (ROOT / "docs/guides").glob("*.md"))


def test_the_answer_of_the_readme_is_a_table_a_figure_and_at_most_120_words():
    _, _, rest = (ROOT / "README.md").read_text().partition("## The answer\n")
    lines = rest.partition("\n## ")[0].splitlines()
    assert sum(line.startswith("| ") for line in lines) == 1 + 4 and any(line.startswith("![") for line in lines)
    words = " ".join(line for line in lines if not line.startswith(("|", "![", "<!--"))).split()
    assert 60 < len(words) <= 120


@pytest.fixture(scope="module")
def kept_numbers() -> dict:
    """Of the repository: gathering its gap map takes most of the time of this file."""
    if not numbers.FILE.is_file():
        pytest.skip("results/demo.json is not kept yet: ./bench demo, then ./bench dev readme --write")
    return readme.kept()


def test_the_pages_have_the_numbers_that_are_kept(kept_numbers):
    parts = {name for page in readme.PAGES for name in templates.blocks((ROOT / page).read_text())}
    assert parts == set(templates.TEMPLATES)
    assert readme.stale(ROOT, kept_numbers) == []


def test_the_gap_map_says_how_much_of_it_is_there(kept_numbers):
    found = kept_numbers["gap_map"]
    assert len(found) == 6 and found[0].startswith("With no strain limit") and " cells " in found[5] and " unknowns" in found[5]
    assert all(len(line) <= 100 for line in gap_map.lines(found, 100)) and gap_map.lines(["one"], 100) == ["- one"]


def test_the_page_says_how_long_and_how_often_the_longer_drape_was_looked_at(tmp_path):
    (tmp_path / "demo_long").mkdir()
    (tmp_path / "demo_long/sweep.json").write_text(json.dumps({"set": {"/time/duration_s": 0.25, "/diagnose/every": 7}}))
    assert numbers._long(tmp_path) == {"duration_s": 0.25, "every": 7}
    assert "drape over a sphere for 0.25 s" in " ".join(templates.result_sentences(everything())) and "of one iteration in 7" in " ".join(templates.drape_sentences(everything()))

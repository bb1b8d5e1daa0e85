"""Cells that a run decides: which follow from which run, what the page says, and the sample that is run all the same."""

import argparse
import json
import re
import shutil

import pytest
from test_gap_map_verb import ROOT, small

from barrierbench_analysis.studies.gap_map import entry, kept, report, runs, skips, table
from barrierbench_analysis.studies.gap_map.rows import CANNOT, COLUMNS, NOT_RUN, PLACE
from barrierbench_analysis.studies.gap_map.spec import cells, read_spec


def rows_of(*ends: tuple) -> list[dict]:
    """Of one scene: (shape, limit, theta, outcome)."""
    return [dict.fromkeys(COLUMNS) | dict(zip((*PLACE, "outcome"), ("s", "8", *end), strict=True)) for end in ends]


ROWS = rows_of(("cubic", "on", 0.5, "ok"), ("cubic", "on", 0.1, skips.OVERLOAD), ("cubic", "on", 0.05, NOT_RUN), ("cubic", "on", 0.01, "newton_stall"),
               ("cubic", "on", 0.001, NOT_RUN), ("cubic", "off", 0.001, NOT_RUN), ("log", "on", 0.001, NOT_RUN), ("log", "on", 0.01, "newton_stall"),
               ("quadratic", "on", 0.01, skips.OVERLOAD), ("quadratic", "on", 0.003, CANNOT), ("quadratic", "on", 0.001, skips.OVERLOAD))


def test_only_an_overload_decides_and_only_smaller_thetas_of_its_series():
    found = skips.skips_of(ROWS)
    by = ("s", "8", "cubic", "on", 0.1)
    assert [(skip.place[-1], skip.follows) for skip in found.left_out] == [(0.05, by), (0.001, by)]
    assert {(skip.place[2:], end) for skip, end in found.checks.items()} == {(("cubic", "on", 0.01), "newton_stall"), (("quadratic", "on", 0.001), skips.OVERLOAD)}
    assert found.held == 1
    page = "\n".join(skips.lines(found))
    assert "2 cells are left out" in page and "2 such cells were run all the same, of which 1 ended stall_overload" in page
    assert "| s | 8 | `cubic` | limit on | 0.05 | 0.1 | left out |" in page
    assert "| s | 8 | `cubic` | limit on | 0.01 | 0.1 | **newton_stall** |" in page


def test_without_an_overload_nothing_is_left_out():
    found = skips.skips_of([row for row in ROWS if row["outcome"] != skips.OVERLOAD])
    assert found.left_out == [] and found.checks == {} and skips.lines(found) == []


def test_a_sample_is_seeded_and_of_cells_that_were_left_out():
    found = skips.skips_of(rows_of(("c", "on", 0.5, skips.OVERLOAD), *(("c", "on", 0.4 - k / 100, NOT_RUN) for k in range(20))))
    samples = {tuple(found.sample(5, seed)) for seed in range(8)}
    assert len(samples) > 4 and found.sample(5, 3) == found.sample(5, 3) and len(found.sample(99, 1)) == 20
    assert set(found.sample(99, 1)) == {skip.place for skip in found.left_out}


def test_the_kept_map_holds_the_rule_and_its_page_says_so():
    found = table.read(ROOT / "results/gap_map.json")
    decided = skips.skips_of(found.rows)
    assert len(decided.checks) >= 30 and decided.held == len(decided.checks)
    text = (ROOT / "results/GAP_MAP.md").read_text()
    assert "\n".join(skips.lines(decided)) in text and f"{len(decided.left_out)} cells are left out" in text
    assert len(decided.left_out) > 0


@pytest.fixture
def overloaded(program, tmp_path, monkeypatch):
    """A map of a block whose run at theta 0.5 is said to have ended in an overload."""
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    spec = read_spec(small(tmp_path))
    wanted = [cell for cell in cells(spec) if cell.shape == "cubic"]
    ends = {cell.key: skips.OVERLOAD for cell in wanted if cell.theta == 0.5}
    return spec, wanted, ends, tmp_path


def made(spec, folder) -> set[float]:
    return {record["matching"]["theta"] for place in kept.digests(spec) for record, _ in
            runs.records_in([runs.folder_of(folder / "runs", place, kept.digests(spec))]).values()}


def test_a_decided_cell_is_not_run_and_a_spot_check_runs_it(overloaded, capsys):
    spec, wanted, ends, folder = overloaded
    assert len(ends) == 1
    runs.run_missing(spec, [cell for cell in wanted if cell.key not in ends], folder / "runs", kept.digests(spec), 1, None, ends)
    assert made(spec, folder) == set() and "0 runs, 1 decided by others" in capsys.readouterr().err
    rows = [dict.fromkeys(COLUMNS) | dict(zip((*PLACE, "outcome"), (*cell.key, ends.get(cell.key, NOT_RUN)), strict=True)) for cell in wanted]
    entry.spot_check(argparse.Namespace(spot_check=5, seed=1, runs=folder / "runs", jobs=1), spec, rows)
    assert made(spec, folder) == {0.1} and "spot check of 1 cells" in capsys.readouterr().err


@pytest.fixture
def kept_overload(overloaded, monkeypatch):
    """Words of a call whose gap_map.json keeps that overload; the three other cells are `ok` but one, which is not run."""
    spec, wanted, ends, folder = overloaded
    monkeypatch.setattr(entry.figure, "draw_all", lambda *_: [])
    words = [str(folder / "small.json"), "--runs", str(folder / "runs"), "--results", str(folder / "out")]
    (folder / "runs").mkdir(), (folder / "out").mkdir()
    assert entry.main(words) == 0
    kept_map = table.read(folder / "out/gap_map.json")
    for row in kept_map.rows:
        if row["shape"] == "cubic":
            end = ends.get(skips.place_of(row), NOT_RUN)
            row.update({"outcome": end} if end != NOT_RUN else dict.fromkeys(set(COLUMNS) - {*PLACE, "outcome"}) | {"outcome": NOT_RUN})
    table.write(kept_map, folder / "out/gap_map.json")
    shutil.rmtree(folder / "runs"), (folder / "runs").mkdir()
    assert len(skips.skips_of(kept_map.rows).left_out) == 1
    return words, folder


def test_a_cell_that_a_run_decides_is_not_among_those_to_be_run(kept_overload, capsys):
    words, folder = kept_overload
    assert entry.main([*words, "--plan"]) == 0
    said = capsys.readouterr().out
    assert re.search(r"all +: 4 runs, 4 there", said) and "1 more cells need no run, since others decide them" in said
    assert entry.main([*words, "--plan", "--decided"]) == 0
    said = capsys.readouterr().out
    assert re.search(r"all +: 5 runs, 4 there", said) and "need no run" not in said
    assert entry.main(words) == 0 and "not run yet" not in capsys.readouterr().err
    assert not list((folder / "runs").rglob("run.json"))
    assert entry.main([*words, "--decided", "--minutes", "1e-9"]) == 0 and "1 of 6 cells are not run yet" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--no-run", "--plan"])
def test_a_spot_check_where_nothing_is_run_is_refused(tmp_path, capsys, option):
    words = [str(small(tmp_path)), "--runs", str(tmp_path / "runs"), "--results", str(tmp_path), option]
    assert entry.main([*words, "--spot-check", "5"]) == 2
    assert f"--spot-check: found beside {option}, which runs nothing" in capsys.readouterr().err and not (tmp_path / "runs").exists()


def test_without_the_rule_every_cell_is_run(overloaded):
    spec, wanted, _, folder = overloaded
    runs.run_missing(spec, wanted, folder / "runs", kept.digests(spec), 1, None, None)
    assert made(spec, folder) == {0.5, 0.1}


def test_a_map_keeps_each_skip_with_its_reason(monkeypatch, tmp_path):
    spec = read_spec(small(tmp_path))
    rows = [dict.fromkeys(COLUMNS) | dict(zip((*PLACE, "outcome"), (*cell.key, skips.OVERLOAD if cell.theta == 0.5 else NOT_RUN), strict=True))
            | {"source": 0 if cell.theta == 0.5 else None, "unknowns": 9} for cell in cells(spec)]
    about = kept.about(spec, "x", rows, [{}])
    assert json.loads(json.dumps(about["skips"]))[0] == {"place": ["block", "1", "log", "off", 0.1], "reason": skips.REASON, "follows": ["block", "1", "log", "off", 0.5]}
    assert len(about["skips"]) == 3 and "smaller" in skips.REASON
    assert report.skips is skips

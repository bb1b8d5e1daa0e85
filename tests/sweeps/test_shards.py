"""Shares of a sweep, single runs of it, and the list of what it would do."""

import pytest
from sweep_files import SHAPES, STEPS, bench, planned, records, refused, verb, write_sweep


@pytest.mark.parametrize("n", [1, 2, 4, 6, 9])
def test_shards_are_all_runs_once_and_of_one_size(program, tmp_path, n):
    file = write_sweep(tmp_path, STEPS, SHAPES)
    shards = [planned(program, file, "--shard", f"{i}/{n}") for i in range(1, n + 1)]
    assert sorted(name for shard in shards for name in shard) == sorted(planned(program, file))
    assert max(map(len, shards)) - min(map(len, shards)) <= 1


def test_the_last_shard_judges_what_all_have_made(program, tmp_path):
    file, out = write_sweep(tmp_path, SHAPES, settings={"/time/steps": 30}), tmp_path / "out"
    assert bench(program, "sweep", file, "--out", out, "--shard", "1/2").returncode == 0
    assert {record["comparability"]["verdict"] for record in records(out).values()} == {"no_reference"}
    assert bench(program, "sweep", file, "--out", out, "--shard", "2/2").returncode == 0
    assert "no_reference" not in {record["comparability"]["verdict"] for record in records(out).values()}


def test_an_index_is_the_run_of_the_plan(program, tmp_path):
    file, out = write_sweep(tmp_path, STEPS, SHAPES), tmp_path / "out"
    for index, name in enumerate(planned(program, file)):
        assert planned(program, file, "--index", index) == [name]
    assert bench(program, "sweep", file, "--out", out, "--index", 4).returncode == 0
    assert [path.parent.name for path in out.glob("*/run.json")] == planned(program, file)[4:5]


@pytest.mark.parametrize("words, message", [
    (["--shard", "0/3"], ["--shard", "1 <= i <= N"]), (["--shard", "4/3"], ["--shard", "4/3"]), (["--shard", "1"], ["--shard"]),
    (["--shard", "1/3x"], ["--shard"]), (["--shard", "1/-3"], ["--shard"]), (["--index", "6"], ["--index", "0 to 5", "6 cases"]),
    (["--index", "1", "--shard", "1/2"], ["--index", "--shard beside it"]), (["--index", "1", "--jobs", "2"], ["--index", "--jobs beside it"]),
    (["--jobs", "0"], ["--jobs"])])
def test_a_share_that_there_is_not_is_refused(program, tmp_path, words, message):
    refused(bench(program, "sweep", write_sweep(tmp_path, STEPS, SHAPES), *words, "--out", tmp_path / "out"), *message)
    assert not (tmp_path / "out").exists()


def test_a_plan_names_every_run_and_its_source_of_cost_and_makes_nothing(program, tmp_path):
    file, out = write_sweep(tmp_path, STEPS, SHAPES), tmp_path / "out"
    first = bench(program, "plan", file, "--out", out)
    assert first.returncode == 0, first.stderr
    rows = [line.split() for line in first.stdout.splitlines()[1:7]]
    assert [row[0] for row in rows] == list("012345") and {row[3] for row in rows} == {"model"}
    assert [row[1][:8] for row in rows] == [name.rsplit("-", 1)[1] for name in planned(program, file)]
    assert all(0 < float(row[2]) < 1 for row in rows) and "own: 6 runs (2 x 3), 0 there" in first.stdout and "6 by the model" in first.stdout
    assert not out.exists()
    assert bench(program, "sweep", file, "--out", out, "--index", 0).returncode == 0
    rows = [line.split() for line in bench(program, "plan", file, "--out", out).stdout.splitlines()[1:7]]
    assert [row[3] for row in rows] == ["there", *["records"] * 5]
    own = bench(program, "plan", file, "--out", tmp_path / "other", "--records", out).stdout
    assert [line.split()[3] for line in own.splitlines()[1:7]] == ["record", *["records"] * 5]
    refused(bench(program, "plan", file, "--records", tmp_path / "nowhere"), "--records", "nowhere")


def test_a_plan_of_a_budget_says_how_far_it_goes(program, tmp_path):
    done = bench(program, "plan", write_sweep(tmp_path, STEPS, budget={"core_s": 1e-6}), "--out", tmp_path / "out")
    assert "budget: 1e-06 core s" in done.stdout and "% of what is expected" in done.stdout


def test_a_written_plan_lets_status_tell_what_is_missing(program, tmp_path):
    file, out = write_sweep(tmp_path, STEPS), tmp_path / "out"
    refused(verb("status", tmp_path), "cases.json", "./bench plan SPEC")
    assert bench(program, "plan", file, "--out", out, "--write").returncode == 0
    assert bench(program, "sweep", file, "--out", out, "--index", 1).returncode == 0
    missing = verb("status", out, "--missing")
    assert (missing.returncode, missing.stdout) == (1, "0\n")
    assert bench(program, "sweep", file, "--out", out, "--index", 0).returncode == 0
    assert verb("status", out, "--missing").stdout == "" and verb("status", out).returncode == 0


@pytest.mark.parametrize("left, cut_off", [("", True), ('{"schema": {"name": "barrierbench.run"', True), ("{}", False), ("[1]", False)])
def test_a_record_that_cannot_be_read_is_not_over_and_one_that_was_cut_off_is_made_again(program, tmp_path, left, cut_off):
    file, out = write_sweep(tmp_path, STEPS), tmp_path / "out"
    assert bench(program, "sweep", file, "--out", out).returncode == 0
    (out / planned(program, file)[1] / "run.json").write_text(left)
    seen, missing = verb("status", out), verb("status", out, "--missing")
    assert seen.returncode == 1 and "2 runs: 1 over (1 ok), 1 unreadable" in seen.stdout and "run.json" in seen.stdout.splitlines()[-1]
    assert (missing.returncode, missing.stdout) == (1, "1\n")
    assert bench(program, "plan", file, "--out", out).stdout.splitlines()[2].split()[3] != "there"
    if not cut_off:  # somebody else's file
        refused(bench(program, "sweep", file, "--out", out), "run.json", "that is no record of a run", "another folder of the sweep")
        assert (out / planned(program, file)[1] / "run.json").read_text() == left
        return
    assert bench(program, "sweep", file, "--out", out).returncode == 0
    assert "2 over (2 ok)" in verb("status", out).stdout and verb("status", out).returncode == 0

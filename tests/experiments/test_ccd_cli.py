"""The verb ccd: exit codes, JSON, refusals."""

import json
import subprocess

import pytest


def ccd(program: str, *words: str) -> subprocess.CompletedProcess:
    return subprocess.run([program, "ccd", *words], capture_output=True, text=True, check=False, timeout=120)


def test_random_queries_have_no_false_negative(program, tmp_path):
    out = tmp_path / "ccd.json"
    done = ccd(program, "--random", "600", "--seed", "7", "--json", str(out))
    assert done.returncode == 0, done.stderr
    scores = json.loads(out.read_text())["scores"]
    assert len(scores) == 6 and len(done.stdout.splitlines()) == 7
    for score in scores:
        assert (score["queries"], score["positives"], score["false_negatives"]) == (600, 300, 0)


def test_a_seed_gives_the_same_answers(program, tmp_path):
    def answers(seed: str) -> list:
        assert ccd(program, "--random", "60", "--seed", seed, "--json", str(tmp_path / "a.json")).returncode == 0
        return [{k: v for k, v in s.items() if k != "ns_a_query"} for s in json.loads((tmp_path / "a.json").read_text())["scores"]]

    assert answers("3") == answers("3")


def test_head_on_sweeps_never_cross(program, tmp_path):
    out = tmp_path / "ccd.json"
    assert ccd(program, "--head-on", "50", "--json", str(out)).returncode == 0
    rows = json.loads(out.read_text())["head_on"]
    assert len(rows) == 24 and sum(r["crossed"] for r in rows) == 0


def test_a_false_truth_is_a_false_negative(program, tmp_path):
    """Two points that stay apart, with the truth of a hit."""
    folder = tmp_path / "scene" / "vertex-face"
    folder.mkdir(parents=True)
    row = "{},1,0,1,{},1,1\n"
    rows = [row.format(0, 5), row.format(0, 0), row.format(1, 0), "0,1,1,1,0,1,1\n"]
    (folder / "a.csv").write_text("".join(rows * 2))
    done = ccd(program, str(tmp_path))
    assert done.returncode == 4, done.stderr
    assert "point_triangle" in done.stdout


@pytest.mark.parametrize("words, says", [((), "0 sources"), (("--random", "5", "--head-on", "5"), "2 sources"),
                                         (("--random", "-1"), "--random: found -1"), (("nowhere",), "no folder")])
def test_refusals(program, words, says):
    done = ccd(program, *words)
    assert done.returncode == 2 and says in done.stderr

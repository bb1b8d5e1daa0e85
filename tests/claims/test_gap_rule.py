"""The rule of comparability of two runs against the verdicts that the program writes, and by hand."""

import json
import subprocess
from pathlib import Path

import pytest

from barrierbench_analysis.tables.gap_rule import MAX_RATIO, Apart, farthest, gaps_of

ROOT = Path(__file__).resolve().parents[2]
CASES = {"log": {"/formulation": "log"}, "soft": {"/formulation": "log", "/formulation/stiffness_policy/scale": 0.02}, "cubic": {"/formulation": "cubic"},
         "one_layer": {"/formulation": "log", "/scene/layers": 1}}


@pytest.fixture(scope="module")
def records(program, tmp_path_factory) -> dict[str, dict]:
    """Two cloths on a ball, and one alone: some pairs carry load in one run only."""
    folder = tmp_path_factory.mktemp("gaps")
    spec = {"schema": "barrierbench.sweep/1", "name": "gaps", "base": str(ROOT / "configs/scenes/drape.json"),
            "set": {"/scene/n": 6, "/scene/layers": 2, "/time/steps": 25, "/passes/time": False, "/passes/audit": True, "/matching/rule": "equal_force"},
            "axes": [{"cases": [{"label": label, "set": change} | ({"reference": True} if label == "log" else {}) for label, change in CASES.items()]}]}
    (folder / "gaps.json").write_text(json.dumps(spec))
    done = subprocess.run([program, "sweep", str(folder / "gaps.json"), "--out", str(folder / "out")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = [json.loads(path.read_text()) for path in (folder / "out").glob("*/run.json")]
    return {record["labels"]["note"].partition(": ")[2]: record for record in found}


def test_the_rule_is_that_of_the_program(records):
    judged = 0
    for record in records.values():
        theirs = record["comparability"]
        assert theirs["max_ratio"] == MAX_RATIO
        if theirs["verdict"] not in ("comparable", "not_comparable"):
            continue
        ours = farthest(gaps_of(record), gaps_of(records["log"]))
        assert (ours.pair, ours.quantile, ours.ratio) == (theirs["pair"], theirs["pair_quantile"], pytest.approx(theirs["pair_ratio"]))
        assert ours.comparable == (theirs["verdict"] == "comparable")
        judged += 1
    assert judged == 4 and len({frozenset(gaps_of(record)) for record in records.values()}) > 1
    assert not all(record["comparability"]["verdict"] == "comparable" for record in records.values())


def test_a_record_of_before_has_no_such_gaps():
    assert gaps_of({"summary": {}}) is None and gaps_of({"summary": {"contact_gaps": {}}}) == {}


def test_by_hand():
    one, other = {"a|b": [0.1, 0.2, 0.4, True]}, {"a|b": [0.1, 0.3, 0.4, True], "a|c": [0.1, 0.5, 0.5, False]}
    assert farthest(one, other) == Apart("a|b", "gap_rel_median", pytest.approx(2 / 3))  # a|c carries hardly anything
    assert farthest({}, {}) is None and farthest({}, one) == Apart("a|b", "gap_rel_p05", 10.0)  # without load gaps are at least d_hat
    assert not farthest({}, one).comparable and farthest(one, other).comparable


def test_overlaps_and_thin_loads_are_compared_as_in_the_program():
    apart, overlapping = {"a|b": [0.4, 0.4, 0.4, True]}, {"a|b": [0.0, 0.0, 0.4, True]}
    for one, other in ((apart, overlapping), (overlapping, apart), (overlapping, overlapping)):
        found = farthest(one, other)
        assert (found.pair, found.quantile, found.ratio) == ("a|b", "gap_rel_p05", None) and not found.comparable
    thin = {f"chip {k}|floor": [0.3, 0.3, 0.3, False] for k in range(120)}
    assert farthest(thin, thin).comparable and farthest(thin, thin | {"chip 7|floor": [0.7, 0.3, 0.3, False]}).pair == "chip 7|floor"

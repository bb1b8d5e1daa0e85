"""The committed baselines against the program that was built. Also the judge of the mutants of tests/mutation/gate.toml."""


def test_cases_of_the_small_set_are_green(gate, answer):
    """A case of every scene, and both formulations of the block; `bench gate` runs all."""
    assert gate("gate", "--case", "block", "--case", "strip-cubic", "--case", "sphere-log", "--case", "drape-log") == 0
    body = answer()
    assert body["green"] and body["failed"] == 0
    assert all(body["judged"][c] >= 4 for c in ("I", "II", "III", "IV")), body["judged"]
    assert {f["case"] for f in body["findings"]} >= {"block-log", "block-cubic", "strip-cubic", "sphere-log", "drape-log"}

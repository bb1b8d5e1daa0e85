"""Pareto fronts: specs, fronts of made-up rows, the page, and one study of the real program."""

import json
import math
from pathlib import Path

import pytest
from made_records import install
from made_runs import METRICS, page_of, row, runs_of

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.studies.kit.study import page, store, verb
from barrierbench_analysis.studies.kit.study.spec import read_study
from barrierbench_analysis.studies.rules.pareto.fronts import Runs, at_gap, failures, over_scenes, over_shared, unreached

ABOUT = {"doc": "made up", "formulations": ["log", "cubic"], "vary": "both", "scales": [0.01, 0.1, 1, 10, 100], "jitter_m": 1e-6, "gaps": [0.1, 0.3]}
BASE = {"schema": "barrierbench.study/1", "name": "made", "rule": "pareto", "question": "What?", "base": str(ROOT / "configs/scenes/resting_block_1d.json"), "seeds": [1, 2], "page": "results/MADE.md",
        "axes": [{"names": ["scene"], "cases": [{"label": "block", "set": {"/time/steps": 10}}]}], "metrics": {"gap": "gap_min"} | {name: name for name in METRICS}}


def spec_file(tmp_path, about=None, **edit) -> Path:
    path = tmp_path / "made.json"
    merged = {key: value for key, value in (ABOUT | (about or {})).items() if value is not None}
    path.write_text(json.dumps(BASE | {"about": merged} | edit))
    return path


def scene(**settings) -> list:
    return [{"names": ["scene"], "cases": [{"label": "a", "set": settings}]}]


SETS_ITSELF = "nothing below /matching, /passes, /seeds, /formulation but /formulation/d_hat_m is needed"


@pytest.mark.parametrize("about, edit, words", [
    ({"gaps": None}, {}, "#/about/gaps: is missing"), ({"kappa": 1}, {}, "#/about/kappa: unknown"), ({"vary": "all"}, {}, "#/about/vary: found 'all'; one of contact, limit, both"),
    ({"scales": [0.1, 1, 10]}, {}, "#/about/scales: found '0.1 to 10'; a range of at least 4 decades round 1"), ({"scales": [1, 10, 1e5]}, {}, "at least 4 decades round 1"),
    ({"scales": [0.01, 1, 1, 100]}, {}, "growing numbers, each once"), ({"scales": [100, 1, 0.01]}, {}, "#/about/scales: found [100, 1, 0.01]; a list of growing numbers, each once, is needed"),
    ({"scales": [0, 1, 1e5]}, {}, "#/about/scales/0: found 0; a number > 0"), ({"scales": [0.01, float("nan"), 100]}, {}, "#/about/scales/1: found nan"),
    ({"gaps": [0.1, 1.0]}, {}, "#/about/gaps/1: found 1.0; a number in (0, 1)"), ({"gaps": [0.3, 0.1]}, {}, "#/about/gaps: found [0.3, 0.1]; a list of growing numbers"), ({}, {"seeds": [0.5]}, "#/seeds/0: found 0.5; a whole number from 0"),
    ({"formulations": ["cubic", "quadratic"]}, {}, "'log' among them"), ({"formulations": ["log", "cubci"]}, {}, "#/about/formulations/1: formulation 'cubci'"),
    ({"formulations": ["log", "log"]}, {}, "at least two names, each once"), ({"jitter_m": -1}, {}, "a length >= 0"), ({"doc": 3}, {}, "#/about/doc: found 3; text is needed"),
    ({}, {"metrics": {"gap": "newton"}}, "#/metrics/gap: found 'newton'; one of gap_min, gap_median"), ({}, {"metrics": {"newton": "newton"}}, "#/metrics/gap: found None; one of gap_min, gap_median"),
    ({}, {"axes": scene(**{"/formulation": "log"})}, f"#/axes/0/cases/a/set: found '/formulation'; {SETS_ITSELF}"), ({}, {"axes": scene(**{"/passes/audit": False})}, "#/axes/0/cases/a/set: found '/passes/audit'"),
    *(({}, {"set": {pointer: 1}}, f"#/set: found '{pointer}'; {SETS_ITSELF}")
      for pointer in ("/matching/rule", "/matching", "/passes", "/passes/audit", "/formulation", "/formulation/shape", "/seeds/main"))])
def test_a_bad_spec(tmp_path, about, edit, words, capsys):
    with pytest.raises(UserError) as error:
        _ = read_study(str(spec_file(tmp_path, about, **edit))).cells
    assert words in str(error.value) and "made.json" in str(error.value)
    assert verb.main([str(tmp_path / "made.json"), "--plan"]) == 2 and words in capsys.readouterr().err


def test_the_cells_of_the_committed_spec():
    cells = read_study("pareto").cells
    assert len(cells) == 3 * 5 * 7 * 5 == len({cell.key for cell in cells})
    of = {cell.label: cell.settings for cell in cells}["strip cubic 10 2"]
    assert of["/formulation/stiffness_policy/scale"] == of["/strain_limit/stiffness_policy/scale"] == 10
    assert (of["/seeds/main"], of["/seeds/jitter_m"], of["/matching/rule"], of["/passes"]["audit"]) == (2, 1e-5, "equal_force", True)
    assert "kappa" not in "".join(pointer for cell in cells for pointer in cell.settings)  # stiffness is that of the matching rule, times a scale


def test_what_a_spec_sets_stays_and_d_hat_goes_behind_the_formulation(tmp_path):
    stages, d_hat = "/diagnose/stages", "/formulation/d_hat_m"
    study = read_study(str(spec_file(tmp_path, set={stages: ["full"], d_hat: 0.004}, axes=scene(**{d_hat: 0.002}))))
    assert all(stages not in cell.settings and cell.settings[d_hat] == 0.002 for cell in study.cells)
    assert list(study.cells[0].settings).index("/formulation") < list(study.cells[0].settings).index(d_hat)
    plain = read_study(str(spec_file(tmp_path, set={d_hat: 0.004})))
    assert {cell.settings[d_hat] for cell in plain.cells} == {0.004} and len(plain.cells[0].settings[stages]) == 3


def test_a_plugin_is_part_of_the_key_of_a_cell(tmp_path):
    file, plugin = str(spec_file(tmp_path)), tmp_path / "one.so"
    keys = [{cell.key for cell in read_study(file).cells}]
    for content in ("1", "2"):
        plugin.write_text(content)
        keys.append({cell.key for cell in read_study(file, plugins=[str(plugin)]).cells})
    assert not keys[0] & keys[1] and not keys[1] & keys[2] and not keys[0] & keys[2]


def rows(make) -> Runs:
    """make(formulation, scale, seed) gives gap, newton and what else differs."""
    return runs_of([row("a", f, s, k, **make(f, s, k)) for f in ("log", "cubic") for s in (0.01, 0.1, 1.0, 10.0, 100.0) for k in (1, 2, 3)])


def five_times(f, s, k):
    gap = (0.3 if f == "cubic" else 0.1) * s**0.2
    return {"gap": gap, "newton": (1 + 0.1 * k) * (5.0 if f == "cubic" else 1.0) / gap}


def test_formulations_at_equal_gap():
    runs = rows(five_times)
    value, ratio = at_gap(runs, "a", "cubic", "newton", 0.2)
    assert ratio.value == pytest.approx(5) and ratio.low == pytest.approx(5) and (ratio.n, ratio.of) == (3, 3)  # starts are paired: their spread leaves the ratio
    assert (value.low, value.high) == (pytest.approx(5.5 / 0.2), pytest.approx(6.5 / 0.2)) and over_shared(runs, "a", "cubic", "newton").value == pytest.approx(5)
    assert at_gap(runs, "a", "cubic", "newton", 0.1) == (None, None)  # the cubic does not come that close
    assert at_gap(runs, "a", "log", "newton", 0.1)[0] is not None


def of_scenes(ratios: dict[str, float], starts: int = 3) -> Runs:
    """One path a scene, start and formulation: the cubic takes ratios[scene] times what the log takes, a little more from start to start."""
    return runs_of([row(scene, f, s, k, gap=0.1 * s**0.2, newton=(ratio * 1.001**k if f == "cubic" else 1.0))
                    for scene, ratio in ratios.items() for f in ("log", "cubic") for s in (0.01, 0.1, 1.0, 10.0, 100.0) for k in range(1, starts + 1)])


def test_scenes_are_the_samples_and_starts_are_not():
    """Thirty starts say no more than three; a third scene that disagrees does."""
    def found(ratios, starts=3):
        runs = of_scenes(ratios, starts)
        return over_scenes([over_shared(runs, scene, "cubic", "newton") for scene in runs.scenes])

    three, thirty = found({"a": 2, "b": 3, "c": 4}), found({"a": 2, "b": 3, "c": 4}, 30)
    widths = [math.log(e.upper / e.lower) for e in (three, thirty)]
    logs = [math.log(r) for r in (2, 3, 4)]
    spread = math.sqrt(sum((x - sum(logs) / 3) ** 2 for x in logs) / 2)
    assert widths == [pytest.approx(2 * 4.302653 * spread / math.sqrt(3))] * 2 and three.scenes == 3  # t of 2 degrees of freedom
    assert three.value == pytest.approx(24 ** (1 / 3) * 1.001**2) and three.lower < 2 < 4 < three.upper
    alone = found({"a": 2})
    assert (alone.lower, alone.upper, alone.scenes) == (None, None, 1)
    assert over_scenes([None, None]) is None and over_scenes([None, over_shared(of_scenes({"a": 2}), "a", "cubic", "newton")]).scenes == 1


def test_the_page_calls_no_scatter_an_interval():
    text = page_of(of_scenes({"a": 2, "b": 3, "c": 4}))
    of_scene, of_all = text.split("## All scenes")
    assert "2 (2 to 2.01)" in of_scene.split("## a")[1].split("## b")[0] and "[" not in "".join(line for line in of_scene.splitlines() if line.startswith("| newton |"))
    assert "| newton | cubic / log | - | 2.89 [1.22, 6.86] | - | 2.89 [1.22, 6.86] |" in of_all and "bootstrap" not in text
    assert "2 (one scene: no interval)" in page_of(of_scenes({"a": 2}))


def test_what_nobody_reaches_and_who_failed():
    def some_fail(f, s, k):
        return five_times(f, s, k) | ({"outcome": "stall_overload"} if f == "cubic" and s <= 0.1 and k == 2 else {}) | ({"gap": None} if f == "log" and s == 100 else {})

    runs = rows(some_fail)
    (low, high), (low2, high2) = unreached(runs, "a")
    assert (low, high) == (0, pytest.approx(0.1 * 0.01**0.2)) and (low2, high2) == (pytest.approx(0.3 * 100**0.2), 1)
    assert failures(runs, "a", "cubic") == {0.01: {"stall_overload": 1}, 0.1: {"stall_overload": 1}} and failures(runs, "a", "log") == {100.0: {"no contact": 3}}
    text = page_of(runs)
    assert "| x0.01: 1 stall_overload; x0.1: 1 stall_overload |" in text and "No formulation reaches gaps below 0.0398, above 0.754." in text
    assert "| newton | cubic / log | - | - | - | 5 (5 to 5) (2/3) |" in text  # start 2 lost the gaps that both reach
    hole = rows(lambda f, s, k: {"gap": 0.01 * (s if s < 5 else 10 * s) ** 0.1} | ({"outcome": "newton_stall"} if s == 1 else {}))
    assert [f"{low:.3f} {high:.3f}" for low, high in unreached(hole, "a")] == ["0.000 0.006", "0.008 0.016", "0.020 1.000"]


def test_a_study_of_made_records(monkeypatch, tmp_path, capsys):
    """Rows, page and figure; what is kept is not run again."""
    gaps = {f"block {f} {s} ": g * (k + 1) for f, k in (("log", 0), ("cubic", 1)) for s, g in (("0.01", 0.03), ("0.1", 0.06), ("1", 0.1), ("10", 0.2), ("100", 0.4))}
    install(tmp_path, monkeypatch, gaps, {"block cubic 0.01 1": {"/status/outcome": "stall_overload", "/status/valid": False}})
    out = tmp_path / "out"
    words = [str(spec_file(tmp_path)), "--out", str(out)]
    assert verb.main(words) == 0, capsys.readouterr()
    assert "20 new rows in made.rows.jsonl" in capsys.readouterr().out
    text, kept = (out / "made.page.md").read_text(), (out / "made.rows.jsonl").read_bytes()
    assert "x0.01: 1 stall_overload" in text and "(equal_force, theta 0.2), from 2 jittered starts" in text and "![cost against reached gap](./made_block.png)" in text
    assert (out / "made_block.png").stat().st_size > 10000 and len(list((out / "runs").glob("*/*/run.json"))) == 20
    for record in (out / "runs").glob("*/*/run.json"):
        record.unlink()
    assert verb.main([*words, "--no-run"]) == 0  # from the kept numbers alone
    assert (out / "made.page.md").read_text() == text and (out / "made.rows.jsonl").read_bytes() == kept
    spec_file(tmp_path, {"jitter_m": 1e-5})
    assert verb.main([*words, "--no-run"]) == 2 and "20 cells of 20 without a row" in capsys.readouterr().err


def test_a_number_that_is_none(monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {}, {"block cubic 10 ": {"/summary/wall_s": float("inf")}})
    assert verb.main([str(spec_file(tmp_path)), "--out", str(tmp_path / "out")]) == 2
    assert "#/summary/wall_s: found inf; allowed: a finite number" in capsys.readouterr().err and not (tmp_path / "out/made.rows.jsonl").exists()


def test_a_limit_that_is_not_there_does_not_vary(monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {}, {"block": {"/matching/limit_load_N_per_m": None}})
    assert verb.main([str(spec_file(tmp_path, {"vary": "limit"})), "--out", str(tmp_path / "out")]) == 2
    assert "made.json#/axes/0/cases/block: no strain limit acts in scene" in capsys.readouterr().err


def test_nothing_ever_touches(monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {"block": None})
    assert verb.main([str(spec_file(tmp_path)), "--out", str(tmp_path / "out")]) == 2
    assert "#/axes/0/cases/block: no run is in contact" in capsys.readouterr().err


def test_the_real_program(program, monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    study = read_study(str(spec_file(tmp_path, seeds=[1], set={"/step_solver/max_iterations": 40, "/diagnose/stages": ["full"]})), tmp_path / "out")
    assert verb.make_rows(study) == 10, capsys.readouterr()
    kept = page.rows_of(study)
    runs = study.module.rule(study, kept)["runs"]
    gaps = [row.values["gap"] for row in runs.of("block", "log")]
    assert gaps == sorted(gaps) and 0 < gaps[0] < 0.3 * gaps[-1]  # more stiffness, more gap
    assert {row.outcome for row in runs.of("block", "cubic") if runs.scale(row) < 1} == {"stall_overload"}  # above capacity
    assert all(row.values[name] for row in kept for name in ("newton", "cond_p95", "pcg_probe", "seconds") if row.outcome == "ok")
    assert store.read_rows(store.file_of(study)).keys() == {cell.key for cell in study.cells}


def test_a_path_inside_another_ends_no_range():
    """The log's path covers all gaps from 0.05 to 0.5; the cubic's short one begins later and ends earlier."""
    within = rows(lambda f, s, k: {"gap": 0.05 * 10 ** ((math.log10(s) + 2) / 4)} if f == "log" else {"gap": 0.2 * 1.1 ** math.log10(s)})
    assert [(pytest.approx(low), pytest.approx(high)) for low, high in unreached(within, "a")] == [(0, 0.05), (0.5, 1)]

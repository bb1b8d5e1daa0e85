"""The verb `pareto`: specs, fronts of made-up records, the page, and one sweep of the real program."""

import json
import math
import shutil
from pathlib import Path

import pytest
from made_records import install

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.matching import pareto
from barrierbench_analysis.studies.matching.fronts import Runs, at_gap, failures, over_scenes, over_shared, unreached
from barrierbench_analysis.studies.matching.pareto_report import markdown
from barrierbench_analysis.studies.kit.runs import inputs_sha256
from barrierbench_analysis.studies.matching.spec import make_sweep, read_spec

ROOT = Path(__file__).resolve().parents[2]
BASE = {"schema": "barrierbench.pareto/1", "name": "made", "doc": "made up", "base": str(ROOT / "configs/scenes/resting_block_1d.json"), "formulations": ["log", "cubic"],
        "scales": [0.01, 0.1, 1, 10, 100], "starts": 2, "jitter_m": 1e-6, "gaps": [0.1, 0.3], "scenes": [{"label": "block", "set": {"/time/steps": 10}}]}


def spec_file(tmp_path, **edit) -> Path:
    path = tmp_path / "spec.json"
    path.write_text(json.dumps({key: value for key, value in (BASE | edit).items() if value is not None}))
    return path


@pytest.mark.parametrize("edit, said", [
    ({"schema": "x"}, "#/schema: found 'x'"), ({"gaps": None}, "#/gaps: is missing"), ({"kappa": 1}, "#/kappa: unknown"), ({"vary": "all"}, "#/vary: found 'all'; one of contact, limit, both"),
    ({"scales": [0.1, 1, 10]}, "0.1 to 10, 2 decades; at least 4 decades round 1"), ({"scales": [1, 10, 1e5]}, "at least 4 decades round 1"),
    ({"scales": [0.01, 1, 1, 100]}, "growing numbers, each once"), ({"scales": [0, 1, 1e5]}, "#/scales/0: found 0; a number > 0"), ({"scales": [0.01, float("nan"), 100]}, "#/scales/1: found nan"),
    ({"gaps": [0.1, 1.0]}, "#/gaps/1: found 1.0; a number in (0, 1)"), ({"starts": 0}, "#/starts: found 0; a whole number from 1 to 100"),
    ({"formulations": ["cubic", "quadratic"]}, "'log' among them"), ({"formulations": ["log", "cubci"]}, "#/formulations/1: formulation 'cubci'"),
    ({"formulations": ["log", "log"]}, "at least two names, each once"), ({"scenes": []}, "#/scenes: found []; a list"), ({"scenes": [{"label": "a b", "set": {}}]}, "one word, each once"),
    ({"scenes": [{"label": "a", "set": {"/formulation": "log"}}]}, "#/scenes/a/set: found '/formulation'; the sweep sets formulation, matching, passes and seeds itself"), ({"jitter_m": -1}, "a length >= 0"),
    ({"gap": "max"}, "#/gap: found 'max'; one of min, median"), ({"set": []}, "#/set: found []; overrides, {\"/POINTER\": value}, is needed"),
    ({"base": 3}, "#/base: found 3; the path of a config, relative to this file, is needed"), ({"base": "none.json"}, "#/base: found 'none.json'; the path of a config, relative to this file, is needed"),
    ({"starts": True}, "#/starts: found True; a whole number from 1 to 100"), ({"doc": 3}, "#/doc: found 3; text is needed"),
    *(({"set": {pointer: 1}}, f"#/set: found '{pointer}'; the sweep sets formulation, matching, passes and seeds itself")
      for pointer in ("/matching/rule", "/matching", "/passes", "/passes/audit", "/formulation", "/formulation/shape", "/seeds/main")),
    ({"scenes": [{"label": "a", "set": {"/passes/audit": False}}]}, "#/scenes/a/set: found '/passes/audit'; the sweep sets")])
def test_a_bad_spec(tmp_path, edit, said):
    with pytest.raises(UserError) as error:
        read_spec(spec_file(tmp_path, **edit))
    assert said in str(error.value) and "spec.json" in str(error.value)
    assert pareto.main([str(tmp_path / "spec.json"), "--results", str(tmp_path / "r")]) == 2 and not (tmp_path / "r").exists()


def test_the_committed_spec_and_its_sweep():
    spec = read_spec(pareto.DEFAULT)
    made = make_sweep(spec)
    assert len(made.notes) == len(spec.scenes) * len(spec.formulations) * len(spec.scales) * spec.starts > 300
    assert len(set(made.notes)) == len(made.notes) and len(spec.scenes) >= 2
    cases = {case["label"]: case["set"] for case in json.loads(made.text)["axes"][0]["cases"]}
    assert cases["strip cubic x10"]["/formulation/stiffness_policy/scale"] == cases["strip cubic x10"]["/strain_limit/stiffness_policy/scale"] == 10
    assert "kappa" not in "".join(pointer for case in cases.values() for pointer in case)  # stiffness is that of the matching rule, times a scale


def rows(make) -> Runs:
    """make(formulation, scale, seed) gives gap, newton and what else differs."""
    found = [{"scene": "a", "formulation": f, "scale": s, "seed": k, "outcome": "ok", "run": f"{f}{s}{k}", **{m: 1.0 for m in pareto.METRICS}, **make(f, s, k)}
             for f in ("log", "cubic") for s in (0.01, 0.1, 1.0, 10.0, 100.0) for k in (1, 2, 3)]
    about = {"command": "./bench study pareto", "decades": 4.0, "rule": "equal_force, theta 0.1", "starts": 3, "gap": "smallest", "doc": "made up", "vary": "both", "unknowns": "3 to 9",
             "seconds": 2.0, "date": "2024-01-31", "machine": "a cpu", "build": "0123456789", "gaps": [0.02, 0.1, 0.99], "spec_sha256": "s"}
    return Runs(about, found)


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
    runs = rows(five_times)
    runs.rows = [{"scene": scene, "formulation": f, "scale": s, "seed": k, "outcome": "ok", "gap": 0.1 * s**0.2, "run": "r", **dict.fromkeys(pareto.METRICS, 1.0),
                  "newton": (ratio * 1.001**k if f == "cubic" else 1.0)}
                 for scene, ratio in ratios.items() for f in ("log", "cubic") for s in (0.01, 0.1, 1.0, 10.0, 100.0) for k in range(1, starts + 1)]
    return runs


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
    page = markdown(of_scenes({"a": 2, "b": 3, "c": 4}))
    of_scene, of_all = page.split("## All scenes")
    assert "2 (2 to 2.01)" in of_scene.split("## a")[1].split("## b")[0] and "[" not in "".join(line for line in of_scene.splitlines() if line.startswith("| newton |"))
    assert "| newton | cubic / log | - | 2.89 [1.22, 6.86] | - | 2.89 [1.22, 6.86] |" in of_all and "bootstrap" not in page
    assert "2 (one scene: no interval)" in markdown(of_scenes({"a": 2}))


def test_what_nobody_reaches_and_who_failed():
    def some_fail(f, s, k):
        return five_times(f, s, k) | ({"outcome": "stall_overload"} if f == "cubic" and s <= 0.1 and k == 2 else {}) | ({"gap": None} if f == "log" and s == 100 else {})

    runs = rows(some_fail)
    (low, high), (low2, high2) = unreached(runs, "a")
    assert (low, high) == (0, pytest.approx(0.1 * 0.01**0.2)) and (low2, high2) == (pytest.approx(0.3 * 100**0.2), 1)
    assert failures(runs, "a", "cubic") == {0.01: {"stall_overload": 1}, 0.1: {"stall_overload": 1}} and failures(runs, "a", "log") == {100.0: {"no contact": 3}}
    page = markdown(runs)
    assert "| x0.01: 1 stall_overload; x0.1: 1 stall_overload |" in page and "No formulation reaches gaps below 0.0398, above 0.754." in page
    assert "| newton | cubic / log | - | - | - | 5 (5 to 5) (2/3) |" in page  # start 2 lost the gaps that both reach
    hole = rows(lambda f, s, k: {"gap": 0.01 * (s if s < 5 else 10 * s) ** 0.1} | ({"outcome": "newton_stall"} if s == 1 else {}))
    assert [f"{low:.3f} {high:.3f}" for low, high in unreached(hole, "a")] == ["0.000 0.006", "0.008 0.016", "0.020 1.000"]


def test_records_become_the_page(monkeypatch, tmp_path, capsys):
    gaps = {f"block {f} x{s}": g * (k + 1) for f, k in (("log", 0), ("cubic", 1)) for s, g in (("0.01", 0.03), ("0.1", 0.06), ("1", 0.1), ("10", 0.2), ("100", 0.4))}
    install(tmp_path, monkeypatch, gaps, {"block cubic x0.01 main=1": {"/status/outcome": "stall_overload", "/status/valid": False}})
    words = [str(spec_file(tmp_path)), "--results", str(tmp_path / "r"), "--runs", str(tmp_path / "runs")]
    assert pareto.main(words) == 0, capsys.readouterr()
    assert "20 runs, 19 ok" in capsys.readouterr().out
    page, kept = (tmp_path / "r" / "PARETO.md").read_text(), (tmp_path / "r" / "pareto.json").read_bytes()
    assert "x0.01: 1 stall_overload" in page and (tmp_path / "r" / "pareto_block.png").stat().st_size > 10000
    for record in (tmp_path / "runs").glob("*/run.json"):
        record.unlink()
    assert pareto.main([*words, "--no-run"]) == 0  # from the kept numbers alone
    assert (tmp_path / "r" / "PARETO.md").read_text() == page and (tmp_path / "r" / "pareto.json").read_bytes() == kept
    spec_file(tmp_path, doc="another")
    assert pareto.main([*words, "--no-run"]) == 2 and "its numbers are of another" in capsys.readouterr().err


def test_numbers_of_another_base_are_not_taken(monkeypatch, tmp_path, capsys):
    """Neither from records nor from the kept table; a table that does not say of which base it is is taken with a warning."""
    install(tmp_path, monkeypatch, {f"block {f} x{s}": g for f in ("log", "cubic") for s, g in (("0.01", 0.03), ("0.1", 0.06), ("1", 0.1), ("10", 0.2), ("100", 0.4))})
    monkeypatch.setattr(pareto, "ROOT", tmp_path)
    base, kept = tmp_path / "base.json", tmp_path / "r" / "pareto.json"
    base.write_text('{"schema": "barrierbench.config/1"}')
    words = [str(spec_file(tmp_path, base="base.json")), "--results", str(tmp_path / "r")]
    assert pareto.main(words) == 0 and pareto.main([*words, "--no-run"]) == 0, capsys.readouterr()
    base.write_text('{"schema": "barrierbench.config/1", "time": {"steps": 3}}')
    assert pareto.main([*words, "--no-run"]) == 2 and "its numbers are of another" in capsys.readouterr().err
    assert pareto.main(words) == 0 and len(list((tmp_path / "results" / "runs" / "pareto").iterdir())) == 2
    shutil.rmtree(tmp_path / "results")
    data = json.loads(kept.read_text())
    del data["about"]["inputs_sha256"]
    kept.write_text(json.dumps(data))
    assert pareto.main([*words, "--no-run"]) == 0 and "does not say of which base config" in capsys.readouterr().err


@pytest.mark.parametrize("edit, said", [
    ({"block cubic x10": {"/config/time/dt_s": 0.02}}, "are not runs of the same config: /time/dt_s: 0.01 and 0.02"),
    ({"block cubic x10": {"/summary/wall_s": float("inf")}}, "#/summary/wall_s: found inf; allowed: a finite number")])
def test_bad_records(monkeypatch, tmp_path, capsys, edit, said):
    install(tmp_path, monkeypatch, {}, edit)
    assert pareto.main([str(spec_file(tmp_path)), "--results", str(tmp_path / "r"), "--runs", str(tmp_path / "runs")]) == 2
    assert said in capsys.readouterr().err and not (tmp_path / "r").exists()


def test_nothing_ever_touches(monkeypatch, tmp_path, capsys):
    install(tmp_path, monkeypatch, {"block": None})
    assert pareto.main([str(spec_file(tmp_path)), "--results", str(tmp_path / "r"), "--runs", str(tmp_path / "runs")]) == 2
    assert "#/scenes/block: no run is in contact" in capsys.readouterr().err


def test_the_page_is_made_of_the_kept_numbers():
    runs = pareto.from_json(ROOT / "results" / "pareto.json")
    assert (ROOT / "results" / "PARETO.md").read_text() == markdown(runs) and pareto.to_json(runs) == (ROOT / "results" / "pareto.json").read_text()
    assert runs.about.get("inputs_sha256", inputs := inputs_sha256(make_sweep(read_spec(pareto.DEFAULT)))) == inputs
    assert runs.about["spec_sha256"] == read_spec(pareto.DEFAULT).sha256 and len(runs.rows) == len(make_sweep(read_spec(pareto.DEFAULT)).notes)
    assert all((ROOT / "docs" / f"pareto_{scene}.png").is_file() for scene in runs.scenes)


def test_the_real_program(program, monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    path = spec_file(tmp_path, starts=1, set={"/step_solver/max_iterations": 40, "/diagnose/stages": ["full"]})
    assert pareto.main([str(path), "--results", str(tmp_path / "r"), "--runs", str(tmp_path / "runs")]) == 0, capsys.readouterr()
    runs = pareto.from_json(tmp_path / "r" / "pareto.json")
    gaps = [row["gap"] for row in runs.of("block", "log")]
    assert len(runs.rows) == 10 and gaps == sorted(gaps) and 0 < gaps[0] < 0.3 * gaps[-1]  # more stiffness, more gap
    assert {row["outcome"] for row in runs.of("block", "cubic") if row["scale"] < 1} == {"stall_overload"}  # above capacity
    assert all(row["newton"] and row["cond_p95"] and row["pcg_probe"] and row["seconds"] for row in runs.rows if row["outcome"] == "ok")


def test_a_path_inside_another_ends_no_range():
    """The log's path covers all gaps from 0.05 to 0.5; the cubic's short one begins later and ends earlier."""
    within = rows(lambda f, s, k: {"gap": 0.05 * 10 ** ((math.log10(s) + 2) / 4)} if f == "log" else {"gap": 0.2 * 1.1 ** math.log10(s)})
    assert [(pytest.approx(low), pytest.approx(high)) for low, high in unreached(within, "a")] == [(0, 0.05), (0.5, 1)]

"""The verb gap-map: its spec, a real map of one tiny scene, and what it refuses."""

import json
import re
from pathlib import Path

import pytest
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.gap_map import entry, kept, report, runs, table
from barrierbench_analysis.studies.gap_map.spec import cells, limit_settings, make_sweep, part, read_spec

ROOT = Path(__file__).resolve().parents[2]

SHIPPED = ROOT / "configs" / "gap_map" / "default.json"


def small(tmp_path, **edits):
    """A scene of one resting triangle, whose gap and load are known."""
    spec = {"schema": "barrierbench.gap_map/1", "name": "small", "doc": "one block", "base": str(ROOT / "configs/scenes/hang.json"), "set": {},
            "shapes": [{"label": name, "shape": shape, "argument": argument} for name, shape, argument in (
                ("log", "log", "gap"), ("cubic", "cubic", "gap"), ("cubic_of_square", "cubic", "squared_gap"))],
            "main": ["log", "cubic"], "gaps": [0.5, 0.1], "limits": ["off"],
            "scenes": [{"label": "block", "obstacle": "analytic", "set": {"/scene": {"name": "resting_block_1d"}, "/time/steps": 60},
                        "resolutions": {"1": {"unknowns": 9, "set": {"/scene/mass_kg": 0.3}}}}],
            "quick": {"scenes": {"block": ["1"]}, "shapes": ["log", "cubic"], "gaps": [0.5], "limits": ["off"]}} | edits
    file = tmp_path / "small.json"
    file.write_text(json.dumps(spec))
    return file


def test_the_shipped_map_has_what_was_asked_for():
    spec = read_spec(SHIPPED)
    assert len(spec.scenes) >= 6 and any(s.obstacle == "mesh" for s in spec.scenes) and len(spec.shapes) >= 7 and len(spec.gaps) == 8 and set(spec.limits) == {"on", "contact", "off"}
    assert all(len(s.resolutions) == 4 for s in spec.scenes) and 4000 < max(n for s in spec.scenes for n in s.unknowns.values()) <= 5000
    some = part(spec, "quick")
    assert {c.label for c in cells(some)} < {c.label for c in cells(spec)} and len(cells(some)) <= 260 and {"on", "off"} <= set(some.limits)
    large = part(spec, "large")
    assert {s.label for s in large.scenes} == {s.label for s in spec.scenes} and max(n for s in large.scenes for n in s.unknowns.values()) > 4000
    assert kept.digests(some).items() < kept.digests(spec).items()  # a quick map's records are part of the whole
    first = [c for c in cells(spec) if (c.scene, c.resolution) == ("cloth", "8")]
    assert len(make_sweep(spec, first).notes) == len(first)


def test_sweeps_are_of_one_pilot_and_the_smallest_come_first():
    spec = read_spec(SHIPPED)
    parts = runs.chunks(spec, cells(spec))
    assert sum(map(len, parts)) == len(cells(spec)) and {len(part) for part in parts} == {len(spec.shapes)}
    assert all(len({(c.scene, c.resolution, c.limit, c.theta) for c in part}) == 1 for part in parts)
    sizes = [next(s for s in spec.scenes if s.label == part[0].scene).unknowns[part[0].resolution] for part in parts]
    assert sizes == sorted(sizes) and sizes[0] == 108 and sizes[-1] == 4800


def test_a_limit_that_is_the_same_in_every_run_undoes_theta():
    assert limit_settings("contact", "cubic", "gap", 0.1)["/strain_limit/stiffness_policy"]["scale"] == pytest.approx(1)
    deep = limit_settings("contact", "cubic", "gap", 0.01)
    assert deep["/strain_limit/shape"] == "log" and deep["/strain_limit/stiffness_policy"]["scale"] == pytest.approx(8.75, rel=0.01)
    assert limit_settings("off", "cubic", "gap", 0.01) == {"/strain_limit/enabled": False} and limit_settings("on", "cubic", "gap", 0.01)["/strain_limit/shape"] == "cubic"


@pytest.mark.parametrize("edit, words", [({"gaps": [0.1, 0.5]}, "gaps"), ({"gaps": [0.5, 0.0]}, "gaps"), ({"limits": ["of"]}, "on, contact, off"), ({"main": ["cubic"]}, "main"),
                                         ({"base": "nowhere.json"}, "base"), ({"extra": 1}, "extra"), ({"scenes": [{"label": "x"}]}, "obstacle"), ({"quick": {}}, "quick/scenes: is missing"), ({"quick": []}, "quick: found"),
                                         ({"gaps": [0.5, 1.0]}, "gaps/1: found 1.0; a gap in"), ({"gaps": [0.5, 0.5]}, "gaps: found .0.5, 0.5.; a falling list"), ({"limits": ["on", "on"]}, "limits: found"),
                                         ({"shapes": [{"label": "log", "shape": "log", "argument": "gaps"}]}, "shapes/0/argument: found 'gaps'; one of gap, squared_gap"),
                                         ({"scenes": [{"label": "x", "obstacle": "none", "set": {}, "resolutions": {"1": {"set": {}}}}]}, "scenes/0/resolutions/1/unknowns: is missing"),
                                         ({"quick": {"scenes": {"block": ["2"]}, "shapes": ["log"], "gaps": [0.5], "limits": ["off"]}}, "quick/scenes/block: found .'2'.; a list of some of 1, each once")])
def test_a_bad_spec_is_refused_with_its_place(tmp_path, edit, words):
    file = small(tmp_path, **edit)
    with pytest.raises(UserError, match=re.escape(str(file)) + f".*{words}"):
        part(read_spec(file), "quick")


@pytest.fixture(scope="module")
def real(program, tmp_path_factory):
    """A map of real runs, made once."""
    folder = tmp_path_factory.mktemp("map")
    file = small(folder)
    patch = pytest.MonkeyPatch()
    patch.setenv("BARRIERBENCH_PROGRAM", program)
    words = [str(file), "--runs", str(folder / "runs"), "--results", str(folder / "out")]
    assert entry.main(words) == 0
    yield folder, words
    patch.undo()


@pytest.fixture
def undrawn(monkeypatch):
    """What is kept and what is said does not come from the figures, which take most of a call's time; `real` has them."""
    monkeypatch.setattr(entry.figure, "draw_all", lambda *_: [])


def test_a_block_rests_at_its_target_and_a_theta_beyond_the_peak_is_named(real):
    folder, _ = real
    found = {(r["shape"], r["theta"]): r for r in table.read(folder / "out/gap_map.json").rows}
    for shape in ("log", "cubic"):
        for theta in (0.5, 0.1):  # matched to the impact, which is more than the weight: the rest is farther off
            row = found[shape, theta]
            assert row["outcome"] == "ok" and theta < row["gap"] < 6 * theta and row["unknowns"] == 9 and row["cond_end"] >= row["nc_end"] > 0
        assert found[shape, 0.1]["gap"] < found[shape, 0.5]["gap"]
    assert found["log", 0.1]["gap"] < found["cubic", 0.1]["gap"]  # a bounded force is spent on the impact
    assert found["cubic", 0.1]["rho"] == pytest.approx(2 / (1 - found["cubic", 0.1]["gap"]), rel=1e-4)
    beyond = found["cubic_of_square", 0.1]
    assert beyond["outcome"] == "cannot reach" and beyond["gap"] is None and beyond["run"] is None
    assert found["cubic_of_square", 0.5]["outcome"] == "ok"
    page = (folder / "out/GAP_MAP.md").read_text()
    assert "| `cubic_of_square` | no strain limit | 0.1 | cannot reach 1 |" in page and "not run" in page
    assert all((folder / "out" / name).is_file() for name in ("gap_map.png", "gap_law.png", "gap_map_more.png", "gap_map.txt"))


def test_page_and_figures_come_from_the_kept_numbers_alone(real, tmp_path):
    folder, _ = real
    page = (folder / "out/GAP_MAP.md").read_text()
    kept = table.read(folder / "out/gap_map.json")
    assert report.markdown(kept) == page
    table.write(kept, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_text() == (folder / "out/gap_map.json").read_text()


def test_finished_runs_are_not_made_again_and_missing_ones_are_named(real, undrawn):
    folder, words = real
    before = {path: path.stat().st_mtime_ns for path in (folder / "runs").rglob("run.json")}
    assert before and entry.main(words) == 0 and {path: path.stat().st_mtime_ns for path in (folder / "runs").rglob("run.json")} == before
    gone = next(path for path in before if "theta0.1" in json.loads(path.read_text())["labels"]["note"])
    label = json.loads(gone.read_text())["labels"]["note"]
    kept = gone.read_text()
    gone.unlink()
    try:
        assert entry.main([*words, "--no-run", "--anew"]) == 0  # what was not run again stays
        assert not [r for r in table.read(folder / "out/gap_map.json").rows if r["outcome"] == "not run"]
        (folder / "out/gap_map.json").unlink()
        assert entry.main([*words, "--no-run"]) == 0  # as if no row had been kept
        missing = [r for r in table.read(folder / "out/gap_map.json").rows if r["outcome"] == "not run"]
        assert len(missing) == 1 and f"{missing[0]['shape']} off theta{missing[0]['theta']:g}" in label and missing[0]["gap"] is None
    finally:
        gone.write_text(kept)
        assert entry.main([*words, "--no-run"]) == 0


def test_the_store_of_another_map_is_not_written_over(real, tmp_path, capsys):
    folder, _ = real
    before, other = (folder / "out/gap_map.json").read_bytes(), small(tmp_path, name="mine")
    (tmp_path / "none").mkdir()
    assert entry.main([str(other), "--no-run", "--runs", str(tmp_path / "none"), "--results", str(folder / "out")]) == 2
    assert "'mine'" in capsys.readouterr().err and (folder / "out/gap_map.json").read_bytes() == before


def test_rows_of_earlier_calls_are_kept_while_their_settings_are_the_same(real, undrawn, tmp_path):
    """Records are gone as on another machine: nothing is run again, until a setting or --anew asks for it."""
    folder, words = real
    out = tmp_path / "out"
    out.mkdir()
    (out / "gap_map.json").write_text((folder / "out/gap_map.json").read_text())
    elsewhere = [words[0], "--runs", str(tmp_path / "runs"), "--results", str(out)]
    (tmp_path / "runs").mkdir()
    assert entry.main(elsewhere) == 0 and not list((tmp_path / "runs").rglob("run.json"))
    assert table.read(out / "gap_map.json").rows == table.read(folder / "out/gap_map.json").rows
    assert entry.main([*elsewhere, "--anew"]) == 0 and len(list((tmp_path / "runs").rglob("run.json"))) == 5
    longer = small(tmp_path, set={"/time/steps": 61})
    (tmp_path / "none").mkdir()
    assert entry.main([str(longer), "--no-run", "--runs", str(tmp_path / "none"), "--results", str(out)]) == 2  # none of them counts


def test_a_part_of_a_map_says_what_is_not_run_and_goes_on(real, undrawn, tmp_path, capsys):
    folder, words = real
    mine = [words[0], "--runs", str(tmp_path / "runs"), "--results", str(tmp_path / "out")]
    (tmp_path / "runs").mkdir(), (tmp_path / "out").mkdir()
    assert entry.main([*mine, "--minutes", "1e-9"]) == 2 and "no run of this map is there" in capsys.readouterr().err
    assert not list((tmp_path / "runs").rglob("run.json"))
    assert entry.main([*mine, "--quick"]) == 0 and "3 of 6 cells are not run yet" in capsys.readouterr().err
    page = (tmp_path / "out/GAP_MAP.md").read_text()
    assert "**3 of 6 cells are not run yet**" in page and "block 1: 2 of 5" in page
    assert [r["outcome"] for r in table.read(tmp_path / "out/gap_map.json").rows].count("not run") == 3
    assert entry.main(mine) == 0 and "not run yet" not in capsys.readouterr().err
    mine, whole = (table.read(path / "out/gap_map.json").rows for path in (tmp_path, folder))
    assert [r | {"seconds": None} for r in mine] == [r | {"seconds": None} for r in whole]


def test_numbers_of_another_spec_and_records_of_other_settings_are_refused(real, tmp_path, capsys):
    folder, words = real
    other = small(tmp_path, doc="another")
    assert entry.main([str(other), "--no-run", "--runs", str(tmp_path / "none"), "--results", str(folder / "out")]) == 2 and "another" in capsys.readouterr().err
    swapped = json.loads(small(tmp_path).read_text())
    swapped["shapes"][1]["shape"] = "quadratic"
    (tmp_path / "swapped.json").write_text(json.dumps(swapped))
    assert entry.main([str(tmp_path / "swapped.json"), "--no-run", "--runs", str(folder / "runs"), "--results", str(tmp_path)]) == 2
    assert "asks for" in capsys.readouterr().err
    sized = json.loads(small(tmp_path).read_text())
    sized["scenes"][0]["resolutions"]["1"]["unknowns"] = 12
    (tmp_path / "sized.json").write_text(json.dumps(sized))
    assert entry.main([str(tmp_path / "sized.json"), "--no-run", "--runs", str(folder / "runs"), "--results", str(tmp_path)]) == 2
    assert "its runs have 9" in capsys.readouterr().err


def of_cell(spec, cell, **limit):
    """What check_cell reads of a record of a cell, with another limit where one is given."""
    shape, argument = spec.shapes[cell.shape]
    asked = {key.rpartition("/")[2]: value for key, value in limit_settings(cell.limit, shape, argument, cell.theta).items()}
    policy = {"scale": 1.0, **asked.get("stiffness_policy", {})}
    strain = {"enabled": False} if cell.limit == "off" else {"enabled": True, **asked, "stiffness_policy": policy}
    return {"config": {"formulation": {"shape": shape, "argument": argument}, "strain_limit": {**strain, **limit}}, "matching": {"theta": cell.theta}, "scene": {"free_dofs": 9}}


@pytest.mark.parametrize("mode, limit", [("off", {"enabled": True, "shape": "log"}), ("contact", {"enabled": False}), ("contact", {"shape": "cubic"}), ("on", {"shape": "log"}), ("on", {"argument": "squared_gap"}),
                                         ("contact", {"stiffness_policy": {"name": "fixed", "scale": 1.0}}), ("on", {"stiffness_policy": {"name": "elasticity_inclusive"}}), ("on", {"enabled": False})])
def test_a_record_of_another_limit_is_none_of_its_cell(tmp_path, mode, limit):
    spec = read_spec(small(tmp_path, limits=["on", "contact", "off"], gaps=[0.5, 0.01], main=["log", "cubic"], quick={"scenes": {"block": ["1"]}, "shapes": ["log"], "gaps": [0.5], "limits": ["off"]}))
    cell = next(c for c in cells(spec) if (c.shape, c.limit, c.theta) == ("cubic", mode, 0.01))
    entry.check_cell(spec, cell, of_cell(spec, cell), tmp_path)
    with pytest.raises(UserError, match="asks for: remove this folder"):
        entry.check_cell(spec, cell, of_cell(spec, cell, **limit), tmp_path)


def test_a_plan_runs_nothing(real, capsys):
    folder, words = real
    assert entry.main([*words, "--plan"]) == 0
    assert re.search(r"all +: 5 runs, 5 there", capsys.readouterr().out)


def test_the_page_is_made_of_the_kept_numbers_a_second_time_too(real, undrawn, tmp_path, monkeypatch):
    """Figures of the first call lie in the folder of the records, and are none: nothing is collected anew."""
    monkeypatch.setattr(entry, "make_map", None)
    folder, words = real
    (tmp_path / "out").mkdir()
    (tmp_path / "out/gap_map.json").write_text((folder / "out/gap_map.json").read_text())
    mine = [words[0], "--no-run", "--runs", str(tmp_path / "runs"), "--results", str(tmp_path / "out")]
    for _ in range(2):
        assert entry.main(mine) == 0 and (tmp_path / "out/GAP_MAP.md").read_text() == (folder / "out/GAP_MAP.md").read_text()
        (tmp_path / "runs/figures").mkdir(parents=True, exist_ok=True)
    assert table.read(tmp_path / "out/gap_map.json").rows == table.read(folder / "out/gap_map.json").rows

"""What a report says of records with known numbers, what it refuses, and that nothing half-written is left."""

import html
import importlib.util
import json
import re
import shutil
from pathlib import Path
from urllib.parse import unquote

import pytest

from barrierbench_analysis.io import fields
from barrierbench_analysis.pages.report import apart, figures, methods, players, tables, verb, verdict
from barrierbench_analysis.tables import words
from barrierbench_analysis.pages.report.comparison import compared, quotients
from barrierbench_analysis.pages.report.gather import gathered
from report_runs import changed, conditions

pytestmark = pytest.mark.usefixtures("without_figures")


def texts(sentences) -> str:
    return "\n".join(one.text for one in sentences)


def page_of(folder: Path) -> str:
    assert verb.main([str(folder)]) == 0
    return (folder / "report.html").read_text()


def refused(capsys, *arguments) -> str:
    assert verb.main([str(word) for word in arguments]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith("bench report: ")
    return said.err


def left_behind(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if "report" in path.name or ".tmp." in path.name]


# --- verdict


def test_the_headline_counts_what_ended_ok_and_names_the_rest(runs):
    found = verdict.headline(gathered(runs))
    assert found.text == "3 of 4 runs ended ok and are valid; 1 ended newton_stall." and found.tone == verdict.BAD
    changed(runs / "quadratic", status={"outcome": "ok", "valid": True})
    assert verdict.headline(gathered(runs)) == verdict.Sentence("All 4 runs ended ok and are valid.", verdict.GOOD)
    changed(runs / "quadratic", status={"outcome": "ok", "valid": False})
    assert "1 ended ok but not valid" in verdict.headline(gathered(runs)).text


def test_crossings_are_counted_over_audited_runs_alone(runs):
    (clean,) = verdict.crossings(gathered(runs))
    assert clean.text.startswith("In all 4 audited runs no surface passes through another: 36 primitives") and clean.tone == verdict.GOOD
    changed(runs / "cubic", audit={"crossings": 2, "violations": 1})
    changed(runs / "log", audit={"enabled": False})
    changed(runs / "cubic_dynamic", audit={"judged": 0})
    through, dark = verdict.crossings(gathered(runs))
    assert through == verdict.Sentence("In 1 of 2 audited runs a surface passes through another: strip: cubic (3).", verdict.BAD)
    assert dark.text == "Of 2 runs nothing is known about crossings: not audited." and dark.tone == verdict.BAD
    changed(runs / "cubic", audit={"crossings": 0, "violations": 0, "unproven": 4})
    assert "Not every motion could be certified in strip: cubic." in texts(verdict.crossings(gathered(runs)))


def test_factors_are_of_comparable_pairs_and_name_slice_and_reference(runs):
    folder = gathered(runs)
    (said,) = verdict.comparability(folder)
    assert said.text.startswith("Of 2 runs that the program compared with a reference 1 is comparable with it")
    assert "within a factor 2 of" in said.text and said.text.endswith("1 is not, and no factor is given for them: strip: cubic_dynamic.")
    (ratio,) = verdict.ratios(folder)
    assert ratio.text == (
        "strip (scene drape2d, stiffness by equal_force at theta 0.2, strain limit on), over the reference log: cubic: median condition"
        " number 2.5 times, Newton iterations 1 times, PCG iterations 1 times.")
    changed(runs / "cubic", comparability={"verdict": "not_comparable"})
    assert list(verdict.ratios(gathered(runs))) == []


def test_a_reference_that_is_another_run_or_failed_gives_no_factor(runs):
    cubic = next(entry for entry in gathered(runs).entries if entry.row["formulation"] == "cubic")
    assert quotients(gathered(runs), cubic)["cond_raw"] == pytest.approx(2.5)
    changed(runs / "log", status={"outcome": "newton_stall", "valid": False})
    assert quotients(gathered(runs), cubic) == {}
    changed(runs / "log", status={"outcome": "ok", "valid": True}, ids={"run_id": "0" * 64})
    assert gathered(runs).reference_of(cubic) is None and quotients(gathered(runs), cubic) == {}


def test_factors_over_several_pairs_are_a_geometric_mean_with_its_ends(runs):
    for name, cond in (("log", 100), ("cubic", 160)):
        shutil.copytree(runs / name, runs / "fine" / name)
        changed(runs / "fine" / name, summary={"cond": conditions(cond)})
    row = next(one for one in compared(gathered(runs)) if one.factors)
    found = row.factors["cond_raw"]
    assert (row.contender, row.reference, found.n) == ("cubic", "log", 2)
    assert (found.mean, found.low, found.high) == pytest.approx((2.0, 1.6, 2.5))
    assert "2 times (1.6 to 2.5 in 2 pairs)" in texts(verdict.ratios(gathered(runs)))


def test_without_a_reference_nothing_is_compared_and_that_is_said(runs):
    for name in ("log", "cubic", "cubic_dynamic", "quadratic"):
        changed(runs / name, comparability={"verdict": "no_reference", "reference_run": "", "reference_run_id": ""})
    assert texts(verdict.comparability(gathered(runs))).startswith("No record names a reference")
    assert list(verdict.ratios(gathered(runs))) == []


def test_what_it_does_not_say_follows_the_records(runs):
    said = "\n".join(verdict.limits(gathered(runs)))
    for part in (
        "One scene (drape2d): nothing", "(drape2d: 12 vertices)", "theta 0.2, time step (s) 0.01 and d_hat (m) 0.01", "from one start",
        "friction is 0", "says nothing about seconds", "Times are of 1 repetition a case on 1 machine", "One class of processors"):
        assert part in said
    changed(runs / "cubic", labels={"scene": "a"}, ids={"machine_id": "d" * 64}, config={"seeds": {"main": 2}, "friction": {"mu": 0.5}})
    changed(runs / "log", labels={"scene": "b", "dt_s": 0.005}, matching={"theta": 0.1})
    changed(runs / "quadratic", summary={"convergence": "not_asked"})
    said = "\n".join(verdict.limits(gathered(runs)))
    for part in ("One scene", "from one start", "friction is 0", "One class of processors", "theta 0.2", "time step"):
        assert part not in said
    assert "Records of 1 build and 2 machines" in said and "1 run is not asked to converge" in said and "strip: quadratic" in said


def test_a_run_that_does_not_count_shows_no_time(runs):
    assert {entry.row["formulation"]: entry.wall_s for entry in gathered(runs).entries} == {
        "log": 2.0, "cubic": 2.0, "cubic_dynamic": 2.0, "quadratic": None}


# --- words


def test_every_word_of_the_schema_has_a_meaning():
    document = fields.schema("run")["$defs"]
    assert list(words.OUTCOMES) == document["Status"]["properties"]["outcome"]["enum"]
    assert set(words.COMPARED) == set(document["Comparability"]["properties"]["verdict"]["enum"])
    assert "does not know" in words.meaning("a_new_word")


# --- the page


def test_failures_stand_before_any_number_and_every_row_has_its_command(runs):
    text = page_of(runs)
    places = [text.index(f'<section id="{name}"') for name in ("verdict", "failures", "comparison", "runs", "methods")]
    assert places == sorted(places) and text.count("<h1>") == 1
    failed = text[places[1] : places[2]]
    assert "newton_stall" in failed and "without converging" in failed and "step 2 ended at its cap" in failed and "3 of 5" in failed
    rows = text[places[3] : places[4]].split("<tbody>")[1].split("</tbody>")[0].split("<tr>")[1:]
    assert len(rows) == 4
    for row in rows:
        command = html.unescape(re.search(r'data-copy="([^"]*)"', row)[1])
        assert command.startswith("./bench run ") and Path(command.split(" ")[-1]).is_file()
        assert (runs / unquote(html.unescape(re.search(r'href="([^"]*)"', row)[1]))).is_file()


def config_of(folder: Path, **sections) -> None:
    config = json.loads((folder / "run.json").read_text())["config"]
    changed(folder, config={name: {**config.get(name, {}), **values} for name, values in sections.items()})


def test_the_methods_text_has_duration_and_friction_in_whatever_form_they_are_given(runs):
    said = "\n".join(methods.text(gathered(runs)))
    assert "duration 0.05 s" in said and "Friction: none." in said
    for name in ("log", "cubic", "cubic_dynamic", "quadratic"):
        config_of(runs / name, time={"duration_s": None, "steps": 5})
    assert "duration 0.05 s" in "\n".join(methods.text(gathered(runs)))
    slides = {"mu": 0.3, "law": "smoothed_coulomb", "combine": "min", "eps_v_m_per_s": 0.001, "lag_iterations": 2}
    config_of(runs / "log", friction=slides)
    config_of(runs / "cubic", friction={**slides, "mu": 0.0}, scene={"obstacles": [{"friction": 0.5}], "bodies": [{}, {"friction": 0.25}]})
    said = "\n".join(methods.text(gathered(runs)))
    assert "none (2 runs)" in said
    assert "law smoothed_coulomb, coefficient 0.3, of two sides by the rule min, full above a sliding speed of 0.001 m/s, solved 2 times" in said
    assert "coefficient 0, 0.25 and 0.5 of bodies or obstacles with their own" in said


def test_the_methods_text_is_that_of_the_records(runs):
    said = "\n".join(methods.text(gathered(runs)))
    for part in (
        "4 runs of 1 sweep or scene (strip); 3 ended ok", "drape2d (4 runs, 30 unknowns)", "equal_force, theta 0.2", "at most 77 iterations",
        "4e-05 m/s", "implicit_euler", "a cpu, 2 cores", "commit 0123456789", "2024-01-31", "3.99.0", "Strain limit: on"):
        assert part in said
    changed(runs / "log", config={"step_solver": {"max_iterations": 5}}, machine={"cpu_model": "another"})
    said = "\n".join(methods.text(gathered(runs)))
    assert "77 (3 runs) and 5 (1 run) iterations" in said and "a cpu (3 runs) and another (1 run)" in said


def test_the_page_asks_for_nothing_and_is_the_same_again(runs):
    text = page_of(runs)
    assert "default-src 'none'" in text and not re.search(r'(?:src|href)="(?:https?:|//|/)', text)
    assert not re.search(r"@import|url\(", text)
    assert page_of(runs) == text


def test_names_from_records_are_no_markup(runs):
    changed(runs / "log", labels={"note": "strip: <script>alert(1)</script>"}, status={"detail": '"><img src=x>'})
    text = page_of(runs)
    assert "<script>alert" not in text and "<img src=x" not in text and "&lt;script&gt;alert" in text


def test_a_swept_setting_is_a_column_where_it_differs(runs):
    changed(runs / "log", labels={"swept": {"/time/dt_s": "0.01", "/a": "1"}})
    changed(runs / "cubic", labels={"swept": {"/time/dt_s": "0.005", "/a": "1"}})
    entries = [entry for entry in gathered(runs).entries if entry.row["formulation"] in ("log", "cubic")]
    assert tables.pointers(entries) == ["/time/dt_s"]


def list_cases(runs: Path, *names: str) -> None:
    cases = [{"folder": name, "label": name, "config_id": "0" * 64, "swept": {}} for name in names]
    (runs / "cases.json").write_text(json.dumps({"schema": "barrierbench.cases/1", "sweep": "strip", "cases": cases}))


def test_a_run_without_a_record_and_a_file_that_cannot_be_read_are_failures(runs):
    list_cases(runs, "log", "never", "cubic", "cubic_dynamic", "quadratic")
    (runs / "cubic/run.json").write_text('{"schema": ')
    folder = gathered(runs)
    assert [one.label for one in folder.absent] == ["never"] and folder.entries[0].run == "log"
    assert verdict.headline(folder).text == (
        "2 of 3 runs ended ok and are valid; 1 ended newton_stall; 1 run of the sweeps has no record yet; 1 file cannot be read.")
    rows = [[cell.text for cell in row] for row in apart.failures(folder, runs / "report.html").rows]
    assert [row[2] for row in rows] == ["newton_stall", "no record", "unreadable"]
    assert f"{runs / 'cubic/run.json'}: not JSON" in rows[2][4]


def test_a_lost_or_torn_trace_is_a_failure_on_the_page_and_on_stdout(runs, capsys):
    changed(runs / "quadratic", status={"outcome": "ok", "valid": True})
    (runs / "cubic/trace.jsonl").unlink()
    (runs / "log/trace.jsonl").write_text('{"step": 0')
    text = page_of(runs)
    assert "every file could be read" not in text
    assert "4 of 4 runs ended ok and are valid; 2 files cannot be read." in capsys.readouterr().out
    rows = [[cell.text for cell in row] for row in apart.failures(gathered(runs), runs / "report.html").rows]
    assert [row[2] for row in rows] == ["unreadable"] * 2 and {row[0] for row in rows} == {"cubic", "log"}
    assert {row[4].split(": ")[0] for row in rows} == {str(runs / "cubic/trace.jsonl"), str(runs / "log/trace.jsonl")}


def test_a_record_of_an_earlier_form_of_the_sweep_is_in_no_number_and_named(runs):
    list_cases(runs, "log", "cubic", "cubic_dynamic")
    folder = gathered(runs)
    assert [entry.run for entry in folder.entries] == ["log", "cubic", "cubic_dynamic"]
    assert folder.earlier == [runs / "quadratic/run.json"]
    assert verdict.headline(folder) == verdict.Sentence(
        "3 of 3 runs ended ok and are valid; 1 record of an earlier sweep file left out.", verdict.BAD)
    (row,) = [[cell.text for cell in row] for row in apart.failures(folder, runs / "report.html").rows]
    assert row[0] == "quadratic" and row[2] == "left out"


# --- refusals


def test_what_has_no_records_is_refused_with_what_is_allowed(tmp_path, capsys):
    assert f"{tmp_path / 'none'}: found nothing there; allowed: a folder with records" in refused(capsys, tmp_path / "none")
    assert f"{tmp_path}: no record that can be read; allowed: a folder with run.json below it" in refused(capsys, tmp_path)
    (tmp_path / "file").write_text("")
    assert "found a file; allowed: a folder" in refused(capsys, tmp_path / "file")
    assert left_behind(tmp_path) == []


@pytest.mark.parametrize("content, said", [
    ('{"schema": {"name": "barrierbench.run", "version": "9.0.0"}}', '#/schema: found {"name": "barrierbench.run", "version": "9.0.0"}; allowed: barrierbench.run 3.x.y'),
    ('{"schema": {"name": "barr', "not JSON"),
    ("[1]", "found [1]; allowed: an object"),
])
def test_records_of_another_schema_and_half_written_ones_are_named(tmp_path, capsys, content, said):
    (tmp_path / "run").mkdir()
    (tmp_path / "run/run.json").write_text(content)
    (tmp_path / "stopped").mkdir()
    (tmp_path / "stopped/run.json.part").write_text("{")
    error = refused(capsys, tmp_path)
    assert f"{tmp_path / 'run/run.json'}" in error and said in error
    assert f"{tmp_path / 'stopped/run.json.part'}: a record that was not finished" in error and left_behind(tmp_path) == []


def test_a_page_that_cannot_be_written_is_an_error_and_leaves_nothing(runs, capsys, monkeypatch):
    (runs / "taken").write_text("")
    assert f"{runs / 'taken/a.html'}: cannot be written" in refused(capsys, runs, "--out", runs / "taken/a.html")

    def denied(self, data):
        raise PermissionError(13, "Permission denied", str(self))

    (runs / "report.html").write_text("the one before")
    monkeypatch.setattr(Path, "write_bytes", denied)
    error = refused(capsys, runs)
    assert f"{runs / 'report.html'}: cannot be written: Permission denied; allowed: a file in a folder that may be written to" in error
    assert (runs / "report.html").read_text() == "the one before" and len(left_behind(runs)) == 1


@pytest.mark.parametrize("words", [("--players", "-1"), ("--players", "x"), ()])
def test_options_that_are_none_are_refused(words, runs, capsys):
    assert verb.main([str(runs) for _ in range(0 if not words else 1)] + list(words)) == 2
    assert (words[0] if words else "DIR") in capsys.readouterr().err


# --- players


def test_a_player_is_a_run_beside_its_reference(runs):
    folder = gathered(runs)
    assert players.pairs(folder) == [] and players.made(folder).notes == []
    for entry in folder.entries:
        object.__setattr__(entry, "frames", 3)
    assert [[run.row["formulation"] for run in pair] for pair in players.pairs(folder)] == [["log", "cubic"]]
    object.__setattr__(folder.entries[2], "frames", 0)  # the log
    assert folder.entries[2].row["formulation"] == "log"
    assert [[run.row["formulation"] for run in pair] for pair in players.pairs(folder)] == [["cubic"]]


def test_frames_that_cannot_be_read_are_said(runs):
    folder = gathered(runs)
    object.__setattr__(folder.entries[0], "frames", 3)
    made = players.made(folder)
    assert made.shown == [] and made.library == "" and made.notes
    if importlib.util.find_spec("k3d"):
        assert made.notes[0].startswith("No player of cubic: ") and "frames" in made.notes[0]
    else:
        assert "k3d that draws them is not installed" in made.notes[0]


def test_kept_pictures_are_those_of_the_group(tmp_path):
    for name in ("gaps_strip", "gaps_strip_more", "gaps_stripes", "condition_strip", "condition_strip_eigenvalues_more", "condition_strip_more_2", "iterations_strip"):
        (tmp_path / f"{name}.png").write_bytes(b"")
    assert [path.stem for path in figures._kept("strip", tmp_path)] == [
        "condition_strip", "condition_strip_more_2", "iterations_strip", "gaps_strip", "gaps_strip_more"]

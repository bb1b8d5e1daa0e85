"""What the command line takes beside plain options, and that its answers keep to the terminal."""

import re

import pytest
from bench_call import bench

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.tables import causes
from barrierbench_analysis.figures.pictures import render
from barrierbench_analysis.io import text_table
from barrierbench_analysis.program.formula import verb as formula
from barrierbench_analysis.front import door
from barrierbench_analysis.program import verbs
from barrierbench_analysis.studies.matching import match
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.pages.play import verb as play
from barrierbench_analysis.studies.rules.score import verb as score

COMPACT = ["-(d-d_hat)^2*log(d/d_hat)", "-d_hat^2*log(d/d_hat)", "-log(d/d_hat)*(d-d_hat)^2", "(d_hat-d)^3/d"]


@pytest.mark.parametrize("text", COMPACT)
@pytest.mark.parametrize("words", [lambda text: [text], lambda text: ["--", text]])
def test_a_formula_may_begin_with_a_minus(text, words):
    assert formula.parse(words(text)).formula == text
    assert score._arguments(words(text)).what == text


def test_the_front_door_hands_on_a_formula_that_begins_with_a_minus():
    """As a shell gives it, in a process of its own; the formula is none, so that nothing is compiled."""
    done = bench("formula", "-(d-d_hat)^2*logg(d/d_hat)")
    assert done.returncode == 2 and "unrecognized arguments" not in done.stderr and "required" not in done.stderr
    assert "logg" in done.stderr


def test_options_stand_before_a_formula_and_behind_it():
    for words in (["--json", COMPACT[0]], [COMPACT[0], "--json"]):
        given = formula.parse(words)
        assert given.json and given.formula == COMPACT[0]
    assert str(score._arguments([COMPACT[1], "--jobs", "1", "--out", "a b"]).out) == "a b"


def test_what_is_no_option_and_no_formula_is_refused():
    for words, said in ((["--jsn", "d"], "unrecognized arguments: --jsn"), ([], "required: TEXT"), (["-d", "-h_hat"], "unrecognized arguments")):
        with pytest.raises(UserError, match=said):
            formula.parse(words)


@pytest.mark.parametrize("word", ["-h", "--help"])
def test_help_stays_help(word, capsys):
    with pytest.raises(SystemExit):
        formula.parse([word])
    assert "usage: bench formula" in capsys.readouterr().out


@pytest.mark.parametrize("parse", [render.parse, play.parse])
def test_color_has_one_spelling_in_help_and_two_on_the_command_line(parse, capsys):
    assert {parse(["run", word, "stretch"]).color for word in ("--color", "--colour")} == {"stretch"}
    assert parse(["run"]).color in ("body", "gap")
    with pytest.raises(SystemExit):
        parse(["--help"])
    said = capsys.readouterr().out
    assert "--color" in said and "--colour" not in said


def test_set_is_declared_in_one_place(capsys):
    """All verbs take it from there; --set of the gate names a set of cases."""
    declared = {path.relative_to(ROOT / "analysis/src/barrierbench_analysis").as_posix() for path in (ROOT / "analysis/src/barrierbench_analysis").rglob("*.py") if re.search(r'add_argument\(\s*"--set"', path.read_text())}
    assert declared == {"program/arguments.py", "studies/gate/cases.py"}
    assert render.parse(["run", "--set", "/scene/n=8", "--set", "/time/steps=2"]).overrides == ["/scene/n=8", "/time/steps=2"]
    assert match.arguments(["config", "--set", "/scene/n=8"]).overrides == ["/scene/n=8"]
    for parse in (render.parse, match.arguments, causes.main):
        with pytest.raises(SystemExit):
            parse(["--help"])
        assert "--set /POINTER=VALUE" in capsys.readouterr().out


def test_the_last_column_of_a_table_is_broken_where_the_terminal_is_narrow(monkeypatch):
    rows = [["one", "a sentence that is longer than what is left of a line"], ["another", "short"]]
    monkeypatch.setenv("COLUMNS", "40")
    assert text_table.fitted(["name", "what"], rows) == text_table.aligned(["name", "what"], rows)  # no terminal
    monkeypatch.setattr("sys.stdout", type("Terminal", (), {"isatty": lambda self: True})())
    lines = text_table.fitted(["name", "what"], rows)
    assert max(map(len, lines)) <= 40 and len(lines) == 4
    assert lines[2].startswith(" " * 9) and " ".join(" ".join(lines).split()) == "name what one " + rows[0][1] + " another short"
    monkeypatch.setenv("COLUMNS", "200")
    assert text_table.fitted(["name", "what"], rows) == text_table.aligned(["name", "what"], rows)


def test_help_keeps_to_the_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "70")
    verb = next(verb for verb in verbs.TABLE if verb.name == "study score")
    assert max(map(len, door.help_of(verb).splitlines()[1:-1])) <= 70


@pytest.mark.parametrize("word", ["help", "--help", "-h"])
def test_help_of_a_verb_is_that_of_the_verb(word, capsys):
    with pytest.raises(SystemExit):
        door.main([word, "score"])
    assert "usage: bench study score" in capsys.readouterr().out


def test_the_version_is_that_of_the_sources(capsys):
    assert door.main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("barrierbench 0.1.0")

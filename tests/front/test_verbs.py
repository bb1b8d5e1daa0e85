"""The table of verbs: one row and one file make a verb, the help lists all of them in six groups, a wrong word gets the nearest."""

import importlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import barrierbench_analysis as analysis
from barrierbench_analysis.program import building, verbs
from barrierbench_analysis.front import door

ROOT = Path(__file__).resolve().parents[2]
CLI = ROOT / "experiments/cli"


def grouped(text: str) -> dict[str, list[str]]:
    """Group -> verbs, as the help shows them."""
    found, group = {}, ""
    for line in text.splitlines():
        if match := re.match(r"(\w+): \S", line):
            group = match[1]
        elif (match := re.match(r"  ([a-z-]+)", line)) and group:
            found.setdefault(group, []).append(match[1])
    return found


def test_the_help_has_every_verb_once_in_its_group_with_an_example(capsys):
    assert door.main([]) == 0
    text = capsys.readouterr().out
    assert list(grouped(text)) == ["run", "look", "study", "judge", "make", "develop"]
    shown = [(group, name) for group, names in grouped(text).items() for name in names]
    assert sorted(shown) == sorted((verb.group, verb.name) for verb in verbs.every())
    assert len({name for _, name in shown}) == len(shown) > 40
    for verb in verbs.every():
        assert verb.example in text and f"bench {verb.name}" in verb.example
    assert max(map(len, text.splitlines())) <= 170


@pytest.mark.parametrize("asked", ["-h", "--help"])
def test_help_of_a_verb_without_options_of_its_own_does_nothing_else(monkeypatch, capsys, asked):
    plain = [verb for verb in verbs.TABLE if not verb.own_help]
    assert {"build", "test", "python"} <= {verb.name for verb in plain}
    monkeypatch.setattr(door, "run", lambda verb, arguments: pytest.fail(f"{verb.name} was run"))
    for verb in plain:
        assert door.main([verb.name, asked]) == 0
        assert verb.help.split()[0] in (said := capsys.readouterr().out) and verb.example in said


@pytest.mark.parametrize("asked", ["-h", "--help"])
@pytest.mark.parametrize("verb", verbs.TABLE, ids=lambda verb: verb.name)
def test_every_verb_answers_for_help_with_its_usage_and_0(verb, asked, monkeypatch, capfd):
    """Nothing is built or installed for it."""
    for part in ("build", "of_script"):
        monkeypatch.setattr(building, part, lambda *_, **__: pytest.fail("something was built"))
    monkeypatch.delenv("BARRIERBENCH_PROGRAM", raising=False)
    try:
        code = door.main([verb.name, asked])
    except SystemExit as ended:  # of argparse
        code = ended.code
    said = capfd.readouterr()
    assert code == 0 and said.err == "" and said.out.startswith("usage: ") and (verb.example in said.out or verb.name == "mutate")


def test_the_script_says_the_usage_of_setup_and_installs_nothing(tmp_path):
    """PATH has no dpkg and no apt-get."""
    tools = tmp_path / "bin"
    tools.mkdir()
    for tool in ("bash", "dirname", "readlink", "cat", "cmp"):
        (tools / tool).symlink_to(shutil.which(tool))
    for words in (["setup", "--help"], ["setup", "-h"], ["help", "setup"]):
        done = subprocess.run([ROOT / "bench", *words], capture_output=True, text=True, check=False, env=os.environ | {"PATH": str(tools)})
        assert done.returncode == 0 and done.stderr == "" and "./bench setup" in done.stdout and done.stdout.startswith("usage: "), done.stderr


def test_setup_by_the_front_door_is_that_of_the_script(monkeypatch):
    ran = []
    monkeypatch.setattr(building.subprocess, "run", lambda words, **_: ran.append(words) or subprocess.CompletedProcess(words, 7))
    assert door.main(["setup", "chromium"]) == 7 and ran == [[str(ROOT / "bench"), "setup", "chromium"]]


def test_every_row_of_python_has_its_file_with_a_main():
    for verb in verbs.TABLE:
        if verb.module:
            found = importlib.util.find_spec(f"barrierbench_analysis.{verb.module}")
            assert found is not None, verb
            assert re.search(r"^def main\(", Path(found.origin).read_text(), re.MULTILINE), verb


def test_a_verb_in_python_is_one_file_and_one_row(tmp_path, monkeypatch, capsys):
    (tmp_path / "made_up.py").write_text("def main(argv):\n    print('made up', argv)\n    return 7\n")
    monkeypatch.setattr(analysis, "__path__", [*analysis.__path__, str(tmp_path)])
    row = verbs.Verb("made-up", "judge", verbs.ENVIRONMENT, "made_up", "", "one more", "./bench made-up")
    monkeypatch.setattr(verbs, "find", lambda name: next((verb for verb in (*verbs.TABLE, row) if verb.name == name), None))
    monkeypatch.setattr(verbs, "every", lambda kept=verbs.every: kept((*verbs.TABLE, row)))
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", "/nowhere")
    assert door.main(["made-up", "--well"]) == 7
    assert capsys.readouterr().out == "made up ['--well']\n"
    assert "made-up" in grouped(door.usage())["judge"]


def test_a_verb_of_the_program_is_one_file_and_one_line(tmp_path):
    """CMake and C++ take the list from the same lines, so that each has to have its file, and no other file may have a verb."""
    defined = {path.stem for path in CLI.glob("*.cpp") if re.search(rf"^Action verb::{path.stem}\(CLI::App& ", path.read_text(), re.MULTILINE)}
    assert defined == {verb.name for verb in verbs.of_program()}
    assert sum(path.read_text().count("Action verb::") for path in CLI.glob("*.cpp")) == len(defined)
    more = tmp_path / "verbs.inc"
    more.write_text(verbs.PROGRAM_VERBS.read_text() + 'BB_VERB(weigh, look, "what \\"it\\" weighs", "./bench weigh")\n')
    row = next(verb for verb in verbs.every(file=more) if verb.name == "weigh")
    assert (row.group, row.help, row.needs) == ("look", 'what "it" weighs', verbs.PROGRAM)
    more.write_text("BB_VERB(weigh, look)\n")
    with pytest.raises(ValueError, match=r"verbs.inc:1: found .*allowed: BB_VERB"):
        verbs.of_program(more)


def test_the_program_has_the_verbs_and_groups_of_the_table(program):
    listed = subprocess.run([program, "list", "verbs"], capture_output=True, text=True, check=True).stdout.splitlines()[1:]
    assert [line.split(maxsplit=2) for line in listed] == [[verb.name, verb.group, verb.help] for verb in verbs.of_program()]
    for verb in verbs.of_program():
        helped = subprocess.run([program, verb.name, "--help"], capture_output=True, text=True, check=True).stdout
        assert f"example: {verb.example}" in helped


def rows_with_a_parser() -> list[verbs.Verb]:
    """The verbs in Python that take their arguments by themselves."""
    return [verb for verb in verbs.TABLE if verb.module and "parser_of(" in (ROOT / f"analysis/src/barrierbench_analysis/{verb.module.replace('.', '/')}.py").read_text()]


@pytest.mark.parametrize("verb", rows_with_a_parser(), ids=lambda verb: verb.name)
def test_the_help_of_a_verb_in_python_is_made_of_its_row(verb, capsys):
    main = importlib.import_module(f"barrierbench_analysis.{verb.module}").main
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    said = capsys.readouterr().out
    assert ended.value.code == 0 and said.startswith(f"usage: bench {verb.name} ")
    assert verb.help[1:] in " ".join(said.split()) and f"\n  {verb.example}\n" in said
    assert main(["--no-such-option"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith(f"bench {verb.name}: ") and said.err.endswith(f"(./bench {verb.name} --help says what there is)\n")


def test_one_place_makes_parsers_of_verbs():
    """gpu_evidence is no verb: a script of experiments/ calls it."""
    assert len(rows_with_a_parser()) > 20
    makers = {path.relative_to(ROOT).as_posix() for path in (ROOT / "analysis").rglob("*.py") if "ArgumentParser(" in path.read_text()}
    assert makers == {"analysis/src/barrierbench_analysis/studies/device/gpu_evidence.py"}


@pytest.mark.parametrize(("word", "meant"), [("claim", "claims"), ("swep", "sweep"), ("gapmap", "gap-map"), ("buidl", "build")])
def test_a_wrong_word_gets_the_nearest_of_all_verbs_before_anything_is_built(word, meant, capsys):
    assert door.main([word]) == 2
    said = capsys.readouterr()
    assert said.out == "" and f"found {word!r}" in said.err and f"did you mean {meant}?" in said.err


@pytest.mark.parametrize(("verb", "arguments", "needed"), [
    ("claims", [], True), ("claims", ["--no-run"], False), ("stress", ["--list"], False), ("gate", [], True),
    ("gate", ["--matrix", "a.mtx"], False), ("gate", ["--record=run.json"], False), ("gap-map", ["--help"], False),
    ("compare", ["a", "b"], False), ("compare-toolkit", [], True)])
def test_what_judges_kept_numbers_needs_no_built_program(verb, arguments, needed):
    assert verbs.needs_program(verbs.find(verb), arguments) is needed


def test_the_front_door_starts_without_numpy(tmp_path):
    """It stands before `eval`, which answers line by line."""
    text = "import sys; sys.path[0] = sys.argv[1]\nfrom barrierbench_analysis.front import door\nfrom barrierbench_analysis.program import building\ndoor.usage()\nprint(*sorted({'numpy', 'pandas', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", text, str(ROOT / "analysis" / "src")], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert done.stdout.strip() == ""


def test_the_program_takes_the_place_of_the_front_door(tmp_path, monkeypatch):
    """Its standard streams are those of the caller, and it knows the other verbs."""
    stand_in = tmp_path / "program"
    stand_in.write_text('#!/bin/sh\necho "$BENCH_VERBS" | tr " " "\\n" | grep -c .\nread line; echo "$line $*"; exit 75\n')
    stand_in.chmod(0o755)
    text = (f"import sys; sys.path[0] = {str(ROOT / 'analysis/src')!r}\nfrom pathlib import Path\nfrom barrierbench_analysis.front import door\nfrom barrierbench_analysis.program import building\n"
            f"building.ensure_program = lambda: Path({str(stand_in)!r})\nsys.exit(door.main(['eval', '-']))")
    environment = {name: value for name, value in os.environ.items() if name != "BARRIERBENCH_PROGRAM"}
    done = subprocess.run([sys.executable, "-c", text], input="hello\n", capture_output=True, text=True, check=False, cwd=tmp_path, env=environment)
    assert done.returncode == 75 and done.stdout == f"{len(verbs.TABLE)}\nhello eval -\n", done.stderr


def called(*words, **environment) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, ROOT / "analysis", *words], capture_output=True, text=True, check=False, env=os.environ | environment)


def test_a_program_that_is_named_stands_for_the_build_in_verbs_of_the_program_too(tmp_path):
    """PATH has no CMake, so that a build would fail."""
    stand_in = tmp_path / "program"
    stand_in.write_text("#!/bin/sh\necho stand-in $*\n")
    done = called("list", "shapes", BARRIERBENCH_PROGRAM=str(stand_in), PATH="/nowhere")
    assert done.returncode == 2 and done.stderr == f"bench: BARRIERBENCH_PROGRAM: found {stand_in}: no file that can be started; allowed: a built program barrierbench\n"
    stand_in.chmod(0o755)
    done = called("list", "shapes", BARRIERBENCH_PROGRAM=str(stand_in), PATH="/nowhere")
    assert done.returncode == 2 and "does not list shapes as barrierbench does" in done.stderr
    stand_in.write_text("#!/bin/sh\necho stand-in $* cubic\n")
    done = called("list", "shapes", BARRIERBENCH_PROGRAM=str(stand_in), PATH="/nowhere")
    assert (done.returncode, done.stdout, done.stderr) == (0, "stand-in list shapes cubic\n", "")
    done = called("list", "shapes", BARRIERBENCH_PROGRAM=str(tmp_path / "none"))
    assert done.returncode == 2 and f"{tmp_path / 'none'} is not built" in done.stderr


def test_an_interrupt_says_so_and_may_be_tried_again(monkeypatch, capsys):
    def interrupted(verb, arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(door, "run", interrupted)
    assert door.main(["claims"]) == 75
    assert capsys.readouterr() == ("", "bench claims: interrupted; it may be called again\n")

"""The table of verbs: one row and one file make a verb, the help lists those on top in six groups, old names and wrong words get the name now."""

import importlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import barrierbench_analysis as analysis
from barrierbench_analysis.program import building, verb_table, verbs
from barrierbench_analysis.front import door

ROOT = Path(__file__).resolve().parents[2]
CLI = ROOT / "experiments/cli"


MOST_ON_TOP = 32


def grouped(text: str) -> dict[str, list[str]]:
    """Group -> verbs, as the help shows them."""
    found, group = {}, ""
    for line in text.splitlines():
        if match := re.match(r"(\w+): \S", line):
            group = match[1] if match[1] != "usage" else ""
        elif (match := re.match(r"  ([a-z-]+)", line)) and group:
            found.setdefault(group, []).append(match[1])
    return found


def named(verb: verbs.Verb) -> str:
    return verb.name.replace(" ", "-")


def help_and_code(words: list[str], capfd) -> tuple[str, str, int]:
    """What the front door answers in this process."""
    try:
        code = door.main(words)
    except SystemExit as ended:  # of argparse
        code = ended.code
    said = capfd.readouterr()
    return said.out, said.err, code


def test_the_help_has_every_verb_on_top_once_in_its_group_and_sub_commands_behind_their_heading(capsys):
    assert door.main([]) == 0
    text = capsys.readouterr().out
    assert list(grouped(text)) == ["run", "look", "study", "judge", "make", "develop"] == list(verbs.GROUPS)
    shown = [(group, name) for group, names in grouped(text).items() for name in names]
    assert shown == [(row.group, row.name) for row in verbs.top()]
    assert 20 < len({name for _, name in shown}) == len(shown) <= MOST_ON_TOP
    words = " ".join(text.split())
    for heading in verb_table.HEADINGS:
        names = [verb.name.split()[1] for verb in verbs.below(heading)]
        assert len(names) >= 5 and f"{heading.help}: {', '.join(names)}" in words
    assert max(map(len, text.splitlines())) <= 110 and len(text.splitlines()) < 100


def test_every_row_has_a_place_and_an_example_of_itself():
    rows = verbs.every()
    names = [row.name for row in (*rows, *verb_table.HEADINGS)]
    assert len(set(names)) == len(names) > 65
    headings = {heading.name: heading for heading in verb_table.HEADINGS}
    for verb in rows:
        assert f"./bench {verb.name}" in verb.example
        first, _, second = verb.name.partition(" ")
        assert bool(second) == (first in headings) and " " not in second
        assert verb.group in verbs.GROUPS and (not second or verb.group == headings[first].group)
        assert all(mode in verbs.MODES for mode, _ in verb.modes) and (not verb.modes or first == "study")
    for heading in headings.values():
        assert f"./bench {heading.name}" in heading.example and verbs.call_of(heading.example.split()[1:])


@pytest.mark.parametrize("asked", ["-h", "--help"])
def test_help_of_a_verb_without_options_of_its_own_does_nothing_else(monkeypatch, capsys, asked):
    plain = [verb for verb in verbs.TABLE if not verb.own_help]
    assert {"build", "test", "dev python"} <= {verb.name for verb in plain}
    monkeypatch.setattr(door, "run", lambda verb, arguments: pytest.fail(f"{verb.name} was run"))
    for verb in plain:
        assert door.main([*verb.name.split(), asked]) == 0
        assert verb.help.split()[1] in (said := capsys.readouterr().out) and verb.example in said


@pytest.mark.parametrize("asked", ["-h", "--help"])
@pytest.mark.parametrize("row", [*verbs.TABLE, *verb_table.HEADINGS], ids=named)
def test_help_is_a_usage_line_three_lines_and_an_example_and_then_options(row, asked, monkeypatch, capfd):
    """Nothing is built or installed for it."""
    for part in ("build", "of_script"):
        monkeypatch.setattr(building, part, lambda *_, **__: pytest.fail("something was built"))
    monkeypatch.delenv("BARRIERBENCH_PROGRAM", raising=False)
    monkeypatch.setenv("COLUMNS", "120")
    said, told, code = help_and_code([*row.name.split(), asked], capfd)
    assert (code, told) == (0, "")
    usage, about, example, *_ = re.split(r"\n\n", said)
    assert usage.startswith(f"usage: bench {row.name} [") or usage.startswith(f"usage: bench {row.name} NAME")
    assert usage.count("\n") == 0 and len(usage) < 120, usage
    assert 1 <= len(about.splitlines()) <= 3 and about.endswith(".") and " ".join(about.split())[1:-1] == row.help[1:]
    assert example.splitlines() == ["example:", f"  {row.example}"]


def test_a_heading_alone_lists_its_sub_commands_with_a_line_each(capfd):
    for heading in verb_table.HEADINGS:
        for words in ([heading.name], ["help", heading.name], [heading.name, "--help"]):
            if heading.default and words == [heading.name]:
                continue
            said, told, code = help_and_code(words, capfd)
            assert (code, told) == (0, "")
            below = verbs.below(heading)
            assert len(below) >= 5 and all(re.search(rf"^  {verb.name.split()[1]} +\S", said, re.M) for verb in below)


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


@pytest.mark.parametrize("name", ["made-up", "data made-up"])
def test_a_verb_in_python_is_one_file_and_one_row(name, tmp_path, monkeypatch, capsys):
    (tmp_path / "made_up.py").write_text("def main(argv):\n    print('made up', argv)\n    return 7\n")
    monkeypatch.setattr(analysis, "__path__", [*analysis.__path__, str(tmp_path)])
    row = verbs.Verb(name, "make", verbs.ENVIRONMENT, "made_up", "", "one more", f"./bench {name}")
    monkeypatch.setattr(verbs, "every", lambda kept=verbs.every: kept((*verbs.TABLE, row)))
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", "/nowhere")
    assert door.main([*name.split(), "--well"]) == 7
    assert capsys.readouterr().out == "made up ['--well']\n"
    assert "made-up" in (grouped(door.usage())["make"] if name == "made-up" else door.usage())


def test_a_verb_of_the_program_is_one_file_and_one_line(tmp_path):
    """CMake and C++ take the list from the same lines, so that each has to have its file, and no other file may have a verb."""
    defined = {path.stem for path in CLI.glob("*.cpp") if re.search(rf"^Action verb::{path.stem}\(CLI::App& ", path.read_text(), re.MULTILINE)}
    assert defined == {verb.word.replace("-", "_") for verb in verbs.of_program()}
    assert sum(path.read_text().count("Action verb::") for path in CLI.glob("*.cpp")) == len(defined)
    more = tmp_path / "verbs.inc"
    more.write_text(verbs.PROGRAM_VERBS.read_text() + 'BB_VERB(weigh_it, make, "data weigh", "what \\"it\\" weighs", "./bench data weigh")\n')
    row = next(verb for verb in verbs.every(file=more) if verb.name == "data weigh")
    assert (row.group, row.help, row.needs, row.word, row.was) == ("make", 'what "it" weighs', verbs.PROGRAM, "weigh-it", "weigh-it")
    more.write_text("BB_VERB(weigh, look)\n")
    with pytest.raises(ValueError, match=r"verbs.inc:1: found .*allowed: BB_VERB"):
        verbs.of_program(more)


def test_the_program_has_the_verbs_and_groups_of_the_table(program):
    listed = subprocess.run([program, "list", "verbs"], capture_output=True, text=True, check=True).stdout.splitlines()[1:]
    assert [re.split(r"\s+", line.strip(), maxsplit=line.count("  data ") + 2) for line in listed] == [[*verb.name.split(), verb.group, verb.help] for verb in verbs.of_program()]
    for verb in verbs.of_program():
        helped = subprocess.run([program, verb.word, "--help"], capture_output=True, text=True, check=True).stdout
        assert helped.startswith(f"{verb.help}\nUsage: bench {verb.name} [OPTIONS]") and f"\nexample: {verb.example}\n" in helped
        assert len(textwrap.wrap(verb.help, 110)) <= 3


def test_neutral_of_the_program_says_its_name_now(program):
    done = subprocess.run([program, "neutral", "none.json"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and done.stderr.startswith('note: "neutral" is now "export-scene"\n') and "none.json" in done.stderr


def rows_with_a_parser() -> list[verbs.Verb]:
    """The verbs in Python that take their arguments by themselves."""
    return [verb for verb in verbs.TABLE if verb.module and "parser_of(" in (ROOT / f"analysis/src/barrierbench_analysis/{verb.module.replace('.', '/')}.py").read_text()]


@pytest.mark.parametrize("verb", rows_with_a_parser(), ids=named)
def test_a_wrong_option_of_a_verb_in_python_is_said_with_its_name(verb, capsys):
    main = importlib.import_module(f"barrierbench_analysis.{verb.module}").main
    assert main(["--no-such-option"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith(f"bench {verb.name}: ") and said.err.endswith(f"(./bench {verb.name} --help says what there is)\n")


def test_one_place_makes_parsers_of_verbs():
    """gpu_evidence is no verb: a script of experiments/ calls it."""
    assert len(rows_with_a_parser()) > 20
    makers = {path.relative_to(ROOT).as_posix() for path in (ROOT / "analysis").rglob("*.py") if "ArgumentParser(" in path.read_text()}
    assert makers == {"analysis/src/barrierbench_analysis/studies/device/gpu_evidence.py"}


@pytest.mark.parametrize(("words", "meant"), [
    (["claim"], "study claims"), (["swep"], "sweep"), (["gapmap"], "study gap-map"), (["buidl"], "build"), (["studdy"], "study"), (["neutrl"], "export-scene"),
    (["-h", "swep"], "sweep"), (["--help", "nosense"], "scenes"), (["study", "gapmap"], "gap-map"), (["data", "matrix"], "matrices"), (["dev", "formt"], "format"), (["gate", "acept"], "accept"), (["draw", "render"], "still")])
def test_a_wrong_word_gets_the_nearest_before_anything_is_built(words, meant, capsys):
    assert door.main(words) == 2
    said = capsys.readouterr()
    assert said.out == "" and f"found {words[-1]!r}; allowed: " in said.err and said.err.endswith(f"; did you mean {meant}?\n")
    assert len(words) == 1 or all(verb.name.split()[1] in said.err for verb in verbs.every() if verb.name.startswith(f"{words[0]} "))


# --- names before these


# Every verb before there were sub-commands; each stays for a release.
BEFORE = """
ablation accept archive audit build calibrate catalogue causes ccd check claims collect compare
compare-toolkit completion condition-table demo device engine eval explain figure figures film
format formula frames fuzz gap-map gate gpu-report help judge list match matrix matrix-corpus mesh
meshes microbenchmarks mutate neutral pareto pictures plan play python readme render report robust
rooms run scenes score setup status step-corpus steps stills stress surface-gaps sweep test tidy
trend validity verify work-precision
"""


def old_names() -> dict[str, verbs.Verb]:
    return {verb.was: verb for verb in verbs.every() if verb.was}


def test_every_old_name_stands_for_one_row_and_is_neither_listed_nor_a_name_now():
    old, rows = old_names(), verbs.every()
    assert len(old) == sum(bool(verb.was) for verb in rows) >= 45
    assert not set(old) & {row.name for row in verbs.top()}
    assert set(BEFORE.split()) == set(old) | ({row.name for row in verbs.top()} & set(BEFORE.split())) and len(BEFORE.split()) == 69
    listed = [name for names in grouped(door.usage()).values() for name in names]
    assert not set(old) & set(listed)


@pytest.mark.parametrize("old", old_names())
def test_an_old_name_runs_its_verb_with_the_same_words_and_says_the_new_name(old, monkeypatch, capsys):
    verb, ran = old_names()[old], []
    monkeypatch.setattr(door, "run", lambda row, words: ran.append((row.name, words)) or 7)
    monkeypatch.setattr(door, "become_program", lambda words: ran.append((words[0], words[1:])) or 7)
    assert door.main([old, "run", "--list"]) == 7 and ran == [(verb.word or verb.name, ["run", "--list"])]
    assert capsys.readouterr() == ("", f'bench: note: "{old}" is now "./bench {verb.name}"\n')
    assert door.main([*verb.name.split(), "--list"]) == 7 and ran[1] == (verb.word or verb.name, ["--list"])
    assert capsys.readouterr() == ("", "")


def test_a_kept_text_is_shown_with_the_names_now():
    text = "`./bench gap-map`, ./bench matrix a.mtx, ./bench gap-mapper, ./bench study gap-map, ./bench run, a matrix; ./bench compare"
    now = "`./bench study gap-map`, ./bench data matrices a.mtx, ./bench gap-mapper, ./bench study gap-map, ./bench run, a matrix; ./bench gate compare"
    assert verbs.renewed(text) == now == verbs.renewed(now)


# --- gate, and modes of studies


@pytest.mark.parametrize(("words", "name", "rest"), [
    (["gate"], "gate run", []), (["gate", "--set", "small"], "gate run", ["--set", "small"]), (["gate", "run", "--set", "s"], "gate run", ["--set", "s"]),
    (["gate", "compare", "a", "b"], "gate compare", ["a", "b"]), (["gate", "-h"], "gate", ["-h"]), (["data", "steps", "a"], "data steps", ["a"]),
    (["study", "gap-map", "plan", "--jobs", "2"], "study gap-map", ["--plan", "--jobs", "2"]), (["study", "gap-map", "page"], "study gap-map", ["--no-run"]),
    (["study", "gap-map", "run", "--part", "quick"], "study gap-map", ["--part", "quick"]),
    (["study", "step-corpus", "page"], "study step-corpus", ["--table"]), (["study", "gpu-report", "page"], "study gpu-report", []),
    (["study", "claims", "plan", "K3"], "study claims", ["--plan", "K3"]), (["study", "claims", "--no-run"], "study claims", ["--no-run"]), (["study", "claims", "K3", "page"], "study claims", ["K3", "page"])])
def test_which_row_a_command_line_is_for(words, name, rest):
    asked = verbs.call_of(words)
    assert (asked.row.name, asked.rest, asked.note) == (name, rest, "")


@pytest.mark.parametrize(("words", "allowed"), [
    ("study score plan", "FORMULA|PLUGIN|NAME"), ("study matrix-corpus plan", "run or page"), ("study gpu-report run", "page"), ("study condition-table page", "run")])
def test_a_mode_that_a_study_has_not_is_refused_by_name(words, allowed, capsys, tmp_path, monkeypatch):
    assert door.main(words.split()) == 2
    verb, _, mode = words.rpartition(" ")
    assert capsys.readouterr() == ("", f"bench: {verb}: found {mode!r}; allowed: {allowed}\n")
    monkeypatch.chdir(tmp_path)
    (tmp_path / mode).touch()
    assert verbs.call_of(words.split()).rest == [mode]  # a file of this name


def test_every_mode_is_an_option_of_its_study(capfd):
    counted = 0
    for verb in verbs.every():
        for mode, option in verb.modes:
            said, _, _ = help_and_code([*verb.name.split(), "--help"], capfd)
            assert (option in said) if option else mode in ("run", "page")
            counted += 1
    assert counted > 20


@pytest.mark.parametrize(("verb", "arguments", "needed"), [
    ("study claims", [], True), ("study claims", ["--no-run"], False), ("study claims", ["--plan"], False), ("gate run", [], True),
    ("gate run", ["--matrix", "a.mtx"], False), ("gate run", ["--record=run.json"], False), ("study claims", ["--help"], False),
    ("gate compare", ["a", "b"], False), ("study compare-toolkit", [], True)])
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
    assert done.returncode == 75 and done.stdout == f"{len(verbs.top())}\nhello eval -\n", done.stderr


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
    assert door.main(["study", "claims"]) == 75
    assert capsys.readouterr() == ("", "bench study claims: interrupted; it may be called again\n")

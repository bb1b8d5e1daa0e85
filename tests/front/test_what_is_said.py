"""What verbs in Python say: control characters of names as text; warnings of libraries without their source; nothing where a reader has seen enough."""

import argparse
import json
import os
import re
import subprocess
import sys

import pytest

from barrierbench_analysis.program import streams
from barrierbench_analysis.program.arguments import finite_number
from barrierbench_analysis.io.places import ROOT
from tests import terminal
from tests.bench_call import bench

SCENE = {"schema": "barrierbench.config/1", "scene": {"name": "drape2d"}, "formulation": "log", "time": {"steps": 2}, "output": {"frames_every": 1}}


# --- control characters


ESCAPES = "a\x1b[31mb\x07c\x7fd\x9be\rf"


def test_control_characters_of_a_name_are_shown_as_text(program, tmp_path):
    done = bench("judge", f"{ESCAPES}.obj", cwd=tmp_path, program=program)
    assert done.returncode == 2 and r"a\x1b[31mb\x07c\x7fd\x9be\x0df.obj: no such file" in done.stderr
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f]", done.stderr + done.stdout)


def test_names_of_the_program_too(program, tmp_path):
    done = bench("check", f"{ESCAPES}.json", cwd=tmp_path, program=program)
    assert done.returncode == 2 and r"a\x1b[31mb\x07c\x7fd\x9be\x0df.json: found No such file" in done.stderr
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f]", done.stderr + done.stdout)


def test_a_stream_passes_everything_else(capsys):
    shown = streams.Shown(sys.stdout)
    shown.write("\u00e4\u4e2d\U0001f600\ta\r\n")
    shown.writelines(["b\0", "c\n"])
    streams.command("\033[H", shown)
    assert capsys.readouterr().out == "\u00e4\u4e2d\U0001f600\ta\\x0d\nb\\x00c\n\033[H"
    assert shown.isatty() is False
    assert not hasattr(shown, "buffer"), "bytes would pass as they are"


SAYS = """
import sys, warnings
from barrierbench_analysis.program import streams
def say(text):
    print(text, file=sys.stderr, flush=True)
    warnings.warn(text)
"""
PROCESSES = """
import multiprocessing, said
from barrierbench_analysis.program import processes
from barrierbench_analysis.program import streams
if __name__ == "__main__":
    streams.prepare()
    with processes.pool(1, multiprocessing.get_context({kind!r})) as pool:
        pool.submit(said.say, "a\x1bb").result()
"""


@pytest.mark.parametrize("kind", ["fork", "spawn", "forkserver"])
def test_processes_that_verbs_start_speak_as_they_do(tmp_path, kind):
    (tmp_path / "said.py").write_text(SAYS)
    (tmp_path / "pools.py").write_text(PROCESSES.format(kind=kind))
    done = subprocess.run([sys.executable, "pools.py"], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT / "analysis/src")}, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "a\\x1bb\nbench: warning: a\\x1bb\n")


def test_pools_are_made_in_one_place():
    made = [path.name for path in (ROOT / "analysis").rglob("*.py") if "ProcessPoolExecutor(" in path.read_text()]
    assert made == ["processes.py"]


def test_a_line_of_progress_is_erased_on_a_terminal(tmp_path):
    code = "from barrierbench_analysis.program import streams; streams.prepare()\nfrom barrierbench_analysis.program.progress import counted\nfor _ in counted('ab', 2, 'film\\x07'): pass"
    status, said = terminal.shown([sys.executable, "-c", code], output=False, cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT / "analysis/src")})
    assert status == 0, said
    lines = [rf"film\x07 {n} of 2" for n in range(3)]
    assert said == "".join(f"\r\033[K{line}" for line in (*lines, ""))


# --- warnings, readers, numbers


def test_a_letter_that_the_locale_has_not_is_written_as_its_number(tmp_path):
    plain = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": "ascii"}
    code = "import sys\nfrom barrierbench_analysis.front import door\nfrom barrierbench_analysis.program import streams\nstreams.prepare(); door.open_streams(); print('\\u4e2d')"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env={**plain, "PYTHONPATH": str(ROOT / "analysis/src")}, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("\\u4e2d\n", "")


def test_a_warning_of_a_library_is_a_line_without_its_source(program, tmp_path):
    """The title of a still has a letter that the font lacks."""
    (tmp_path / "\u4e2d.json").write_text(json.dumps(SCENE))
    done = bench("draw", "still", "\u4e2d.json", "--size", "64", "48", "--out", "a.png", cwd=tmp_path, program=program)
    assert done.returncode == 0 and re.fullmatch(r"(bench: warning: Glyph 20013 [^\n]* missing [^\n]*\n)+", done.stderr), done.stderr
    assert ".py" not in done.stderr and "site-packages" not in done.stderr


@pytest.mark.parametrize("words", ["list shapes", "help config", "formula --help"])
def test_a_reader_that_has_seen_enough_is_no_fault(program, words):
    """As `| head -1` does it: the reader is gone before everything is written."""
    line = f"'{sys.executable}' '{ROOT}/analysis' {words} | head -c 1 >/dev/null; exit 0"
    done = subprocess.run(["bash", "-c", line], env={**os.environ, "BARRIERBENCH_PROGRAM": program}, capture_output=True, text=True, check=False)
    assert done.stderr == ""


def test_an_output_that_cannot_be_written_is_said_once(program):
    with open("/dev/full", "w") as full:
        done = subprocess.run([program, "list", "shapes"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (75, "the standard output cannot be written\n")


def test_numbers_of_arguments_are_finite(tmp_path):
    assert finite_number("1e-3") == 1e-3
    for text in ("nan", "inf", "-inf", "", "1e999", "a"):
        with pytest.raises(argparse.ArgumentTypeError, match="allowed: a finite number"):
            finite_number(text)
    done = bench("draw", "still", ".", "--view", "nan", "nan", cwd=tmp_path)
    assert done.returncode == 2 and "argument --view: found 'nan'; allowed: a finite number" in done.stderr
    text = "".join(path.read_text() for path in (ROOT / "analysis").rglob("*.py"))
    assert text.count("finite_number") >= 9 and "type=float" not in text.replace("dtype=float", "")


@pytest.mark.parametrize("words, where", [
    ("gate run|", "1"), ("gate compare|", "1"), ("gate compare|a|", "2"), ("study match|", "1"), ("study score|", "1"), ("formula|", "1"), ("formula|--|", "2"),
    ("formula|--json|", "2"), ("draw still|--bare|", "2"), ("draw still|.|--view||1", "--view"), ("draw still|.|--view|1|", "4"), ("draw still|.|--out|", "--out"),
    ("draw still|.|--out=", "--out"), ("formula|--|--out|", "3")])
def test_an_empty_word_is_named_by_its_option_or_its_number(program, tmp_path, words, where):
    verb, *more = words.split("|")
    done = bench(*verb.split(), *more, cwd=tmp_path, program=program)
    assert (done.returncode, done.stderr) == (2, f"bench {verb}: argument {where}: found nothing; allowed: a value (./bench {verb} --help says what there is)\n")

"""What verbs in Python say: files that a full disk keeps from being written, by name and with the code that means "again"; control characters
of names as text; warnings of libraries without their source; nothing where a reader has seen enough."""

import argparse
import errno
import json
import os
import pty
import re
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from analysis import errors, whole_file
from analysis.front import streams
from analysis.front.arguments import finite_number

TRIANGLE = ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
            "$Elements\n1\n1 2 0 1 2 3\n$EndElements\n")
SCENE = {"schema": "barrierbench.config/1", "scene": {"name": "drape2d"}, "formulation": "log", "time": {"steps": 2}, "output": {"frames_every": 1}}
ROOT = Path(__file__).resolve().parents[2]


def bench(*words, program=sys.executable, **options):
    """A verb in a process of its own, which builds nothing. program: what it starts, if it comes to that."""
    return subprocess.run([sys.executable, str(ROOT / "analysis"), *map(str, words)], env={**os.environ, "BARRIERBENCH_PROGRAM": str(program)},
                          capture_output=True, text=True, check=False, timeout=120, **options)


def few_bytes() -> None:
    """As a full disk: every file of this process ends after 20 bytes."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (20, 20))


def no_bytes() -> None:
    """As a machine whose only disk is full: nor is there a folder for temporary files. Python ignores the signal that goes with it."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))


# --- a full disk


def test_the_codes_are_those_of_the_program():
    text = (ROOT / "core/record/atomic_write.cpp").read_text()
    lasting = re.findall(r"case (E[A-Z]+):", text[text.index("bool lasts(") :].split("default")[0])
    assert len(lasting) >= 10 and {getattr(errno, name) for name in lasting} == errors.LASTING
    for number, code in ((errno.ENOSPC, 75), (errno.EFBIG, 75), (errno.EDQUOT, 75), (errno.EMFILE, 75), (errno.EIO, 75), (errno.ENOENT, 2), (errno.EACCES, 2)):
        assert errors.code_of(OSError(number, "text")) == code
    assert errors.code_of(errors.UserError("a", 70)) == 70 and errors.code_of(OSError("of a library")) == 2


@pytest.mark.parametrize("limit", [few_bytes, no_bytes])
def test_a_full_disk_names_the_file_and_may_be_tried_again(program, tmp_path, limit):
    (tmp_path / "in.msh").write_text(TRIANGLE)
    done = bench("mesh", "in.msh", "out.ply", cwd=tmp_path, program=program, preexec_fn=limit)
    assert (done.returncode, done.stderr) == (75, "bench mesh: out.ply: File too large\n")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["in.msh"]


def test_a_full_disk_without_a_folder_for_temporary_files_is_said_as_such(program, tmp_path):
    (tmp_path / "a.json").write_text("{}")
    done = bench("render", "a.json", cwd=tmp_path, program=program, preexec_fn=no_bytes)
    said = done.stderr.splitlines()[-1]  # matplotlib, too, says that it cannot write
    assert done.returncode == 75 and re.fullmatch(r"bench render: a temporary file \([^)]*\): File too large", said), done.stderr
    unnamed = "from analysis import errors; print(errors.text_of(OSError(28, 'No space left on device')))"
    done = subprocess.run([sys.executable, "-c", unnamed], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False,
                          preexec_fn=no_bytes)
    assert done.returncode == 0 and re.fullmatch(r"a temporary file \([^)]*\) or a stream: No space left on device\n", done.stdout), done.stderr


def test_a_folder_for_temporary_files_that_is_not_there_is_no_full_disk(tmp_path, monkeypatch):
    error = FileNotFoundError(errno.ENOENT, "No usable temporary directory found in [...]")

    def none_found():
        raise error

    monkeypatch.setenv("TMPDIR", str(tmp_path / "none"))
    monkeypatch.setattr("tempfile.gettempdir", none_found)
    assert errors.code_of(error) == 2 and errors.text_of(error) == f"a temporary file ({tmp_path}/none): No such file or directory"
    assert errors.text_of(FileNotFoundError(errno.ENOENT, "not there", "a.txt")) == "a.txt: not there"


def test_every_writer_names_its_file(tmp_path):
    """Where nobody catches it, the name stands in the error: of texts, bytes, figures, and of what others write."""
    code = """
import sys
from pathlib import Path
from analysis import whole_file
from matplotlib.figure import Figure
def write_rows(path):
    with whole_file.named(path):
        with open(path, "w") as out:
            out.write("x" * 100)
for k, write in enumerate((lambda p: whole_file.write_whole(p, "x" * 100), lambda p: whole_file.write_whole_bytes(p, b"x" * 100),
                           lambda p: whole_file.write_figure(Figure(), p), write_rows)):
    path = Path(f"file_{k}.png")
    try:
        write(path)
    except OSError as error:
        print(error.filename, error.strerror)
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False,
                          preexec_fn=few_bytes)
    assert done.stdout.splitlines() == [f"file_{k}.png File too large" for k in range(4)], done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["file_3.png"]  # not whole_file's


def test_nothing_else_writes_what_a_user_asked_for():
    """Others write scratch files, or what another program reads at once."""
    writes = re.compile(r"\.write_text\(|\.write_bytes\(|\.savefig\(|\.to_csv\([^)]|open\([^)]*\"wb?\"")
    found = {}
    for path in (ROOT / "analysis").rglob("*.py"):
        lines = [line for line in path.read_text().splitlines() if writes.search(line) and "index=False" not in line]
        if lines:
            found[path.relative_to(ROOT / "analysis").as_posix()] = len(lines)
    assert found == {"whole_file.py": 3, "still_picture.py": 1, "judge/page.py": 1, "score/page.py": 1,  # pictures in memory
                     "judge/ask.py": 1, "matching/runs.py": 1, "condition_table.py": 1, "matrix_corpus.py": 1, "readme/snippets.py": 1, "toolkit_meshes.py": 1,
                     "figures/rebuild.py": 1, "formula/cache.py": 2, "formula/device.py": 2,  # which name their folder
                     "front/building.py": 2, "front/python_module.py": 1, "front/test.py": 1, "front/tidy.py": 1, "engines/environment.py": 1, "engines/launch.py": 2,
                     "frames_out/formats.py": 1}  # under whole_file.named


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
from analysis.front import streams
def say(text):
    print(text, file=sys.stderr, flush=True)
    warnings.warn(text)
"""
PROCESSES = """
import multiprocessing, said
from analysis import processes
from analysis.front import streams
if __name__ == "__main__":
    streams.prepare()
    with processes.pool(1, multiprocessing.get_context({kind!r})) as pool:
        pool.submit(said.say, "a\x1bb").result()
"""


@pytest.mark.parametrize("kind", ["fork", "spawn", "forkserver"])
def test_processes_that_verbs_start_speak_as_they_do(tmp_path, kind):
    (tmp_path / "said.py").write_text(SAYS)
    (tmp_path / "pools.py").write_text(PROCESSES.format(kind=kind))
    done = subprocess.run([sys.executable, "pools.py"], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "a\\x1bb\nbench: warning: a\\x1bb\n")


def test_pools_are_made_in_one_place():
    made = [path.name for path in (ROOT / "analysis").rglob("*.py") if "ProcessPoolExecutor(" in path.read_text()]
    assert made == ["processes.py"]


def test_a_line_of_progress_is_erased_on_a_terminal(tmp_path):
    code = "from analysis.front import streams; streams.prepare()\nfrom analysis.progress import counted\nfor _ in counted('ab', 2, 'film\\x07'): pass"
    ours, theirs = pty.openpty()
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, stderr=theirs, check=True)
    os.close(theirs)
    said = os.read(ours, 10000).decode()
    os.close(ours)
    lines = [rf"film\x07 {n} of 2" for n in range(3)]
    assert said == "".join(f"\r\033[K{line}" for line in (*lines, ""))


# --- warnings, readers, numbers


def test_a_letter_that_the_locale_has_not_is_written_as_its_number(tmp_path):
    plain = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": "ascii"}
    code = "import sys\nfrom analysis.front import door, streams\nstreams.prepare(); door.open_streams(); print('\\u4e2d')"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env={**plain, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("\\u4e2d\n", "")


def test_a_warning_of_a_library_is_a_line_without_its_source(program, tmp_path):
    """The title of a still has a letter that the font lacks."""
    (tmp_path / "\u4e2d.json").write_text(json.dumps(SCENE))
    done = bench("render", "\u4e2d.json", "--size", "64", "48", "--out", "a.png", cwd=tmp_path, program=program)
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
    done = bench("render", ".", "--view", "nan", "nan", cwd=tmp_path)
    assert done.returncode == 2 and "argument --view: found 'nan'; allowed: a finite number" in done.stderr
    text = "".join(path.read_text() for path in (ROOT / "analysis").rglob("*.py"))
    assert text.count("type=finite_number") >= 9 and "type=float" not in text.replace("dtype=float", "")


@pytest.mark.parametrize("words, where", [
    ("gate|", "1"), ("compare|", "1"), ("compare|a|", "2"), ("match|", "1"), ("score|", "1"), ("formula|", "1"), ("formula|--|", "2"),
    ("formula|--json|", "2"), ("render|--bare|", "2"), ("render|.|--view||1", "--view"), ("render|.|--view|1|", "4"), ("render|.|--out|", "--out"),
    ("render|.|--out=", "--out"), ("formula|--|--out|", "3")])
def test_an_empty_word_is_named_by_its_option_or_its_number(program, tmp_path, words, where):
    verb = words.split("|")[0]
    done = bench(*words.split("|"), cwd=tmp_path, program=program)
    assert (done.returncode, done.stderr) == (2, f"bench {verb}: argument {where}: found nothing; allowed: a value (./bench {verb} --help says what there is)\n")


def test_whole_file_is_what_it_was(tmp_path):
    whole_file.write_whole(tmp_path / "a.txt", "before")
    with pytest.raises(UnicodeEncodeError):
        whole_file.write_whole(tmp_path / "a.txt", "\ud800")
    assert (tmp_path / "a.txt").read_text() == "before"

"""A full disk, as a limit on the size of files: each verb that writes names the file, ends with the code that means "again", and leaves what was there."""

import errno
import json
import re
import shutil

import pytest

from barrierbench_analysis.io import errors, whole_file
from barrierbench_analysis.program import verbs
from barrierbench_analysis.io.places import ROOT
from tests.bench_call import bench, python

TRIANGLE = ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
            "$Elements\n1\n1 2 0 1 2 3\n$EndElements\n")
TETRAHEDRON = ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
               "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n")
POLYFEM = {"geometry": [{"mesh": "tetrahedron.msh"}], "materials": {"type": "NeoHookean", "E": 1e5, "nu": 0.3, "rho": 1000}, "contact": {"enabled": True, "dhat": 0.001},
           "time": {"tend": 0.02, "dt": 0.01}, "boundary_conditions": {"rhs": [0, 9.81, 0]}}
CONFIG = {"schema": "barrierbench.config/1", "scene": {"name": "drape2d"}, "formulation": "log", "time": {"steps": 2}, "output": {"frames_every": 1}}
STUDY = {"schema": "barrierbench.study/1", "name": "own", "rule": "drift", "question": "?", "base": "config.json", "axes": [{"names": ["formulation"], "cases": [{"label": "log", "set": {}}]}],
         "seeds": [1], "metrics": {"newton": "newton"}, "about": {"names": {"log": "log"}}, "page": "results/OWN.md"}  # of somebody's own, of the kit
SMALL = "--size 64 48"
FRAME = 8000  # bytes that the start of this scene has, which is a scratch file
WRITE = [  # words after `bench`, the file, and bytes that a file may have: what others of its files need
    ("data mesh in.msh out.ply", "out.ply", 0),
    ("data collect . out.csv", "out.csv", 0),
    ("draw figures . out", "out/condition_drape2d.png", 100),
    ("report . --out out.html", "a temporary file", 0),
    (f"draw still run --out out.png {SMALL}", "out.png", 0),
    (f"draw still run --out out.png --bare {SMALL}", "out.png", 0),
    (f"draw still config.json --out out.png {SMALL}", "out.png", FRAME),
    ("draw still config.json --out out.png --bare --size 900 900", "out.png", FRAME),
    (f"draw still run --out out.gif {SMALL}", "out.gif", 100),
    ("draw sheet run run --out out.png", "a temporary file", 0),
    ("draw player run --out out.html", "out.html", 0),
    ("scenes drape --write out.json", "out.json", 0),
    *((f"data frames run out --format {kind}", f"out/{file}", 100)
      for kind, file in (("obj", "frame_000000.obj"), ("ply", "frame_000000.ply"), ("pc2", "frame.pc2"), ("vtu", "frame_000000.vtu"))),
    ("data film run out", "out/frame_000000.ply", 100),
    ("data archive run out.zip", "out.zip", 0),
    ("judge run --out out", "out", 0),
    ("judge run --out out", "a temporary file", 100),
    ("gate compare run run --json out.json", "a temporary file", 0),  # of scipy, when it is loaded
    ("gate compare run run --json out.json", "out.json", 100),
    ("study match config.json --formulations cubic --out out", "a temporary file", 0),
    ("study match config.json --formulations cubic --out out", "the program ended with 75: out", 1000),
    ("formula (d_hat-d)^3/d", "cache/formulas", 0),
    ("study score (d_hat-d)^3/d --out out", "cache/formulas", 0),
    *((f"{words} out", file, 1000) for words, file in (  # and what they begin with, which names the first of hours of runs
        ("study causes config.json --out", "out/probe"), ("gate run --case drape --out", "out/"), ("gate calibrate --copies 1 --out", "out/"),
        ("study matrix-corpus --out", "probe"), ("study step-corpus --results", "out/"),
        ("draw figure work_precision --quick --out out --runs", "a temporary file"), ("study claims K3 --runs", "out/"),
        ("draw pictures --runs", "out/"), ("study gpu-report --results", "out/GPU.md"),
        ("study condition-table --out", "a temporary file"))),
    ("study own.json", "a temporary file", 0),
    ("import-scene polyfem.json --out out.json", "out_meshes/tetrahedron.ply", 200),
]
PLANNED = {"study match", "study causes", "gate run", "gate calibrate", "draw figure", "study claims", "draw pictures", "study matrix-corpus", "study step-corpus"}
READ = {"status", "data surface-gaps", "gate trend", "setup", "verify", "completion"}  # which write nothing, or for the script ./bench
DEVELOP = {verb.name for verb in verbs.TABLE if verb.group == "develop" or verb.needs not in (verbs.ENVIRONMENT, verbs.PROGRAM)}
IN_THE_TREE = {"demo", "engine", "gate accept", "dev readme"}  # what they write is at a fixed place


def verb_of(words: str) -> str:
    return verbs.call_of(words.split()).row.name


def test_every_verb_is_run_or_named():
    run = {verb_of(words) for words, *_ in WRITE} - {"study own"}
    assert len(run) >= 20 and run | READ | DEVELOP | IN_THE_TREE == {verb.name for verb in verbs.TABLE} and not run & (READ | DEVELOP | IN_THE_TREE)


@pytest.fixture(scope="module")
def inputs(program, tmp_path_factory):
    """A run with frames, its config, a mesh and a matrix."""
    folder = tmp_path_factory.mktemp("inputs")
    (folder / "config.json").write_text(json.dumps(CONFIG))
    (folder / "own.json").write_text(json.dumps(STUDY))
    (folder / "in.msh").write_text(TRIANGLE)
    (folder / "tetrahedron.msh").write_text(TETRAHEDRON)
    (folder / "polyfem.json").write_text(json.dumps(POLYFEM))
    (folder / "in.mtx").write_text("%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1\n2 2 2\n")
    done = bench("run", "config.json", "--out", "run", cwd=folder, program=program)
    assert done.returncode == 0, done.stderr
    return folder


def contents(folder) -> dict:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("words, file, size", WRITE)
def test_a_verb_names_the_file_and_leaves_what_was_there(program, inputs, tmp_path, words, file, size):
    here = tmp_path / "here"
    shutil.copytree(inputs, here)
    verb = verb_of(words)
    if file.startswith("out.") and verb != "scenes":  # which replaces nothing
        (here / file).write_text("before")
    before = contents(here)
    done = bench(*words.split(), cwd=here, program=program, environment={"BARRIERBENCH_CACHE": "cache"}, at_most=size)
    said = done.stderr.splitlines()[-1]
    assert done.returncode == 75 and said.startswith(f"bench {verb}: ") and "File too large" in done.stderr, done.stderr
    assert file in done.stderr and (".tmp." not in said or verb in PLANNED), done.stderr
    after = contents(here)
    assert {name: after.get(name) for name in before} == before
    made = [name for name in after if name not in before]
    assert not made or (verb in PLANNED and not [name for name in made if ".tmp." in name]), made  # what was planned


def test_nothing_is_at_issue_without_the_limit(program, inputs, tmp_path):
    """The same words write the same files where the disk has space."""
    here = tmp_path / "here"
    shutil.copytree(inputs, here)
    for words, file, _ in WRITE[:6]:
        done = bench(*words.split(), cwd=here, program=program)
        assert done.returncode == 0 and (file == "a temporary file" or (here / file).is_file()), done.stderr


WRITERS = """
from pathlib import Path
from matplotlib.figure import Figure
from barrierbench_analysis.figures import figure_files
from barrierbench_analysis.io import whole_file
from barrierbench_analysis.studies.matrices import matrix_corpus
from barrierbench_analysis.studies.engines import ours
from barrierbench_analysis.studies.gate import trend
from barrierbench_analysis.pages.readme import figures

ours.read_scene = lambda *_: {"obstacles": []}
ours.frames_of = lambda *_: []
source = Path("source")
system = {"name": "file_6", "cause": "a", "why": "b"}

def lines(path):
    with whole_file.whole(path) as part, part.open("w") as out:
        out.write("x" * 100)

writers = [
    lambda: whole_file.write_whole(Path("file_0"), "x" * 100),
    lambda: whole_file.write_whole_bytes(Path("file_1"), b"x" * 100),
    lambda: whole_file.write_figure(Figure(), Path("file_2.png")),
    lambda: lines(Path("file_3")),
    lambda: figure_files.copy_to_page([source / "file_4.png"], Path(".")),
    lambda: figures.copy(["![a](docs/file_5.png)"], source, Path(".")),
    lambda: matrix_corpus.keep(system, source / "file_6.json", Path(".")),
    lambda: ours._write_frames({}, Path("."), {"steps": 1, "dt_s": 1.0, "triangles": [], "positions_m": []}, Path("file_7"), 1),
    lambda: trend.append(Path("file_8"), {"a": "x" * 100}),
]
for write in writers:
    try:
        write()
        print("written")
    except OSError as error:
        print(error.filename, error.strerror)
"""


def test_every_writer_names_its_file_and_leaves_none(tmp_path):
    """Also those of the verbs that are not run here."""
    (tmp_path / "source").mkdir()
    for name in ("file_4.png", "file_5.png", "file_5.txt", "file_6.mtx"):
        (tmp_path / "source" / name).write_text("x" * 100)
    (tmp_path / "file_8").write_text("before\n")
    done = python(WRITERS, tmp_path, at_most=20)
    names = ["file_0", "file_1", "file_2.png", "file_3", "file_4.png", "file_5.png", "file_6.mtx", "file_7/frames.npz", "file_8"]
    assert done.stdout.splitlines() == [f"{name} File too large" for name in names], done.stderr
    assert (tmp_path / "file_8").read_text() == "before\n"
    assert sorted(path.name for path in tmp_path.rglob("*") if path.is_file() and path.parent.name != "source") == ["file_8"]


@pytest.mark.parametrize("code, passed", [(75, 75), (2, 2), (1, 2), (-9, 2)])
def test_what_a_program_calls_again_is_so_for_the_verb(code, passed):
    assert errors.passed_on(code) == passed


# --- codes and words


def test_the_codes_are_those_of_the_program():
    text = (ROOT / "core/base/record/atomic_write.cpp").read_text()
    lasting = re.findall(r"case (E[A-Z]+):", text[text.index("bool lasts(") :].split("default")[0])
    assert len(lasting) >= 10 and {getattr(errno, name) for name in lasting} == errors.LASTING
    for number, code in ((errno.ENOSPC, 75), (errno.EFBIG, 75), (errno.EDQUOT, 75), (errno.EMFILE, 75), (errno.EIO, 75), (errno.ENOENT, 2), (errno.EACCES, 2)):
        assert errors.code_of(OSError(number, "text")) == code
    assert errors.code_of(errors.UserError("a", 70)) == 70 and errors.code_of(OSError("of a library")) == 2


def test_a_full_disk_without_a_folder_for_temporary_files_is_said_as_such(program, tmp_path):
    (tmp_path / "a.json").write_text("{}")
    done = bench("draw", "still", "a.json", cwd=tmp_path, program=program, at_most=0)
    said = done.stderr.splitlines()[-1]  # matplotlib, too, says that it cannot write
    assert done.returncode == 75 and re.fullmatch(r"bench draw still: a temporary file \([^)]*\): File too large", said), done.stderr
    unnamed = "from barrierbench_analysis.io import errors; print(errors.text_of(OSError(28, 'No space left on device')))"
    done = python(unnamed, tmp_path, at_most=0)
    assert done.returncode == 0 and re.fullmatch(r"a temporary file \([^)]*\) or a stream: No space left on device\n", done.stdout), done.stderr


def test_a_folder_for_temporary_files_that_is_not_there_is_no_full_disk(tmp_path, monkeypatch):
    error = FileNotFoundError(errno.ENOENT, "No usable temporary directory found in [...]")

    def none_found():
        raise error

    monkeypatch.setenv("TMPDIR", str(tmp_path / "none"))
    monkeypatch.setattr("tempfile.gettempdir", none_found)
    assert errors.code_of(error) == 2 and errors.text_of(error) == f"a temporary file ({tmp_path}/none): No such file or directory"
    assert errors.text_of(FileNotFoundError(errno.ENOENT, "not there", "a.txt")) == "a.txt: not there"


def test_whole_file_is_what_it_was(tmp_path):
    whole_file.write_whole(tmp_path / "a.txt", "before")
    with pytest.raises(UnicodeEncodeError):
        whole_file.write_whole(tmp_path / "a.txt", "\ud800")
    assert (tmp_path / "a.txt").read_text() == "before"

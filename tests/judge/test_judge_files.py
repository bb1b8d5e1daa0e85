"""`bench judge` on what programs write: every habit has the verdict of what the file shows, and what is left out is reported."""

import struct

import numpy as np
import pytest

from tests.judge import habits
from tests.judge.habits import CROSSED, FACES, obj_lines, piece, text, vtu
from tests.judge.test_judge_verb import judge


@pytest.mark.parametrize("name", habits.CROSSES)
def test_what_crosses_in_the_file_is_seen(program, tmp_path, name):
    folder = tmp_path / "in"
    folder.mkdir()
    code, record = judge(tmp_path, habits.CROSSES[name](folder))
    assert (code, record["verdict"]) == (1, "penetrates")
    assert record["total"]["crossings"] >= 1 and record["total"]["judged"] > 0


@pytest.mark.parametrize("name", habits.CLEAN)
def test_what_does_not_cross_is_clean(program, tmp_path, name):
    folder = tmp_path / "in"
    folder.mkdir()
    code, record = judge(tmp_path, habits.CLEAN[name](folder))
    assert (code, record["verdict"]) == (0, "clean")
    assert record["total"]["judged"] > 0 and record["total"]["triangles"] > 1


def notes_of(tmp_path, path, *words):
    code, record = judge(tmp_path, path, *words)
    return code, record, " | ".join(record["notes"])


def test_what_is_left_out_is_counted_and_said(program, tmp_path):
    lines = obj_lines(CROSSED) + "f 1 2 3\nf 4 5 6\np 1\nq 1 2 3\nq 4 5 6\n"
    _, _, message = notes_of(tmp_path, text(tmp_path, "f.obj", lines))
    assert 'a line that begins with "q": 2 not understood and left out, the first at' in message and "f.obj:10" in message
    assert "points (p): 1 left out" in message
    cells = [*FACES, [0], []]
    _, _, message = notes_of(tmp_path, text(tmp_path, "g.vtu", vtu(piece(CROSSED, [np.array(c, int) for c in cells], [5, 5, 1, 0]))))
    assert 'cell "vertex": 1 left out, the first at' in message and 'cell "empty cell": 1 left out' in message


def test_the_field_of_the_motion_is_said_and_can_be_asked_for(program, tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    path = habits.polyfem(folder)
    code, record, message = notes_of(tmp_path, path)
    assert "the field 'solution' is added to the points, which rest" in message and "Contact, Volume" in message
    assert (record["trajectory"]["displacement"], record["trajectory"]["moves"]) == ("solution", True)
    code, record, _ = notes_of(tmp_path, path, "--displacement", "none")
    assert code == 0 and record["trajectory"]["moves"] is False and record["trajectory"]["displacement"] is None


def test_a_film_in_which_nothing_moves_says_so_first(program, tmp_path, capsys):
    for k in range(3):
        text(tmp_path, f"f_{k}.obj", obj_lines(habits.APART) + "f 1 2 3\nf 4 5 6\n")
    code, record = judge(tmp_path, tmp_path)
    assert code == 0 and record["trajectory"]["moves"] is False
    assert capsys.readouterr().out.splitlines()[0].startswith("clean (no vertex moves in 3 frames): ")


def cube(x, split):
    """Six squares, each with corners of its own or shared ones."""
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], float) + x
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    if not split:
        return obj_lines(corners), sides
    return obj_lines(corners[np.ravel(sides)]), np.arange(24).reshape(6, 4).tolist()


def test_seams_are_said_and_welded(program, tmp_path):
    """A leaf jumps into a cube whose squares have corners of their own."""
    for k, z in enumerate((1.5, 0.5)):
        points, sides = cube([0, 0, 0], True)
        leaf = np.array([[0.4, 0.4, z], [0.6, 0.4, z], [0.5, 0.6, z]])
        faces = "".join("f " + " ".join(str(v + 1) for v in s) + "\n" for s in [*sides, [24, 25, 26]])
        text(tmp_path, f"f_{k}.obj", points + obj_lines(leaf) + faces)
    code, record, message = notes_of(tmp_path, tmp_path)
    assert "1 bodies are closed but for 16 vertices" in message and "--weld 0 joins" in message
    assert record["verdict"] == "passes_between_frames" and record["total"]["closed_bodies"] == []
    code, record, message = notes_of(tmp_path, tmp_path, "--weld", "0")
    assert (code, record["verdict"]) == (1, "penetrates") and record["total"]["closed_bodies"] == ["part 0"]
    assert "16 vertices were joined to others" in message and "closed but for" not in message


def pc2(folder, start, rate):
    frames = np.array([habits.APART, CROSSED], "<f4")
    text(folder, "f.pc2", struct.pack("<12siiffi", b"POINTCACHE2\0", 1, 6, start, rate, 2) + frames.tobytes())
    text(folder, "f.obj", obj_lines(CROSSED) + "f 1 2 3\nf 4 5 6\n")
    return folder


def test_times_of_caches_are_kept(program, tmp_path):
    code, record = judge(tmp_path, pc2(tmp_path, 10, 0.5))
    assert code == 1 and record["trajectory"]["frame_numbers"] == [10, 10.5]
    assert record["trajectory"]["last"] == "sample 1 (frame 10.5)"
    folder = tmp_path / "mdd"
    folder.mkdir()
    _, record = judge(tmp_path, habits.mdd(folder))
    assert record["trajectory"]["times_s"] == pytest.approx([0, 0.04])


def quadratic(folder):
    x = np.vstack([CROSSED, CROSSED])
    return text(folder, "f.vtu", vtu(piece(x, [[0, 1, 2, 3, 4, 5], [6, 7, 8, 9, 10, 11]], [22, 22])))


def npz(folder, **arrays):
    np.savez(folder / "f.npz", positions=np.array([CROSSED]), **arrays)
    return folder / "f.npz"


REFUSED = {
    "cell 0: found a quadratic triangle (type 22)": quadratic,
    "cell 0: found a cell of type 200": lambda f: text(f, "f.vtu", vtu(piece(CROSSED, [[0, 1, 2, 3, 4, 5]], [200]))),
    "cell 1: found vertex 6; allowed: a vertex from 0 to 5": lambda f: text(f, "f.vtu", vtu(piece(CROSSED, [[0, 1, 2], [3, 4, 6]], [5, 5]))),
    'f.obj:4: found "-5" after 3 vertices': lambda f: text(f, "f.obj", obj_lines(CROSSED[:3]) + "f -5 1 2\n"),
    "f.obj:7: found vertex 2147483648; allowed: a vertex from 1 to 6": lambda f: text(f, "f.obj", obj_lines(CROSSED) + "f 1 2 2147483648\n"),
    "f.obj:7: found a curve or surface of free form (surf)": lambda f: text(f, "f.obj", obj_lines(CROSSED) + "surf 0 1 0 1 1 2 3 4\nf 1 2 3\n"),
    "found 0.0 frames from sample to sample": lambda f: pc2(f, 0, 0),
    "found -1.0 frames from sample to sample": lambda f: pc2(f, 0, -1),
    "found nan frames from sample to sample": lambda f: pc2(f, 0, np.nan),
    "the first sample is at frame inf": lambda f: pc2(f, np.inf, 1),
    "the array `segment` is not known; did you mean `segments`?": lambda f: npz(f, segment=np.array([[0, 1]]), triangles=np.array(FACES)),
    "`faces` and `triangles`": lambda f: npz(f, faces=np.array(FACES), triangles=np.array(FACES)),
    "the compressor vtkLZ4DataCompressor": lambda f: text(f, "f.vtu", vtu(piece(CROSSED, FACES, [5, 5]), 'compressor="vtkLZ4DataCompressor"')),
    "ParaView writes it as VTU frames": lambda f: text(f, "f.xdmf", "<Xdmf/>"),
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_cannot_be_read_is_refused_with_its_place(program, tmp_path, capsys, words):
    folder = tmp_path / "in"
    folder.mkdir()
    code, record = judge(tmp_path, REFUSED[words](folder))
    message = capsys.readouterr().err
    assert (code, record) == (2, None)
    if words == "`faces` and `triangles`":
        words = "are both names of `triangles`"
    assert words in message


def test_a_field_that_is_not_there_is_refused_with_those_that_are(program, tmp_path, capsys):
    folder = tmp_path / "in"
    folder.mkdir()
    code, _ = judge(tmp_path, habits.fenics(folder), "--displacement", "velocity")
    assert code == 2 and "has displacement" in capsys.readouterr().err

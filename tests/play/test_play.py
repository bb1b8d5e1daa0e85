"""What a film and its page hold, what ./bench draw player says, and what it refuses."""

import base64
import json
import re
import zlib

import numpy as np
import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.frames import Frame, read_frame
from barrierbench_analysis.pages.play import page as pages
from barrierbench_analysis.pages.play import scales, verb
from barrierbench_analysis.figures.pictures.film import filmed, kept, opened, shaded_mesh
from play_runs import put, run_of

LAST = "frames/step_000004.ply"


def refused(capsys, *words) -> str:
    assert verb.main([str(word) for word in words]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith("bench draw player: ")
    return said.err


def words_of(text: str) -> dict:
    return json.loads(re.search(r'id="words">(.*?)</script>', text, re.DOTALL)[1])


def arrays_of(text: str, number: int) -> np.ndarray:
    return np.frombuffer(zlib.decompress(base64.b64decode(re.search(rf'id="film-{number}">([^<]*)<', text)[1])), "<u4")


# --- films


def test_a_film_has_the_frames_of_the_run_in_order(log_run):
    film = filmed(opened(log_run / "run.json"))
    assert film.steps == [-1, 0, 1, 2, 3, 4] and film.left_out == 0 and film.outcome == "ok"
    assert film.times_s == pytest.approx([0, 0.01, 0.02, 0.03, 0.04, 0.05])
    last = read_frame(log_run / LAST)
    np.testing.assert_array_equal(film.positions[-1], last.vertices.astype("f4"))
    np.testing.assert_array_equal(film.stretch[-1], last.of_triangles["stretch"].astype("f4"))
    assert np.isnan(film.gap_rel[0]).all() and np.isnan(film.load_N[0]).all()  # nothing is solved at the start
    assert film.gap_rel[-1].min() < 1 and film.load_N[-1].max() > 0


def test_every_so_many_frames_and_always_the_last():
    assert kept([-1, 0, 1, 2, 3, 4], 1) == [-1, 0, 1, 2, 3, 4]
    assert kept([-1, 0, 1, 2, 3, 4], 2) == [-1, 1, 3, 4]
    assert kept([-1, 0, 1, 2, 3, 4], 99) == [-1, 4]
    assert kept([-1], 3) == [-1]


def test_a_sharp_edge_has_normals_of_its_own_and_a_smooth_one_shares_them():
    def mesh(height):  # two triangles that meet in an edge
        x = np.array([[0.0, 0, 0], [0, 1, 0], [-1, 0.5, height], [1, 0.5, height]])
        return Frame(x, np.array([[0, 1, 2], [0, 3, 1]]), np.zeros((0, 2), int))

    source, drawn = shaded_mesh(mesh(0.1))
    assert list(source) == [0, 1, 2, 3] and drawn.max() == 3
    source, drawn = shaded_mesh(mesh(2.0))
    assert len(source) == 8 and len(set(drawn[0]) & set(drawn[1])) == 0
    np.testing.assert_array_equal(source[drawn], mesh(2.0).triangles)


def test_a_film_has_the_forces_of_its_frames_and_without_them_the_loads(forces_run, log_run):
    film, plain = filmed(opened(forces_run)), filmed(opened(log_run))
    last = read_frame(forces_run / LAST)
    contact = np.stack([last.of_vertices[f"contact_{axis}_N"] for axis in "xyz"], axis=1)
    np.testing.assert_array_equal(film.contact_N[-1], contact.astype("f4"))
    assert np.isnan(film.contact_N[0]).all() and np.abs(contact).max() > 0
    np.testing.assert_allclose(film.force_N[-1], np.linalg.norm(contact, axis=1), rtol=1e-6)
    rubs = np.stack([last.of_vertices[f"friction_{axis}_N"] for axis in "xyz"], axis=1)
    np.testing.assert_allclose(film.arrows_N[-1], contact + rubs, rtol=1e-5, atol=1e-7)
    assert np.abs(rubs).max() > 0
    assert plain.contact_N is None and plain.arrows_N is None and plain.force_N is plain.load_N


# --- scales


def test_a_scale_is_one_for_both_runs_and_says_when_values_lie_above(log_run, cubic_run):
    films = [filmed(opened(run)) for run in (log_run, cubic_run)]
    assert scales.scale(films, "gap")["top"] == 1
    for name in ("stretch", "force"):
        both = scales.scale(films, name)
        values = np.concatenate([getattr(film, scales.FIELDS[name].array).ravel() for film in films])
        values = scales.FIELDS[name].factor * values[values > 0]
        assert 0.9 * np.median(values) < both["top"] < 1.06 * values.max()
        assert both["above"] == (values.max() > both["top"])
    films[0].load_N[:] = 0
    films[1].load_N[:] = 0
    assert scales.scale(films, "force")["top"] == 1  # no force at all


# --- pages


def test_a_page_holds_all_it_shows_and_no_address(library, log_run, cubic_run, tmp_path, capsys):
    out = tmp_path / "both.html"
    assert verb.main([str(log_run), str(cubic_run), "--out", str(out), "--color", "stretch"]) == 0
    said = capsys.readouterr().out
    assert f"{out} ({out.stat().st_size / 1e6:.1f} MB): 6 frames of" in said and "log (ok)" in said and "cubic (ok)" in said
    text = out.read_text()
    words = words_of(text)
    assert words["colour"] == "stretch" and words["notes"] == []
    assert [film["formulation"] for film in words["films"]] == ["log", "cubic"]
    film = words["films"][0]
    assert film["bodies"] == ["cloth", "rod"] and film["n_edges"] == 3 and film["obstacles"][0]["radius_m"] == 0.1
    counts = 2 * 3 * 50 + film["n_drawn"] + 2 * 3 + 40 + 6 * (5 * 40 + 50)
    assert len(arrays_of(text, 0)) == len(arrays_of(text, 1)) == counts
    first = arrays_of(text, 0)[2 * 3 * 50 + film["n_drawn"] + 6 + 40 :][: 3 * 40].view("<f4").reshape(-1, 3)
    np.testing.assert_array_equal(first, read_frame(log_run / "frames/start.ply").vertices.astype("f4"))
    assert text.count("default-src 'none'") == 1 and not re.search(r"(?:src|href)=\"(?!data:)", text)
    source = zlib.decompress(base64.b64decode(re.search(r'id="library">([^<]*)<', text)[1])).decode()
    found = [word in source for word in ("CreateK3DAndLoadBinarySnapshot", "unpkg.com", "cdnjs", ",url(fonts/")]
    assert found == [True, False, False, False]
    licences = text[text.index("<pre>") : text.index("</pre>")]
    assert "Three.js Authors" in licences and "Permission is hereby granted" in licences
    assert verb.play([log_run], tmp_path / "again.html", "gap") and verb.play([log_run], tmp_path / "twice.html", "gap")
    same = (tmp_path / "again.html").read_bytes() == (tmp_path / "twice.html").read_bytes()
    assert same


def test_a_page_has_the_forces_of_the_runs_that_have_them(library, forces_run, log_run, tmp_path):
    verb.play([forces_run, log_run], tmp_path / "both.html", "force")
    text = (tmp_path / "both.html").read_text()
    words, film = words_of(text), filmed(opened(forces_run))
    assert [of["forces"] for of in words["films"]] == [True, False]
    sizes = np.linalg.norm(film.arrows_N[1:], axis=-1)
    assert 0 < words["longest_arrow_N"] <= 1.05 * sizes.max() and 0 < words["longest_arrow_m"] < words["radius"]
    arrays, of_frames = arrays_of(text, 0), 6 * 3 * 40
    forces = arrays[len(arrays) - of_frames :].view("<f4").reshape(6, 40, 3)
    np.testing.assert_array_equal(forces, np.nan_to_num(film.arrows_N))
    assert len(arrays) == len(arrays_of(text, 1)) + of_frames
    assert opened(forces_run).frame_bytes == opened(log_run).frame_bytes + 4 * 3 * 40


def test_names_from_a_config_are_no_markup(library, log_run, tmp_path):
    film = filmed(opened(log_run))
    film.scene["bodies"][0] = "</script><b>"
    text = pages.page([film], "gap", ["a < b"])
    assert text.count("</script><b>") == 0 and words_of(text)["films"][0]["bodies"][0] == "</script><b>"


def test_files_stand_beside_the_first_run_unless_told(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    assert verb.default_out([one / "run.json"]) == one / "play.html"
    assert verb.default_out([one, two]) == one / "play_beside_two.html"


def test_a_large_film_is_thinned_and_that_is_said(library, log_run, tmp_path):
    source = opened(log_run)
    assert 4 * (5 * 40 + 50) == source.frame_bytes
    limit = pages.page_bytes(3 * source.frame_bytes) / 1e6
    notes = verb.play([log_run], tmp_path / "small.html", "gap", limit_mb=limit)
    assert "Of every 3 frames one is kept: all 6 take up to" in notes[0] and "--every 1 keeps them" in notes[0]
    words = words_of((tmp_path / "small.html").read_text())
    assert words["films"][0]["steps"] == [-1, 2, 4] and words["notes"] == [notes[0]]
    asked = verb.play([log_run], tmp_path / "all.html", "gap", every=1, limit_mb=limit)
    assert len(asked) == 1 and asked[0].endswith("6 frames of bodies, log (ok)")
    with pytest.raises(UserError, match="--limit-mb: found 1; allowed: 1.2 or more"):
        verb.play([log_run], tmp_path / "none.html", "gap", limit_mb=1)
    assert not (tmp_path / "none.html").exists()


def test_runs_whose_times_differ_are_played_and_that_is_said(library, program, log_run, tmp_path, capsys):
    other = run_of(program, tmp_path / "fine", "/time/dt_s=0.005")
    assert verb.main([str(log_run), str(other), "--out", str(tmp_path / "a.html")]) == 0
    said = capsys.readouterr().out
    assert "The times of the frames differ: 6 frames up to t = 0.05 s in the first run, 6 frames up to t = 0.025 s in the second" in said
    assert words_of((tmp_path / "a.html").read_text())["notes"][0] in said


# --- refusals


def test_what_is_no_run_is_refused(tmp_path, log_run, capsys):
    assert f"{tmp_path}: no run.json in this folder; allowed: the folder of a run" in refused(capsys, tmp_path)
    assert "no run.json" in refused(capsys, log_run, tmp_path / "nowhere")
    assert "found 3 runs; allowed: one, or two" in refused(capsys, log_run, log_run, log_run)


def test_a_run_without_frames_is_told_which_setting_writes_them(program, tmp_path, capsys):
    run = run_of(program, tmp_path / "bare", "/output/frames_every=0")
    assert f"{run}: the record names no frames; run the config with --set /output/frames_every=1" in refused(capsys, run)


@pytest.mark.parametrize("damage, said", [
    (lambda data: data[:-8], "ends before its last edge"),
    (lambda data: data.replace(b"element vertex", b"element virtex"), "no vertices or no faces"),
    (lambda data: data.replace(b"property double x", b"property triple x"), "a header that no frame has"),
    (lambda data: data[data.index(b"end_header") :], "not a PLY file"),
])
def test_a_broken_frame_is_refused_with_its_name(copied, capsys, damage, said):
    put(copied, LAST, damage((copied / LAST).read_bytes()))
    error = refused(capsys, copied)
    assert str(copied / LAST) in error and said in error
    assert not (copied / "play.html").exists()


def test_a_frame_of_another_run_is_refused(copied, capsys):
    (copied / LAST).write_bytes((copied / "frames/step_000003.ply").read_bytes())
    assert "sha256" in refused(capsys, copied)
    (copied / LAST).unlink()
    assert "No such file" in refused(capsys, copied)


def patched(run, offset_from_end: int, value: bytes) -> None:
    """Other bytes in the last frame, whose end are three edges of two ints."""
    data = bytearray((run / LAST).read_bytes())
    at = len(data) - offset_from_end
    data[at : at + len(value)] = value
    put(run, LAST, bytes(data))


def test_frames_of_other_bodies_are_refused(copied, capsys):
    patched(copied, 4, np.array([0], "<i4").tobytes())
    assert f"{LAST}: its edges are not those of the first frame" in refused(capsys, copied)


def test_a_position_that_is_not_finite_is_refused(copied, capsys):
    head = (copied / LAST).read_bytes().index(b"end_header\n") + len(b"end_header\n")
    patched(copied, (copied / LAST).stat().st_size - head, np.array([np.nan], "<f8").tobytes())
    assert f"{LAST}: the position of vertex 0 is not finite" in refused(capsys, copied)


def test_an_obstacle_that_the_page_cannot_draw_is_refused(copied, capsys):
    scene = json.loads((copied / "frames/scene.json").read_text())
    scene["obstacles"][0]["kind"] = "torus"
    put(copied, "frames/scene.json", json.dumps(scene).encode())
    assert "scene.json#/obstacles/0/kind: found 'torus'; allowed: plane, sphere, cylinder" in refused(capsys, copied)


def test_a_frame_of_a_step_that_the_record_lacks_is_refused(copied, capsys):
    record = json.loads((copied / "run.json").read_text())
    record["steps"].pop()
    (copied / "run.json").write_text(json.dumps(record))
    assert "#/steps: no step 4, but a frame of it" in refused(capsys, copied)


def test_without_its_library_it_says_how_to_have_it(log_run, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(pages.importlib.util, "find_spec", lambda name: None)
    assert "k3d is not installed (analysis/requirements-play.txt): ./bench setup" in refused(capsys, log_run, "--out", tmp_path / "a.html")


@pytest.mark.parametrize("words", [("--every", "0"), ("--every", "x"), ("--colour", "heat"), ("--limit-mb", "x"), ("--limit-mb", "nan"), ("--limit-mb", "0")])
def test_options_that_are_none_are_refused(words, log_run, capsys):
    assert verb.main([str(log_run), *words]) == 2 and words[0] in capsys.readouterr().err

"""All frames of a run in one file, and the start of a config without a run."""

import json
import shutil
import subprocess

import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image

from barrierbench_analysis.figures.pictures import animation, render
from tests.falling_cloth import CLOTH_ON_BALL

SMALL = ["--size", "120", "90"]


@pytest.fixture(scope="module")
def run(program, tmp_path_factory):
    """A cloth that has fallen onto a sphere, with frames of the start and of steps 0, 2 and 4."""
    folder = tmp_path_factory.mktemp("animation")
    (folder / "config.json").write_text(json.dumps({**CLOTH_ON_BALL, "name": "falling", "output": {"frames_every": 2}}))
    done = subprocess.run([program, "run", folder / "config.json", "--out", folder / "out"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "out"


def frames_of(file) -> list[np.ndarray]:
    found = []
    with Image.open(file) as image:
        for k in range(image.n_frames):
            image.seek(k)
            found.append(np.asarray(image.convert("RGB"), int))
    return found


@pytest.mark.parametrize("color, count", [("body", 4), ("gap", 3)])  # at the start nothing is solved
def test_a_gif_has_every_frame_and_the_body_moves_before_a_camera_that_does_not(run, tmp_path, color, count, capsys):
    out = tmp_path / "film.gif"
    assert render.main([str(run), "--out", str(out), "--color", color, "--bare", "--fps", "5", *SMALL]) == 0
    assert capsys.readouterr().out.strip() == str(out)
    with Image.open(out) as image:
        assert image.info["duration"] == 200 and image.info["loop"] == 0
    frames = frames_of(out)
    assert len(frames) == count and all(frame.shape == (90, 120, 3) for frame in frames)
    assert all(np.abs(a - b).max() > 60 for a, b in zip(frames, frames[1:]))
    still = np.abs(np.diff(np.stack(frames), axis=0)).max(axis=(0, 3)) == 0
    assert 0.2 < still.mean() < 0.999  # what the cloth never covers stays as it is
    caption = " ".join(out.with_suffix(".txt").read_text().split())
    assert caption.startswith(f"falling: log, {count} frames from") and "to end of step 4, t = 0.05 s." in caption


def test_frames_have_titles_with_their_times(run, tmp_path):
    assert render.main([str(run), "--out", str(tmp_path / "a.gif"), *SMALL]) == 0
    assert len(frames_of(tmp_path / "a.gif")) == 4


def test_an_mp4_is_what_ffmpeg_makes_of_all_frames(run, tmp_path, monkeypatch):
    """A stand-in that keeps what it is given."""
    tool = tmp_path / "bin/ffmpeg"
    tool.parent.mkdir()
    tool.write_text('#!/bin/sh\nfor out; do :; done\necho "$@" >"$0.words"\ncat >"$out"\n')
    tool.chmod(0o755)
    monkeypatch.setattr(animation.shutil, "which", lambda name: str(tool))
    out = tmp_path / "film.mp4"
    assert render.main([str(run), "--out", str(out), "--bare", *SMALL]) == 0
    assert out.stat().st_size == 4 * 90 * 120 * 3 and "-s 120x90 -r 2" in (tmp_path / "bin/ffmpeg.words").read_text()
    tool.write_text("#!/bin/sh\necho broken pipe of mine >&2\nexit 3\n")
    out.unlink()
    assert render.main([str(run), "--out", str(out), "--bare", *SMALL]) == 2 and not out.exists()


def test_what_cannot_be_filmed_is_said_before_anything_is_drawn(run, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(animation, "_stills", None)
    monkeypatch.setattr(animation.shutil, "which", lambda name: None)
    monkeypatch.setattr(animation.importlib.util, "find_spec", lambda name: None)
    for words, said in (
        (["--out", "a.mp4"], "apt-get install ffmpeg"), (["--out", "a.gif", "--step", "2"], "--step"), (["--out", "a.gif", "--fps", "0"], "--fps: found 0"),
        (["--fps", "5"], "--fps: found 5"), (["--set", "/time/steps=2"], "--set"), (["--out", "a.webm"], "found the ending .webm")):
        assert render.main([str(run), *(str(tmp_path / word) if word.startswith("a.") else word for word in words)]) == 2
        assert said in capsys.readouterr().err
    one = shutil.copytree(run, tmp_path / "one")
    record = json.loads((one / "run.json").read_text())
    record["artifacts"] = [file for file in record["artifacts"] if "start" in file["path"] or file["kind"] != "frame"]
    (one / "run.json").write_text(json.dumps(record))
    assert render.main([str(one), "--out", str(tmp_path / "a.gif")]) == 2 and "found 1 frame" in capsys.readouterr().err


# --- the start of a config


@pytest.fixture
def config(tmp_path, program, monkeypatch):
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", program)
    (tmp_path / "falling.json").write_text(json.dumps(CLOTH_ON_BALL))
    return tmp_path / "falling.json"


def test_the_start_of_a_config_is_drawn_without_a_run(config, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert render.main([str(config), *SMALL]) == 0
    assert capsys.readouterr().out.strip() == "falling_start.png" and sorted(p.suffix for p in tmp_path.iterdir()) == [".json", ".png", ".txt"]
    assert "bounding box" in (tmp_path / "falling_start.txt").read_text()
    assert render.main([str(config), *SMALL, "--bare", "--out", "a.png"]) == 0
    assert render.main([str(config), *SMALL, "--bare", "--out", "b.png", "--set", "/scene/bodies/1/transform/translate_m=[0,0,0.12]"]) == 0
    one, two = (plt.imread(tmp_path / f"{name}.png")[..., :3] for name in "ab")
    assert one.shape == (90, 120, 3) and one.std() > 0.05 and np.abs(one - two).max() > 0.2


def test_a_start_that_is_refused_is_drawn_and_the_reason_said(config, tmp_path, capsys):
    inside = ["--set", "/scene/bodies/0/transform/translate_m=[0,0,0]"]
    assert render.main([str(config), *SMALL, *inside, "--out", str(tmp_path / "a.png")]) == 0
    assert "a start without intersections" in capsys.readouterr().err and (tmp_path / "a.png").is_file()


@pytest.mark.parametrize("words, said", [
    (["--color", "gap"], "--color"), (["--step", "2"], "--step"), (["--set", "/scene/bodies/0/nome=1"], "nome"), (["--hide", "nobody"], "nobody")])
def test_what_a_config_has_not_is_refused(config, tmp_path, capsys, words, said):
    assert render.main([str(config), *SMALL, *words, "--out", str(tmp_path / "a.png")]) == 2
    assert said in capsys.readouterr().err and not (tmp_path / "a.png").exists()

"""Several runs in one picture: every run is there, under its label and outcome."""

import json
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes

from barrierbench_analysis.figures.pictures import frame_pixels, still_picture, stills
from barrierbench_analysis.io.places import ROOT
from tests.falling_cloth import CLOTH_ON_BALL

SET_TITLE = Axes.set_title
SWEPT = {"ids": {"sweep_id": "baselines"}, "labels": {"scene": "bodies", "step_solver": "penalty", "formulation": "log", "note": "baselines: main=1 drape penalty 1e3"},
         "status": {"outcome": "penetration"}, "audit": {"crossings": 12}}


@pytest.fixture(scope="module")
def runs(program, tmp_path_factory):
    """A cloth at its start, and after it has fallen."""
    folder = tmp_path_factory.mktemp("stills")
    for name, steps in (("short", 1), ("long", 5)):
        config = {**CLOTH_ON_BALL, "time": {**CLOTH_ON_BALL["time"], "steps": steps}, "output": {"frames_every": 100}}
        (folder / f"{name}.json").write_text(json.dumps(config))
        done = subprocess.run([program, "run", folder / f"{name}.json", "--out", folder / name], capture_output=True, text=True, check=False, timeout=60)
        assert done.returncode == 0, done.stderr
    return folder / "short", folder / "long"


def test_a_label_says_what_was_swept_and_how_it_ended():
    assert stills.label_of(SWEPT) == "main=1 drape penalty 1e3\npenetration\n12 crossings"
    alone = {**SWEPT, "labels": {**SWEPT["labels"], "note": ""}, "ids": {}, "status": {"outcome": "ok"}, "audit": None}
    assert stills.label_of(alone) == "bodies, penalty log\nok"
    assert stills.label_of({**alone, "labels": {**SWEPT["labels"], "note": "my try: log"}}) == "my try: log\nok"


def test_every_run_is_in_the_picture(runs, tmp_path):
    pixels = {}
    for name, given in {"both": runs, "same": (runs[0], runs[0])}.items():
        out = tmp_path / f"{name}.png"
        assert stills.main([*map(str, given), "--out", str(out), "--columns", "2"]) == 0
        pixels[name] = plt.imread(out)[:, :, :3]
    half = pixels["both"].shape[1] // 2
    below = pixels["both"].shape[0] // 3  # titles stand above
    left, right = pixels["both"][below:, :half], pixels["both"][below:, -half:]
    assert left.std() > 0.01 and right.std() > 0.01
    assert np.array_equal(left, pixels["same"][below:, :half]) and not np.array_equal(right, pixels["same"][below:, -half:])


@pytest.mark.parametrize("note", ["W" * 60, "a label of many words that goes on and on until it is wider than any picture that it could stand above " * 3])
@pytest.mark.parametrize("columns", [1, 2])
def test_no_title_is_cut_off(runs, tmp_path, monkeypatch, note, columns):
    titles = []
    monkeypatch.setattr(Axes, "set_title", lambda self, text, **more: titles.append(text) or SET_TITLE(self, text, **more))
    read = stills.read_record
    monkeypatch.setattr(stills, "read_record", lambda file: {**(record := read(file)), "labels": {**record["labels"], "note": note}})
    assert stills.main([*map(str, runs), "--out", str(tmp_path / "a.png"), "--columns", str(columns)]) == 0
    still_picture.render(runs[1], out=tmp_path / "b.png", look=frame_pixels.Look(color="gap", size=(200, 150)), title=note)
    assert len(titles) == 3 and all("".join(note.split()) in "".join(title.split()) for title in titles)
    for name in "ab":
        dark = plt.imread(tmp_path / f"{name}.png")[..., :3].min(axis=2) < 0.5  # of text
        assert dark.any() and not dark[:, :2].any() and not dark[:, -2:].any() and not dark[:2].any()


def test_what_cannot_be_drawn_is_named(runs, tmp_path):
    def told(*words):
        done = subprocess.run([sys.executable, ROOT / "analysis", "draw", "sheet", *map(str, words)], cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 2
        return done.stderr

    assert "nowhere" in told(tmp_path / "nowhere", "--out", tmp_path / "a.png")
    assert "in 0 columns" in told(runs[0], "--out", tmp_path / "a.png", "--columns", "0")
    assert not (tmp_path / "a.png").exists()


def test_the_path_that_is_said_is_the_file_that_is_written(runs, tmp_path, capsys):
    (tmp_path / "there").mkdir()
    for out, file in (("pic", "pic.png"), ("there", "there/stills.png"), ("a.PNG", "a.PNG")):
        assert stills.main([str(runs[0]), "--out", str(tmp_path / out)]) == 0
        assert capsys.readouterr().out.strip() == str(tmp_path / file) and (tmp_path / file).read_bytes().startswith(b"\x89PNG")


def test_another_ending_is_refused_before_anything_is_drawn(runs, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(stills, "render", None)
    assert stills.main([str(runs[0]), "--out", str(tmp_path / "st.foo")]) == 2
    assert f"bench draw sheet: --out {tmp_path / 'st.foo'}: found the ending .foo; allowed: a file that ends in .png" in capsys.readouterr().err

"""The stills at the top of README are those that `bench draw pictures` makes, and it says what they are."""

import subprocess
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from barrierbench_analysis.figures.pictures import pictures
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.program import start

ROOT = Path(__file__).resolve().parents[2]
RECORD = {"labels": {"formulation": "cubic"}, "scene": {"vertices": 42}}


@pytest.mark.parametrize("picture", pictures.PICTURES, ids=lambda picture: picture.name)
def test_a_picture_is_of_a_run_that_the_program_takes(program, picture, tmp_path):
    words = pictures.command_of(picture, tmp_path)
    assert words[0] == "run" and f"configs/scenes/{picture.scene}.json" in words[1]
    kept = [word for word in words[2:] if word not in ("--out", str(tmp_path), "--progress", "none")]
    done = subprocess.run([program, "check", words[1], *kept], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("picture", pictures.PICTURES, ids=lambda picture: picture.name)
def test_the_page_shows_it_with_the_words_of_its_caption(picture):
    file = ROOT / "docs" / f"{picture.name}.png"
    assert file.stat().st_size < pictures.LARGEST and plt.imread(file).shape[:2] == pictures.SIZE[::-1]
    page = (ROOT / "README.md").read_text()
    row = page[page.index(pictures.MARKS[0]):page.index(pictures.MARKS[1])]
    assert f"![{picture.says}](docs/{picture.name}.png)" in row and page.index(row) < 700
    title = row.split(f"{picture.says}: ")[1].split(" |")[0]
    said = " ".join(file.with_suffix(".txt").read_text().split())
    assert said.startswith(f"{title}, end of step ") and picture.scene in title and "barrier; " in title and title.endswith(" vertices")


def test_a_row_has_a_picture_and_its_caption_a_column():
    titles = {picture.name: pictures.title_of(picture, RECORD) for picture in pictures.PICTURES}
    assert titles["picture_noodle"] == "noodle; cubic barrier; 42 vertices" and "finer or softer" in titles["picture_solids"]
    lines = pictures.row_of(titles).splitlines()
    assert [line.count("|") for line in lines] == [4, 4, 4] and "noodle; cubic" in lines[2] and "docs/picture_noodle.png" in lines[0]


def test_the_row_goes_between_its_marks_and_nowhere_else():
    page = f"a\n{pictures.MARKS[0]}\nold\n{pictures.MARKS[1]}\nb\n"
    assert pictures.placed(page, r"\1 new") == f"a\n{pictures.MARKS[0]}\n\\1 new\n{pictures.MARKS[1]}\nb\n"
    with pytest.raises(UserError, match="<!-- pictures -->"):
        pictures.placed("a\n", "new")


def test_a_run_that_fails_makes_no_picture(monkeypatch, tmp_path):
    failed = subprocess.CompletedProcess([], 2, "", "no such scene")
    monkeypatch.setattr(start, "started", lambda *words: failed)
    with pytest.raises(UserError, match="picture_noodle: the program ended with 2: no such scene"):
        pictures.make(pictures.PICTURES[1], tmp_path, tmp_path / "docs")
    assert not (tmp_path / "docs").exists()

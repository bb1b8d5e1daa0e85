"""Figures of the pages: what is shown is copied, and no caption names a figure that is not there."""

import re

from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.pages.readme import figures

PAGE = "![a](docs/one.png) ![b](two.png) ![c](docs/elsewhere.png)"


def folder(path, **captions):
    path.mkdir()
    for name, caption in captions.items():
        (path / f"{name}.txt").write_text(caption)
        (path / f"{name}.png").write_bytes(b"png of " + name.encode())
    return path


def test_what_pages_show_is_copied_with_its_company(tmp_path):
    made = folder(tmp_path / "made", one="Other series: one_more: x.", one_more="Beside one, and one_more_more.", two="alone", three="not shown", one_more_more="last")
    docs = folder(tmp_path / "docs")
    assert figures.copy([PAGE], made, docs) == ["one", "one_more", "one_more_more", "two"]
    assert (docs / "one_more.png").read_bytes() == b"png of one_more" and not (docs / "three.png").exists()
    assert figures.absent(docs) == []


def test_a_caption_without_its_company_is_told(tmp_path):
    docs = folder(tmp_path / "docs", one="Eigenvalues: one_eigenvalues_more.")
    (told,) = figures.absent(docs)
    assert "one.txt" in told and "one_eigenvalues_more.png is not there" in told


def test_no_caption_of_ours_names_a_missing_figure():
    assert figures.absent(figures.Path(__file__).resolve().parents[2] / "docs") == []


def test_every_picture_of_docs_stands_on_a_page():
    pages = [path.read_text() for of in ("*.md", "docs/**/*.md", "results/*.md", "examples/**/*.md") for path in ROOT.glob(of)]
    shown = {name for text in pages for name in re.findall(r"!\[[^\]]*\]\([^)]*?([\w-]+)\.png\)", text)}
    pictures = {path.stem for path in (ROOT / "docs").glob("*.png")}
    assert len(pictures) > 40 and pictures - shown == set()
    assert {path.stem for path in (ROOT / "docs").glob("*.txt")} - pictures == set()

"""Figures of the pages: what is shown is copied, and no caption names a figure that is not there."""

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

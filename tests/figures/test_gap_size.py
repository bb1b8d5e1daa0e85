"""The log over the cubic against unknowns: from the kept rows, to the same bytes, with the caption of the page."""

from barrierbench_analysis.studies.comparison import spec
from barrierbench_analysis.figures.plots.drawing import Drawing
from barrierbench_analysis.studies.comparison.studies import of_file
from barrierbench_analysis.studies.rules.gap_map import size, size_figure
from barrierbench_analysis.studies.rules.gap_map.table import kept_map
from barrierbench_analysis.io.places import ROOT


def drawn(folder, title=size_figure.TITLE):
    folder.mkdir()
    return {path.suffix: path.read_bytes() for path in size_figure.draw(kept_map(), folder / "gap_size", title=title)}


def test_it_is_rebuilt_to_the_same_bytes_whoever_asks(tmp_path):
    """By the page of the map, and by ./bench draw figure."""
    page, of = drawn(tmp_path / "page"), spec.read_spec(ROOT / "configs/figures/gap_size.json")
    (tmp_path / "figure").mkdir()
    drawing = Drawing(of.name, of.title, tmp_path / "figure/gap_size", of.width_in, of.options)
    figure = {path.suffix: path.read_bytes() for path in of.kind.draw(of_file(of.records.what, tmp_path, False, 1), drawing)}
    assert figure == page and set(page) >= {".png", ".pdf", ".csv", ".txt"}
    assert (ROOT / "docs/gap_size.txt").read_bytes() == page[".txt"]


def test_its_numbers_are_ratios_of_kept_rows(tmp_path):
    lines = drawn(tmp_path / "page")[".csv"].decode().splitlines()
    rows = {(r["shape"], r["scene"], r["resolution"], r["theta"]): r for r in kept_map().rows if r["limit"] == size.LIMIT}
    heads = lines[0].split(",")
    assert len(lines) > 90
    for line in lines[1:]:
        at = dict(zip(heads, line.split(",")))
        log, cubic = (rows[shape, at["scene"], at["resolution"], float(at["theta"])] for shape in ("log", "cubic"))
        assert int(at["unknowns"]) == log["unknowns"] == cubic["unknowns"]
        for metric in size_figure.METRICS:
            assert abs(float(at[metric]) * cubic[metric] / log[metric] - 1) < 1e-5


def test_its_caption_names_what_did_not_get_through():
    caption = " ".join((ROOT / "docs/gap_size.txt").read_text().split())
    assert "pile 6 at theta 0.01 (cubic: stall_overload)" in caption and "N: 96 pairs of runs in 26 places." in caption

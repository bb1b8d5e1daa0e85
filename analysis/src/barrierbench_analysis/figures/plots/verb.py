"""The verb figures: those of the records below a folder, in an archive of one, or of ./bench data steps
--out."""

from pathlib import Path

from barrierbench_analysis.io.errors import reported
from barrierbench_analysis.program.arguments import options, parser_of
from barrierbench_analysis.tables.archive import beside, is_archive, study

from . import demo, newton_steps


@reported("draw figures")
def main(argv: list[str]) -> int:
    parser = parser_of("draw figures")
    text = """
runs RUNS: a folder with records, an archive of one, or that file
out OUT: default: RUNS/figures, NAME.figures beside an archive, or the folder of the file"""
    options(parser, text, runs=Path, out={"type": Path, "nargs": "?"})
    given = parser.parse_args(argv)
    if given.runs.is_file() and not is_archive(given.runs):
        return newton_steps.make(given.runs, given.out)
    with study(given.runs) as (folder,):
        return demo.make(folder, given.out or beside(given.runs, "figures"))

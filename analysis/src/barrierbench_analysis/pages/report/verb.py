"""One HTML file, which needs no network, of the records below a folder: what each formulation takes, the
verdict in plain words, scenes in motion where frames were kept, what did not end ok, formulations beside
their references, figures, every run with the command that makes it again, and a methods text. With two
folders: what differs between them.

Exit codes: 0 written, 2 no record can be read, or the file cannot be written.
"""

from pathlib import Path

from barrierbench_analysis.io.errors import UserError, code_of, reported
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import count_from_0, options, parser_of
from barrierbench_analysis.tables.archive import beside, study

from . import figures, players
from .gather import Folder, gathered
from .page import page
from .verdict import headline

NAME, NAME_OF_TWO = "report.html", "report_against_{}.html"


def write_page(out: Path, text: str) -> None:
    """Whole or not at all. Errors: UserError with the file and what is needed."""
    try:
        write_whole(out, text)
    except OSError as error:
        raise UserError(
            f"{out}: cannot be written: {error.strerror}; allowed: a file in a folder that may be written to"
            " (--out FILE)",
            code_of(error),
        ) from None


def report(
    folder: Path,
    out: Path,
    drawn: Path | None = None,
    most_players: int = players.MOST,
    archive: Path | None = None,
) -> str:
    """Writes the page of a folder; what is to be said of it. drawn: where ./bench draw figures has just drawn
    the figures of these records. archive: that the folder was unpacked from. Errors: UserError, RecordError.
    """
    found = gathered(folder, archive)
    text = page(found, out, figures.drawn(found, drawn), players.made(found, most_players))
    write_page(out, text)
    return f"{headline(found).text}\n{out} ({out.stat().st_size / 1e6:.1f} MB)"


def report_of_two(a: Folder, b: Folder, out: Path) -> str:
    """The same of what differs between two folders. Errors: UserError, RecordError."""
    from . import diff_page  # takes what judges records, and scipy: a page of one folder needs neither
    from .diff import diff_of

    diff = diff_of(a, b)
    write_page(out, diff_page.page(diff, out))
    return f"{diff_page.verdict(diff)[0].text}\n{out} ({out.stat().st_size / 1e6:.1f} MB)"


@reported("report")
def main(argv: list[str]) -> int:
    parser = parser_of("report", __doc__, "./bench report results/runs/before results/runs/after")
    text = f"""
folder DIR: a folder with records below it, or an archive
other DIR2: a second one: what differs
--out FILE: the page (default: {NAME} in DIR, or beside an archive; of two, in DIR2)
--players N: scenes in motion at most; each takes up to 3 MB (default: {players.MOST})"""
    most = {"type": count_from_0, "default": players.MOST}
    options(parser, text, folder=Path, other={"type": Path, "nargs": "?"}, out=Path, players=most)
    args = parser.parse_args(argv)
    if args.other is None:
        with study(args.folder) as (folder,):
            archive = args.folder if folder != args.folder else None
            out = args.out or beside(args.folder, NAME)
            print(report(folder, out, most_players=args.players, archive=archive))
        return 0
    asked = args.folder, args.other
    with study(*asked) as (first, second):
        found = [
            gathered(folder, path if folder != path else None)
            for folder, path in zip((first, second), asked, strict=True)
        ]
        out = args.out or beside(args.other, NAME_OF_TWO.format(first.resolve().name))
        print(report_of_two(*found, out))
    return 0

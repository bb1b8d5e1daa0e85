"""A study as one file: a ZIP archive of all files below a folder with records, and in it archive.json, which
has the version of this form and size and sha256 of every file. ./bench gate compare, report, draw figures,
data collect and verify read it in the place of the folder. The same files make the same archive, byte for
byte.

Exit codes: 0 written, 2 no record below the folder, or the file cannot be written.
"""

import sys
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.input_file import below
from barrierbench_analysis.io.record_file import RecordError, read_record
from barrierbench_analysis.program.arguments import parser_of
from barrierbench_analysis.tables.archive import packed

from .named import inputs, leads_out


def inputs_outside(folder: Path) -> list[str]:
    """Files that records below the folder were made of and that lie elsewhere. A record that cannot be read
    names none.
    """
    found = {}
    for path in below(folder, "run.json"):
        try:
            names = inputs(read_record(path))
        except RecordError:
            continue
        found |= {name: None for name in names if leads_out(folder, path.parent, name)}
    return list(found)


@reported("data archive")
def main(argv: list[str]) -> int:
    parser = parser_of("data archive", __doc__, "./bench report strip.zip")
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="a folder with records below it")
    parser.add_argument("file", type=Path, metavar="FILE.zip", help="the archive")
    args = parser.parse_args(argv)
    if args.file.suffix != ".zip":
        raise UserError(f"{args.file}: found the suffix {args.file.suffix!r}; .zip is needed")
    lines = packed(args.folder, args.file)
    if outside := inputs_outside(args.folder):
        print(
            f"archive: {len(outside)} inputs lie outside {args.folder} and are not in the archive, the first"
            f" {outside[0]}: runs that need them cannot be made again from it; ./bench run and ./bench sweep"
            " copy inputs beside the record with --keep-inputs",
            file=sys.stderr,
        )
    records = sum(Path(line["path"]).name == "run.json" for line in lines)
    before, after = sum(line["bytes"] for line in lines) / 1e6, args.file.stat().st_size / 1e6
    print(f"{args.file}: {records} records, {len(lines)} files, {after:.1f} MB ({before:.1f} MB unpacked)")
    return 0

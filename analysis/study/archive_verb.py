"""A study as one file: a ZIP archive of all files below a folder with records, and in it archive.json, which
has the version of this form and size and sha256 of every file. ./bench compare, report, figures, collect and
verify read it in the place of the folder. The same files make the same archive, byte for byte.

Exit codes: 0 written, 2 no record below the folder, or the file cannot be written.
"""

from __future__ import annotations

from pathlib import Path

from ..errors import UserError, tells
from ..front.arguments import parser_of
from .archive import packed


@tells("archive")
def main(argv: list[str]) -> int:
    parser = parser_of("archive", __doc__, "./bench report strip.zip")
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="a folder with records below it")
    parser.add_argument("file", type=Path, metavar="FILE.zip", help="the archive")
    args = parser.parse_args(argv)
    if args.file.suffix != ".zip":
        raise UserError(f"{args.file}: found the suffix {args.file.suffix!r}; .zip is needed")
    lines = packed(args.folder, args.file)
    records = sum(Path(line["path"]).name == "run.json" for line in lines)
    before, after = sum(line["bytes"] for line in lines) / 1e6, args.file.stat().st_size / 1e6
    print(f"{args.file}: {records} records, {len(lines)} files, {after:.1f} MB ({before:.1f} MB unpacked)")
    return 0

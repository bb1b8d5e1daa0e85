"""The verb `bench eval` of this package: python -m barrierbench.eval [FILE]; exit code 0, 2 or 75 as there."""

from __future__ import annotations

import argparse
import sys

from . import _core


def main(argv: list[str]) -> int:
    """Answers the queries of a file, or of the standard input, on the standard output."""
    parser = argparse.ArgumentParser(
        prog="python -m barrierbench.eval", description="Answers queries, one JSON object a line."
    )
    parser.add_argument("file", nargs="?", default="-", help="queries, - for standard input")
    parser.add_argument("--schema", action="store_true", help="print the JSON Schema of all kinds")
    given = parser.parse_args(argv)
    if given.schema:
        sys.stdout.write(_core.eval_schema())
        return 0
    try:
        return _core.run_eval(given.file)
    except _core.ConfigError as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""python analysis VERB ARGUMENTS: the front door, as the script ./bench starts it."""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parent / "src")

from barrierbench_analysis.front.door import main  # noqa: E402  (the line above says where it is)
from barrierbench_analysis.program import streams  # noqa: E402

if __name__ == "__main__":
    streams.prepare()
    sys.exit(main(sys.argv[1:]))

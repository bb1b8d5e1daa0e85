"""python -m barrierbench_analysis.gate VERB ARGUMENTS: the verbs of ./bench that judge."""

import sys

from . import accept, calibrate, compare, gate, trend

VERBS = {"compare": compare.main, "gate": gate.main, "calibrate": calibrate.main, "accept": accept.main, "trend": trend.main}


def main(argv: list[str]) -> int:
    if not argv or argv[0] not in VERBS:
        print(f"one of {', '.join(VERBS)}", file=sys.stderr)
        return 2
    return VERBS[argv[0]](argv[1:])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

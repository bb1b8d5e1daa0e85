"""What code computes verdicts, and since when: verdict_code.json beside this file lists every change of it
with what it means, oldest first. A registered rule fixes parts, metrics and the words of the statistics; that
the code behind these words is still the one of its day nothing else says.
"""

import json
from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io.digests import of_text
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.module_code import code_of
from barrierbench_analysis.tables import estimate, gap_rule

from . import cells, equal_gap, numbers, outcomes, threshold, verdict

FILE = Path(__file__).with_suffix(".json")
MODULES = (cells, equal_gap, estimate, gap_rule, numbers, outcomes, threshold, verdict)


@dataclass(frozen=True)
class Change:
    date: str
    code: str  # code_now() from then on
    what: str


def code_now() -> str:
    """Hash of the code of MODULES without comments and docstrings."""
    return of_text(json.dumps([code_of(module) for module in MODULES]))[:16]


def changes() -> list[Change]:
    return [Change(**one) for one in read_object(FILE)["changes"]]

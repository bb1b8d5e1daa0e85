"""The verb figures: those of the records below a folder, or of the file of ./bench steps --out."""

from __future__ import annotations

from pathlib import Path

from ..errors import UserError, tells
from . import demo, newton_steps


@tells("figures")
def main(argv: list[str]) -> int:
    if not argv:
        raise UserError("the folder of the runs is needed: ./bench figures results/runs/demo")
    return (newton_steps if Path(argv[0]).is_file() else demo).main(argv)

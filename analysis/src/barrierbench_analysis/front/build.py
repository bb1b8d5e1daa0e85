"""The verb build: a preset with all its targets."""

from __future__ import annotations

from barrierbench_analysis.io.errors import tells
from barrierbench_analysis.program.building import build, say, setup


@tells("build")
def main(argv: list[str]) -> int:
    preset = argv[0] if argv else "release"
    setup()
    build(preset, options={"BB_CUDA": "AUTO"})
    say(f"built build/{preset}")
    return 0

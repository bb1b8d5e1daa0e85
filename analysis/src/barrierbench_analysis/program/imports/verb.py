"""./bench import-scene SOURCE --out scene.json: a scene of another program as a config, with its card."""

import argparse
import json
from pathlib import Path

from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.whole_file import check_can_be_written, write_whole
from barrierbench_analysis.program.arguments import count_from_1, options, parser_of
from barrierbench_analysis.program.start import finished

from .importers import IMPORTERS, importer_of

ABOUT = """
SOURCE: {sources}.
SCENE.json becomes a config, SCENE_meshes its meshes, and SCENE_card.json the card: every key of the source
is mapped, changed, not mapped, or unknown to this importer. The program checks the config at the end."""
ARGUMENTS = """
SOURCE: a file, or a session folder
--out SCENE.json: the config that is written
--from NAME: what wrote the source (default: found from the source)
--steps N: time steps of the config (default: those of the source)
"""


def parse(argv: list[str]) -> argparse.Namespace:
    sources = "; ".join(f"{one.source} ({one.name})" for one in IMPORTERS)
    parser = parser_of("import-scene", ABOUT.format(sources=sources))
    options(
        parser,
        ARGUMENTS,
        SOURCE={"type": Path, "metavar": "SOURCE"},
        out={"type": Path, "required": True},
        **{"from": {"choices": [one.name for one in IMPORTERS], "dest": "kind"}},
        steps=count_from_1,
    )
    found = parser.parse_args(argv)
    found.source = found.SOURCE
    if found.out.suffix != ".json":
        raise UserError(f"--out: found {str(found.out)!r}; allowed: a file that ends in .json")
    if not found.source.exists():
        raise UserError(f"{found.source}: found nothing; allowed: a file or a session folder")
    return found


@reported("import-scene")
def main(argv: list[str]) -> int:
    """Prints the card. Exit code 0: the program takes the config."""
    asked = parse(argv)
    check_can_be_written(asked.out)
    importer = importer_of(asked.source, asked.kind)
    config, card = importer.read(asked.source, asked.out, asked.steps)
    config.write(f"{asked.source.name}, a scene of {importer.name}, read by ./bench import-scene")
    target = asked.out.with_name(f"{asked.out.stem}_card.json")
    write_whole(target, json.dumps(card.as_json(), indent=2) + "\n")
    print("\n".join(card.lines()))
    finished("explain", str(asked.out), what=f"{asked.out}: ")
    bodies, obstacles = len(config.bodies), len(config.obstacles)
    print(
        f"{asked.out}: {bodies} bodies with {config.vertices} vertices, {obstacles} obstacles,"
        f" {config.steps} steps of {config.dt_s:g} s; card: {target}"
    )
    return 0

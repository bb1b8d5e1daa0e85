"""The importers: one row each."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_json

from . import libuipc, polyfem, ppf


class Importer(NamedTuple):
    """One kind of source."""

    name: str
    recognised: Callable[[object], bool]  # what a JSON file holds, or the path of a folder
    read: Callable  # (source, out, steps) -> the config and the card
    source: str  # what it reads


IMPORTERS = (
    Importer(
        "polyfem",
        polyfem.recognised,
        polyfem.read,
        "a scene of PolyFEM: a JSON file with geometry and materials",
    ),
    Importer(
        "libuipc",
        libuipc.recognised,
        libuipc.read,
        "a scene of libuipc: the JSON file that SceneIO.save writes",
    ),
    Importer(
        "ppf",
        ppf.recognised,
        ppf.read,
        "a session folder of the ppf contact solver: info.toml, param.toml, bin",
    ),
)


def importer_of(source: Path, name: str | None) -> Importer:
    """The importer with this name, or the one that knows the source. Errors: UserError."""
    if name:
        return next(one for one in IMPORTERS if one.name == name)
    held = source if source.is_dir() else read_json(source)
    for one in IMPORTERS:
        if one.recognised(held):
            return one
    allowed = "; ".join(one.source for one in IMPORTERS)
    found = f"a folder of {len(list(source.iterdir()))} files" if source.is_dir() else "another JSON file"
    raise UserError(f"{source}: found {found}; allowed: {allowed}")

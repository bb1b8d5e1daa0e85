"""The card of an engine: engines/NAME/card.toml, held against configs/schema/engine_card.schema.json."""

from dataclasses import dataclass
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import checked, refused

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10, whose pip brings the same reader
    from pip._vendor import tomli as tomllib

ENGINES = ROOT / "engines"


@dataclass(frozen=True)
class Card:
    folder: Path
    data: dict

    @property
    def name(self) -> str:
        return self.data["name"]

    @property
    def adapter(self) -> Path:
        return self.folder / "adapter.py"

    @property
    def requirements(self) -> Path:
        return self.folder / "requirements.txt"

    def settings_of(self, variant: str) -> dict:
        """Of a variant: defaults, and what it sets."""
        defaults = {name: one["default"] for name, one in self.data["settings"].items()}
        return defaults | self.data["variants"][variant].get("settings", {})


def _check(data: dict, path: Path) -> None:
    """What no schema says: settings that are named are there, and defaults are of their kind."""
    known = data["settings"]
    for place, names in (
        ("fit", data["fit"].values()),
        ("tests", data.get("tests", {})),
        *((f"variants/{name}/settings", one.get("settings", {})) for name, one in data["variants"].items()),
    ):
        for name in names:
            if name not in known:
                raise refused(path, place, name, f"one of {', '.join(known)}")
    for name, one in known.items():
        if "allowed" in one and one["default"] not in one["allowed"]:
            raise refused(
                path, f"settings/{name}/default", one["default"], f"one of {', '.join(one['allowed'])}"
            )


def read_card(name: str, engines: Path = ENGINES) -> Card:
    """Errors: UserError with the cards that there are, or with the place in the file."""
    path = engines / name / "card.toml"
    if not path.is_file():
        raise UserError(f"found engine {name!r}; allowed: {', '.join(names(engines))}")
    try:
        data = tomllib.loads(input_file.read_text(path))
    except ValueError as error:
        raise UserError(f"{path}: not TOML: {error}") from None
    checked(data, path, "engine_card")
    if data["name"] != name:
        raise refused(path, "name", data["name"], f"{name!r}, as its folder,")
    _check(data, path)
    card = Card(path.parent, data)
    for file in (card.adapter, card.requirements):
        if not file.is_file():
            raise UserError(f"{file}: no such file; an engine has card.toml, adapter.py and requirements.txt")
    return card


def names(engines: Path = ENGINES) -> list[str]:
    return sorted(path.parent.name for path in engines.glob("*/card.toml"))

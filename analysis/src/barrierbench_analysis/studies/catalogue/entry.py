"""A scene of the catalogue: configs/catalogue/NAME.json, and the ordinary configs that it makes at its two
sizes.
"""

import copy
import json
from dataclasses import dataclass, field
from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec, refused
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.studies.claims.merged import put

from .checks import check_of
from .layouts import placed, places

FOLDER = ROOT / "configs" / "catalogue"
MINI, FULL = "mini", "full"


@dataclass(frozen=True)
class Entry:
    path: Path
    data: dict = field(hash=False)

    @property
    def name(self) -> str:
        return self.data["name"]

    @property
    def is_rejected(self) -> bool:
        """Whether it is expected that the program does not start it."""
        return any(expected["check"] == "rejected" for expected in self.data["expect"])

    def config(self, size: str = MINI) -> dict:
        """The config of the size `mini` or `full`. Errors: UserError with file and place."""
        made = {
            "schema": "barrierbench.config/1",
            "name": f"{self.name}-{size}",
            "doc": f"{self.data['title']}. {self.data['source']}",
            **copy.deepcopy(self.data["config"]),
        }
        for pointer, value in self.data[size]["set"].items():
            try:
                put(made, pointer, value)
            except (IndexError, ValueError, TypeError, AttributeError):
                raise refused(self.path, f"{size}/set{pointer}", value, "a place in the config") from None
        bodies = made["scene"].get("bodies", [])
        made["scene"]["bodies"] = [one for k, body in enumerate(bodies) for one in self._copies(body, k)]
        loads = self.data["loads"]
        made["matching"] = {"rule": "equal_force", "load_N": loads["contact_N"]}
        if "limit_N_per_m" in loads:
            made["matching"]["limit_load_N_per_m"] = loads["limit_N_per_m"]
        return made

    def _copies(self, body: dict, index: int) -> list[dict]:
        copies = body.get("copies")
        if copies is None:
            return [body]
        body = {key: value for key, value in body.items() if key != "copies"}
        return [
            {**body, "name": f"{body['name']}_{k}", "transform": placed(body.get("transform", {}), place)}
            for k, place in enumerate(places(copies, self.path, f"config/scene/bodies/{index}/copies"))
        ]


def names(folder: Path = FOLDER) -> list[str]:
    return sorted(path.stem for path in folder.glob("*.json"))


def read_entry(name: str, folder: Path = FOLDER) -> Entry:
    """A scene. Errors: UserError: no such scene, what its schema refuses, a name that is not the file's, a
    check that is unknown, a setting of one size that the other leaves open.
    """
    path = folder / f"{name}.json"
    if not path.is_file():
        raise UserError(f"scene {name!r}: one of {', '.join(names(folder))} (configs/catalogue/)")
    data = read_spec(path, "catalogue")
    if data["name"] != name:
        raise refused(path, "name", data["name"], "the name of the file")
    for k, expected in enumerate(data["expect"]):
        check_of(expected, path, f"expect/{k}")
    mini, full = (set(data[size]["set"]) for size in (MINI, FULL))
    if unlike := sorted(mini ^ full):
        size = MINI if unlike[0] in full else FULL
        raise UserError(f"{path}#/{size}/set: {unlike[0]} is missing, which the other size sets")
    return Entry(path, data)


def entries(chosen: list[str], folder: Path = FOLDER) -> list[Entry]:
    """The scenes of these names, all without one."""
    return [read_entry(name, folder) for name in chosen or names(folder)]


def config_text(entry: Entry, size: str = MINI) -> str:
    """An ordinary config, as the program reads it."""
    return json.dumps(entry.config(size), indent=1) + "\n"


def write_config(entry: Entry, file: Path, size: str = MINI) -> None:
    write_whole(file, config_text(entry, size))

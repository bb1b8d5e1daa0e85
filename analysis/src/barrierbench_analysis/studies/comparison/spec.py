"""A figure of the comparison as data: configs/figures/NAME.json."""

from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from barrierbench_analysis.figures.plots.drawing import SOURCES, Wanted
from barrierbench_analysis.figures.style import NARROW_IN, WIDE_IN
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.spec_file import read_spec as read_json_spec
from barrierbench_analysis.io.spec_file import refused

from .kinds import KINDS, Kind

FOLDER = ROOT / "configs" / "figures"
COLUMNS_IN = {1: NARROW_IN, 2: WIDE_IN}
ALL = "all"


@dataclass(frozen=True)
class Spec:
    path: Path
    title: str
    kind: Kind
    width_in: float
    records: Wanted
    quick: Wanted
    options: dict

    @property
    def name(self) -> str:
        return self.path.stem


def _wanted(data: dict, path: Path, place: str, kind: Kind) -> Wanted:
    given = [source for source in SOURCES if source in data]
    if given != [kind.source]:
        raise refused(path, place, data, f'{{"{kind.source}": ...}}, which is what this kind is drawn of,')
    what = data[kind.source]
    if isinstance(what, list):
        return Wanted(kind.source, tuple(what))
    file = path.parent / what
    if not file.is_file():
        raise refused(path, f"{place}/{kind.source}", what, "the path of a file, relative to this one,")
    return Wanted(kind.source, file.resolve(), data.get("alone", False))


def read_spec(path: Path) -> Spec:
    """Errors: UserError with file, place, what was found and what is allowed."""
    data = read_json_spec(path, "figure")
    if data["kind"] not in KINDS:
        raise refused(path, "kind", data["kind"], f"one of {', '.join(KINDS)}")
    kind, options = KINDS[data["kind"]], data.get("options", {})
    if unknown := [name for name in options if name not in kind.options]:
        allowed = ", ".join(kind.options) or "no options"
        raise refused(path, f"options/{unknown[0]}", options[unknown[0]], f"{allowed}, of this kind,")
    return Spec(
        path,
        data["title"],
        kind,
        COLUMNS_IN[data["columns"]],
        _wanted(data["records"], path, "records", kind),
        _wanted(data["quick"], path, "quick", kind),
        {**kind.options, **options},
    )


def known(folder: Path = FOLDER) -> list[str]:
    return sorted(path.stem for path in folder.glob("*.json"))


def chosen(names: list[str], folder: Path = FOLDER) -> list[Spec]:
    """The figures of these names in their order, each once; ALL stands for every one. Errors: UserError with
    the known names.
    """
    every = known(folder)
    for name in names:
        if name not in (*every, ALL):
            near = get_close_matches(name, every, 1)
            raise UserError(
                f"figure {name!r}: one of {', '.join(every)}, or {ALL}"
                + (f"; did you mean {near[0]!r}?" if near else "")
            )
    wanted = every if ALL in names else list(dict.fromkeys(names))
    return [read_spec(folder / f"{name}.json") for name in wanted]

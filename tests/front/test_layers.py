"""The layers of the Python package, lowest first: a module imports its own layer and those below, and packages import in no circle."""

import ast
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "analysis" / "src"
NAME = "barrierbench_analysis"
LAYERS = ("io", "program", "tables", "figures", "studies", "pages", "front")


def module_of(path: Path, source: Path = SOURCE) -> str:
    return ".".join(path.relative_to(source).with_suffix("").parts).removesuffix(".__init__")


def imports_of(text: str, package: str) -> set[str]:
    """Modules of the package, or names in them, that a text imports, also within functions. package: where a relative import begins."""
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found |= {each.name for each in node.names}
        elif isinstance(node, ast.ImportFrom):
            start = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*start, *([node.module] if node.module else [])])
            found |= {f"{base}.{each.name}" for each in node.names}
    return {name for name in found if name.split(".")[0] == NAME}


def edges(source: Path = SOURCE) -> list[tuple[str, str]]:
    paths = sorted(source.rglob("*.py"))
    return [(module_of(path, source), imported) for path in paths
            for imported in imports_of(path.read_text(), module_of(path, source) if path.name == "__init__.py" else module_of(path, source).rpartition(".")[0])]


def layer(name: str) -> str:
    """Empty: of the package itself, which loads what it exports on request."""
    return name.split(".")[1] if name.count(".") else ""


def upwards(found: list[tuple[str, str]]) -> list[str]:
    rank = {name: k for k, name in enumerate(LAYERS)}
    return [f"{a} imports {b}" for a, b in found if layer(a) in rank and layer(b) in rank and rank[layer(a)] < rank[layer(b)]]


def packages_in_circles(found: list[tuple[str, str]], packages: set[str]) -> set[str]:
    """Packages from which a way along imports leads back. A package is a folder; modules beside it are of the folder above."""
    def of(name: str) -> str:
        while name not in packages:
            name = name.rpartition(".")[0]
        return name

    ways = defaultdict(set)
    for a, b in found:
        if of(a) != of(b) and NAME not in (of(a), of(b)):
            ways[of(a)].add(of(b))

    def reached(start: str) -> set[str]:
        seen, left = set(), [start]
        while left:
            new = ways[left.pop()] - seen
            seen |= new
            left += new
        return seen

    return {name for name in list(ways) if name in reached(name)}


def every_package() -> set[str]:
    return {module_of(path) for path in SOURCE.rglob("__init__.py")}


def test_every_module_is_of_a_layer_and_every_folder_a_package():
    folders = {path.parent for path in (SOURCE / NAME).rglob("*.py")}
    assert {folder.name for folder in folders if folder.parent == SOURCE / NAME} == set(LAYERS)
    assert [str(folder) for folder in folders if not (folder / "__init__.py").is_file()] == []
    assert {path.name for path in (SOURCE / NAME).glob("*.py")} == {"__init__.py"}
    assert not list((ROOT / "analysis").glob("*/*.py")) and [path.name for path in (ROOT / "analysis").glob("*.py")] == ["__main__.py"]


def test_no_module_imports_from_a_layer_above():
    found = edges()
    assert len(found) > 1000 and {layer(a) for a, _ in found} >= set(LAYERS)
    assert upwards(found) == []


def test_no_packages_import_in_a_circle():
    packages = every_package()
    assert len(packages) > 30
    assert packages_in_circles(edges(), packages) == set()


@pytest.mark.parametrize("text, package, says", [
    ("from barrierbench_analysis.front.door import main", "barrierbench_analysis.io", "barrierbench_analysis.io.made imports barrierbench_analysis.front.door.main"),
    ("def late():\n    from ..pages import play", "barrierbench_analysis.tables", "barrierbench_analysis.tables.made imports barrierbench_analysis.pages.play"),
    ("import barrierbench_analysis.studies.kit", "barrierbench_analysis.figures.plots", "barrierbench_analysis.figures.plots.made imports barrierbench_analysis.studies.kit"),
])
def test_an_import_upwards_is_found(text, package, says):
    made = [(f"{package}.made", imported) for imported in imports_of(text, package)]
    assert upwards(made) == [says]


def test_a_circle_is_found():
    a, b, c = (f"{NAME}.studies.{name}" for name in "abc")
    packages = {NAME, f"{NAME}.studies", a, b, c}
    line = [(f"{a}.x", f"{b}.y"), (f"{b}.z", f"{c}.x")]
    assert packages_in_circles(line, packages) == set()
    assert packages_in_circles([*line, (f"{c}.y", f"{a}.y")], packages) == {a, b, c}

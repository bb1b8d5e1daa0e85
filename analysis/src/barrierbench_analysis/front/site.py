"""Builds the web site of all pages, with search and formulas, in build/site. It needs no network to be read.
The first time packages of PyPI are installed in build/site-environment (analysis/requirements-site.txt).

Exit codes: 0 built, 1 mkdocs has found a broken link or another fault, 2 the packages cannot be installed, or
a page links to nothing.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, reported
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of

REQUIREMENTS = ROOT / "analysis/requirements-site.txt"
ENVIRONMENT = ROOT / "build/site-environment"
PAGES = ROOT / "build/site-pages"
CONFIG = ROOT / "build/site.yml"  # mkdocs.yml with the navigation
SITE = ROOT / "build/site"
MATHJAX = "lib/python*/site-packages/mathjax/static/mathjax/es5/tex-svg.js"
WORKER = Path(__file__).with_name("site_worker.js")
# Which elements hold formulas: those of the extension arithmatex.
CONFIGURATION = """window.MathJax = {
  tex: {inlineMath: [["\\\\(", "\\\\)"]], displayMath: [["\\\\[", "\\\\]"]], processEscapes: true},
  options: {ignoreHtmlClass: ".*", processHtmlClass: "arithmatex", enableMenu: false},
};
"""


def _ran(*words: str | Path) -> int:
    """Exit code; what is said goes to stderr."""
    return subprocess.run([str(word) for word in words], cwd=ROOT, stdout=sys.stderr, check=False).returncode


def environment() -> Path:
    """Python of the site's environment, which is made where it is not that of the requirements. Errors:
    UserError where it cannot be made.
    """
    python, made = ENVIRONMENT / "bin/python", ENVIRONMENT / "recipe"
    recipe = f"{ENVIRONMENT}\n{input_file.read_text(REQUIREMENTS)}"
    if not made.is_file() or input_file.read_text(made) != recipe:
        shutil.rmtree(ENVIRONMENT, ignore_errors=True)
        ENVIRONMENT.parent.mkdir(exist_ok=True)
        base = getattr(sys, "_base_executable", sys.executable)
        install = (python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check")
        if _ran(base, "-m", "venv", ENVIRONMENT) or _ran(*install, "--requirement", REQUIREMENTS):
            raise UserError(f"cannot install {REQUIREMENTS.relative_to(ROOT)}: is there a network?")
        write_whole(made, recipe)
    return python


def built(python: Path) -> bool:
    """Whether mkdocs has found no fault; each stands on stderr. (Its --quiet would let warnings pass.)"""
    words = [str(python), "-m", "mkdocs", "build", "--strict", "--config-file", str(CONFIG)]
    with_ = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(words, cwd=ROOT, check=False, capture_output=True, text=True, env=with_)
    if done.returncode:
        lines = (done.stdout + done.stderr).splitlines()
        print("\n".join(line for line in lines if not line.startswith("INFO")), file=sys.stderr)
    return done.returncode == 0


def prepare() -> int:
    """Stages the pages, the scripts and the configuration. Returns the number of pages. Errors: UserError."""
    names = stage(ROOT, PAGES)
    found = sorted(ENVIRONMENT.glob(MATHJAX))
    if not found:
        raise UserError(f"{ENVIRONMENT}: found no {MATHJAX}; allowed: the packages of {REQUIREMENTS}")
    (PAGES / "scripts").mkdir(exist_ok=True)
    shutil.copyfile(found[0], PAGES / "scripts/tex-svg.js")
    shutil.copyfile(WORKER, PAGES / "scripts/iframe-worker.js")
    write_whole(PAGES / "scripts/mathjax.js", CONFIGURATION)
    own = {
        "INHERIT": "../mkdocs.yml",
        "docs_dir": str(PAGES),
        "site_dir": str(SITE),
        "nav": navigation(names),
    }
    write_whole(CONFIG, json.dumps(own, indent=1))  # JSON is YAML
    return sum(name.endswith(".md") for name in names)


@reported("dev site")
def main(argv: list[str]) -> int:
    parser = parser_of("dev site", __doc__)
    parser.parse_args(argv)
    python = environment()
    pages = prepare()
    if not built(python):
        return 1
    print(f"{pages} pages: {SITE / 'index.html'}")
    return 0


# --- site pages


HOME = "README.md"
# Title -> folders of its pages, each with the folders below it.
SECTIONS = {
    "Theory": ("docs/theory",),
    "Guides": ("docs/guides",),
    "Reference": ("docs/reference",),
    "Results": ("docs/results", "results"),
}
OTHERS = "Project"  # title of what stands in none of them
PATTERNS = (HOME, "CHANGELOG.md", "CONTRIBUTING.md", "docs/**/*.md", "results/*.md")
LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)\s]*)?\)")
FENCE = re.compile(r"^\s*```")
ITEM = re.compile(r"^\s*(?:[-*]|\d+\.) ")


def targets(page: str, text: str) -> list[str]:
    """Files of the repository that a page links to, from its root."""
    links = [link for link in LINK.findall(text) if not re.match(r"[a-z]+:", link)]
    return [os.path.normpath(os.path.join(os.path.dirname(page), link)) for link in links]


def staged(root: Path) -> list[str]:
    """Pages of PATTERNS and every file that they, or pages they lead to, link to, from the root. Errors:
    UserError for a link to nothing, or to a folder.
    """
    todo = [path.relative_to(root).as_posix() for of in PATTERNS for path in sorted(root.glob(of))]
    found: dict[str, None] = {}
    while todo:
        name = todo.pop(0)
        if name in found:
            continue
        found[name] = None
        if name.endswith(".md"):
            linked = targets(name, input_file.read_text(root / name))
            if lost := [of for of in linked if not (root / of).is_file()]:
                raise UserError(f"{name}: found a link to {lost[0]}; allowed: a file of this repository")
            todo += linked
    return list(found)


def blank_before_lists(text: str) -> str:
    """The same page with an empty line before each list that follows a paragraph: GitHub needs none, and
    Python-Markdown does."""
    lines, fenced, in_item = [""], False, False
    for line in text.splitlines():
        if ITEM.match(line) and not fenced:
            if lines[-1].strip() and not in_item:
                lines.append("")
            in_item = True
        in_item &= bool(line.strip())
        fenced ^= bool(FENCE.match(line))
        lines.append(line)
    return "\n".join(lines[1:]) + "\n"


def stage(root: Path, folder: Path) -> list[str]:
    """Copies what the site needs to `folder`, which it empties. Returns the names. Errors: as `staged`."""
    names = staged(root)
    shutil.rmtree(folder, ignore_errors=True)
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        if name.endswith(".md"):
            write_whole(folder / name, blank_before_lists(input_file.read_text(root / name)))
        else:
            shutil.copyfile(root / name, folder / name)
    return names


def _tree(folder: str, pages: Iterable[str]) -> list:
    """Navigation of a folder: its index, its pages, and a section for each folder in it."""
    below = [page for page in pages if page.startswith(f"{folder}/")]
    here = sorted(page for page in below if page.count("/") == folder.count("/") + 1)
    index = [page for page in here if page.endswith("/index.md")]
    deeper = sorted({page.split("/")[folder.count("/") + 1] for page in below} - {Path(p).name for p in here})
    sections = [{name.capitalize(): _tree(f"{folder}/{name}", below)} for name in deeper]
    return [*index, *(page for page in here if page not in index), *sections]


def navigation(names: Iterable[str]) -> list:
    """Every page once, by SECTIONS; a section without pages is left out."""
    pages = [name for name in names if name.endswith(".md") and name != HOME]
    sections: dict[str, list] = {}
    for title, (first, *more) in SECTIONS.items():
        entries = [*_tree(first, pages), *({"Studies": _tree(of, pages)} for of in more)]
        sections |= {title: entries} if entries else {}
    folders = tuple(f"{folder}/" for of in SECTIONS.values() for folder in of)
    others = [page for page in pages if not page.startswith(folders)]
    sections |= {OTHERS: others} if others else {}
    return [{"Home": HOME}, *({title: entries} for title, entries in sections.items())]

"""Builds the web site of all pages, with search and formulas, in build/site. It needs no network to be read.
The first time packages of PyPI are installed in build/site-environment (analysis/requirements-site.txt).

Exit codes: 0 built, 1 mkdocs has found a broken link or another fault, 2 the packages cannot be installed, or
a page links to nothing.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError, tells
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.whole_file import write_whole
from barrierbench_analysis.program.arguments import parser_of

from .site_pages import navigation, stage

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


@tells("dev site")
def main(argv: list[str]) -> int:
    parser = parser_of("dev site", __doc__)
    parser.parse_args(argv)
    python = environment()
    pages = prepare()
    if not built(python):
        return 1
    print(f"{pages} pages: {SITE / 'index.html'}")
    return 0

"""Pages of documentation: links and anchors resolve, files that pages name are there, formulas survive Markdown, pages fit."""

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "analysis/src/barrierbench_analysis"
PATTERNS = ("README.md", "CONTRIBUTING.md", "docs/**/*.md", "examples/**/*.md", "results/*.md")
# Written from the lists of the program, of which no page is cut.
GENERATED = {f"docs/reference/{name}.md" for name in ("config", "record", "trace", "verbs", "eval")}
MOST_LINES, LONGEST_LINE = 300, 400
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
SOURCE_FILE = re.compile(r"`((?:[\w.-]+/)*[\w.-]+\.(?:hpp|cpp|inc|cu|py|cmake|in|sh))`")
ESCAPES = re.compile(r"\\[,;:!{}%_#*]|[})]_|\*")  # what Markdown takes for its own in a formula


def pages() -> list[str]:
    return sorted({path.relative_to(ROOT).as_posix() for pattern in PATTERNS for path in ROOT.glob(pattern)})


def is_ruled(page: str) -> bool:
    """Pages that are written by hand for readers of formulas and code: their length, lines and formulas are held."""
    return page == "docs/architecture.md" or (page.startswith(("docs/theory/", "docs/reference/")) and page not in GENERATED)


RULED = [page for page in pages() if is_ruled(page)]


def without_code(text: str) -> str:
    """The text with as many lines, its fences empty."""
    return re.sub(r"(?ms)^```.*?^```[ ]*$", lambda match: "\n" * match[0].count("\n"), text)


def slug(heading: str) -> str:
    """The anchor that GitHub makes of a heading."""
    kept = re.sub(r"[^\w\- ]", "", re.sub(r"\]\([^)]*\)", "", heading).strip().lower())
    return kept.replace(" ", "-")


def anchors(text: str) -> set[str]:
    found: list[str] = []
    for heading in re.findall(r"(?m)^#{1,6} +(.+)$", without_code(text)):
        name = slug(heading)
        found.append(f"{name}-{found.count(name)}" if name in found else name)
    return {*found, *re.findall(r'<a (?:id|name)="([^"]+)"', text)}


def links(text: str) -> Iterator[tuple[int, str]]:
    """Line and target of every link that is no address of the network."""
    for number, line in enumerate(without_code(text).splitlines(), 1):
        for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
            if not re.match(r"[a-z]+:", target):
                yield number, target


def link_faults(root: Path, page: str) -> list[str]:
    text, faults = (root / page).read_text(), []
    for number, target in links(text):
        name, _, anchor = target.partition("#")
        file = (root / page).parent / name if name else root / page
        if not file.exists():
            faults.append(f"{page}:{number}: found a link to {target}; allowed: a file of the repository")
        elif anchor and file.suffix == ".md" and anchor not in anchors(file.read_text()):
            faults.append(f"{page}:{number}: found the anchor {target}; allowed: {', '.join(sorted(anchors(file.read_text())))}")
    return faults


def formula_faults(text: str, page: str) -> list[str]:
    """`$$` alone on its line and closed, one line of formula between two of them, `$` in pairs, nothing that Markdown eats."""
    faults, lines, opened = [], without_code(text).splitlines(), 0
    for number, line in enumerate(lines, 1):
        plain = re.sub(r"`[^`]*`", "", line)
        if "$$" in plain:
            opened = 0 if opened else number
            if plain != "$$" or (opened and lines[number + 1 : number + 2] != ["$$"]):
                faults.append(f"{page}:{number}: found {line!r}; allowed: $$, a formula on one line, $$")
            continue
        if not opened and plain.count("$") % 2:
            faults.append(f"{page}:{number}: found an odd number of $; allowed: $formula$ on one line")
        for formula in [plain] if opened else re.findall(r"\$([^$]*)\$", plain):
            if formula != formula.strip() or (not opened and re.search(rf"\w\${re.escape(formula)}\$|\${re.escape(formula)}\$\w", plain)):
                faults.append(f"{page}:{number}: found ${formula}$; allowed: no space within the $, no letter beside them")
            bar = line.startswith("|") and "|" in formula
            if bar or (found := ESCAPES.search(formula)):
                faults.append(f"{page}:{number}: found {'|' if bar else found[0]} in {formula!r}, which Markdown takes for its own")
    return faults + ([f"{page}:{opened}: found $$ that is not closed"] if opened else [])


def size_faults(text: str, page: str) -> list[str]:
    lines = text.splitlines()
    long = [k for k, line in enumerate(lines, 1) if len(line) > LONGEST_LINE and not line.startswith("|")]
    return [f"{page}: found {len(lines)} lines; allowed: {MOST_LINES}"] * (len(lines) > MOST_LINES) + [
        f"{page}:{k}: found {len(lines[k - 1])} characters; allowed: {LONGEST_LINE}" for k in long
    ]


def test_every_link_and_anchor_leads_somewhere():
    counted = [len(list(links((ROOT / page).read_text()))) for page in pages()]
    assert len(counted) > 60 and sum(counted) > 150
    assert [fault for page in pages() for fault in link_faults(ROOT, page)] == []


@pytest.mark.parametrize("page", RULED)
def test_a_page_fits_and_its_formulas_survive_markdown(page):
    text = (ROOT / page).read_text()
    assert size_faults(text, page) + formula_faults(text, page) == []


def test_formulas_are_there():
    """Of the rule above: it had something to judge."""
    texts = [(ROOT / page).read_text() for page in RULED]
    assert len(texts) >= 18 and sum(text.count("\n$$\n") for text in texts) >= 100 and sum(text.count("$") for text in texts) > 800


def listed_files() -> list[str]:
    done = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip("this tree is no clone: git knows none of its files")
    return done.stdout.splitlines()


def test_source_files_that_a_page_names_are_there():
    """By their path from the root or the Python package, or by the end of a path."""
    listed = [f"/{line}" for line in listed_files()]
    named = [(page, name) for page in RULED for name in SOURCE_FILE.findall((ROOT / page).read_text())]
    assert len(named) > 200
    assert [(page, name) for page, name in named if not any(line.endswith(f"/{name}") for line in listed)] == []


GOOD = "# A page\n\nSee [here](#a-page) and [b](b.md#part-two).\n\n$$\nx\n$$\n\n| $a$ | $\\lvert b \\rvert$ |\n"


def test_the_rules_see_what_is_wrong(tmp_path):
    (tmp_path / "b.md").write_text("# B\n\n## Part two\n")
    (tmp_path / "a.md").write_text(GOOD)
    assert link_faults(tmp_path, "a.md") == [] and formula_faults(GOOD, "a.md") == [] and size_faults(GOOD, "a.md") == []
    for wrong, said in (("[x](none.md)", "a link to none.md"), ("[x](b.md#none)", "the anchor b.md#none"), ("[x](#none)", "the anchor #none")):
        (tmp_path / "a.md").write_text(GOOD + wrong)
        [fault] = link_faults(tmp_path, "a.md")
        assert said in fault and fault.startswith("a.md:10:")
    for wrong in ("$$\nx\n", "$$x$$\n", "a $x\n", "$a\\,b$\n", "$\\tilde{x}_n$\n", "$a*b$\n", "| $|b|$ |\n", "a $b $ c\n", "a$^b$\n", "$$\nx\ny\n$$\n"):
        assert formula_faults(GOOD + wrong, "a.md"), wrong
    assert size_faults("a\n" * 301, "a.md") and size_faults("a" * 401, "a.md") and not size_faults("|" + "a" * 500, "a.md")

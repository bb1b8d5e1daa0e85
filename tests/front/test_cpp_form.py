"""The C++ of the product: functions fit a screen."""

from pathlib import Path

import lizard

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("core", "barriers", "experiments", "python/src")
LONGEST = 60  # lines, from its name to its last brace
LONG = 40


def lengths() -> dict[str, int]:
    files = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*")) if path.suffix in (".cpp", ".hpp")]
    return {
        f"{path.relative_to(ROOT)}:{function.start_line} {function.name}": function.end_line - function.start_line + 1
        for path in files
        for function in lizard.analyze_file(str(path)).function_list
    }


def test_functions_fit_a_screen():
    found = lengths()
    assert len(found) > 5000
    assert not {name: lines for name, lines in found.items() if lines > LONGEST}
    long = {name: lines for name, lines in found.items() if lines > LONG}
    assert len(long) <= 5, long

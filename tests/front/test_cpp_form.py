"""The C++ of the product has functions that fit a screen; that of the tests makes temporary files in one way."""

import re
from pathlib import Path

import lizard

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("core", "barriers", "experiments", "python/src")
LONGEST = 60  # lines, from its name to its last brace
LONG = 40
TEMPORARY = re.compile(r"temp_directory_path|TempDir\(|mk[ds]temp|tmpfile|tmpnam|P_tmpdir|TMPDIR|/tmp\b")
FOLDER = "tests/temporary_folder.hpp"


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


def test_temporary_files_of_tests_lie_in_folders_of_one_class():
    kinds = (".cpp", ".hpp", ".cu", ".in")
    files = [path for path in sorted((ROOT / "tests").rglob("*")) if path.suffix in kinds]
    texts = {str(path.relative_to(ROOT)): path.read_text() for path in files}
    assert [name for name, text in texts.items() if TEMPORARY.search(text)] == [FOLDER]
    assert len(texts) > 400
    assert sum(f'#include "{FOLDER}"' in text for text in texts.values()) > 20

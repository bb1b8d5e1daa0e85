"""Files that a user names are opened in one place, io/input_file.py, which refuses what can be waited for or read for ever."""

import ast
import os
import socket
from pathlib import Path

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.input_file import opened, read_bytes, read_text

PACKAGE = Path(__file__).resolve().parents[2] / "analysis/src/barrierbench_analysis"
READERS = {"open", "read_text", "read_bytes", "load", "loadtxt", "genfromtxt", "fromfile", "memmap", "mmread", "mminfo", "read_csv", "parse", "ZipFile", "ElementTree"}
# What these open is no file that a user names, or is opened by the place above: file -> calls.
KNOWN = {
    "io/input_file.py": {"open", "read_bytes"},
    "program/trajectories/arrays.py": {"load"},  # of a file that was opened there
    "studies/device/gpu_evidence.py": {"open"},  # an archive, of a file that was opened there
    "io/matrix_market.py": {"mmread", "mminfo"}, "studies/engines/launch.py": {"load", "open"},  # of bytes that were read there; a log that is written
    "studies/gate/trend.py": {"open"}, "studies/engines/environment.py": {"open"}, "figures/frames_out/formats.py": {"open"}, "front/test.py": {"open"}, "program/building.py": {"open"},
    "tables/run.py": {"read_csv"},  # of a text that was read there
    "tables/archive.py": {"ZipFile", "open"},  # of a file that was opened there; files that it unpacks
    "studies/toolkit/toolkit_meshes.py": {"open"}, "figures/pictures/animation.py": {"open"}, "io/whole_file.py": {"open"},  # written
    "front/door.py": {"open"},  # /dev/null
    "program/formula/__main__.py": {"load"},  # of the standard input
}


def calls_in(path: Path) -> set[str]:
    """Names of the calls that open a file; those of input_file are none."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Call):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            of = node.func.value.id if isinstance(node.func, ast.Attribute) and isinstance(node.func.value, ast.Name) else ""
            imported = path.name != "input_file.py" and name in ("read_text", "read_bytes") and isinstance(node.func, ast.Name)
            if name in READERS and of not in ("input_file", "records", "os") and not imported and not (name == "load" and of in ("", "self", "analysis", "numbers")) and name != "parse" or (name == "parse" and of == "ElementTree"):
                found.add(name)
    return found


def test_no_other_place_opens_a_file():
    found = {str(path.relative_to(PACKAGE)): calls for path in sorted(PACKAGE.rglob("*.py")) if (calls := calls_in(path))}
    assert len(found) >= 5 and "io/input_file.py" in found
    assert {name: calls - KNOWN.get(name, set()) for name, calls in found.items() if calls - KNOWN.get(name, set())} == {}


def things(tmp_path: Path) -> dict:
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "folder").mkdir()
    here = Path.cwd()
    os.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as made:
        made.bind("socket")
    os.chdir(here)
    (tmp_path / "link").symlink_to("/dev/zero")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "large").write_bytes(b"12345")
    return {"fifo": "a FIFO", "folder": "a folder", "socket": "a socket", "link": "a character device", "loop": "Too many levels", "none": "No such file", "large": "5 bytes; at most 4 are read", "a\0b": "a zero byte"}


def test_only_regular_files_are_read_and_no_large_ones(tmp_path):
    for name, why in things(tmp_path).items():
        for read in (opened, read_bytes, read_text):
            with pytest.raises(UserError, match=why):
                read(f"{tmp_path}/{name}", 4)
    with pytest.raises(UserError, match="more than 4 bytes"):
        read_bytes("/proc/self/status", 4)  # its size is 0
    with pytest.raises(UserError, match="No such file or directory; a file that can be read is needed: make one"):
        read_bytes("", more=": make one")


def test_texts_are_utf_8_whatever_the_locale(tmp_path):
    (tmp_path / "a").write_bytes("\u00e4\r\nb\rc".encode() + b"\xff")
    assert read_text(tmp_path / "a") == "\u00e4\nb\nc\ufffd"

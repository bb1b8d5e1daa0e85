"""The PTX that an object file carries: found whole, refused otherwise."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[1] / "ptx" / "embedded_ptx.py"
spec = importlib.util.spec_from_file_location("embedded_ptx", SOURCE)
embedded = importlib.util.module_from_spec(spec)
spec.loader.exec_module(embedded)

PTX = ".version 9.0\n.target sm_80\n.address_size 64\n\n.visible .entry k()\n{\nret;\n}\n"


def test_the_module_is_cut_out_of_the_object():
    data = b"\x7fELF .version text\0" + PTX.encode() + b"\0\0\x01more"
    assert embedded.embedded_ptx(data) == PTX


@pytest.mark.parametrize(
    "data, words",
    [
        (b"\x7fELF\0compressed", "0 PTX modules"),
        ((PTX + "\0" + PTX).encode(), "2 PTX modules"),
        (PTX[:-4].encode() + b"\0", "cut short"),
        (PTX.replace(".entry", ".func").encode() + b"\0", "no kernel"),
    ],
)
def test_anything_else_is_refused(data, words):
    with pytest.raises(ValueError, match=words):
        embedded.embedded_ptx(data)

"""sha256 in hexadecimal digits. Imports nothing but the standard library."""

from __future__ import annotations

import hashlib
from pathlib import Path

BLOCK = 1 << 20  # bytes that are in memory at once


def of_file(path: Path) -> str:
    """Of the bytes of a file. Errors: OSError. Cost: of the size."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(BLOCK):
            digest.update(block)
    return digest.hexdigest()


def of_text(text: str) -> str:
    """Of a text in UTF-8."""
    return hashlib.sha256(text.encode()).hexdigest()

"""sha256 in hexadecimal digits. Imports nothing but the standard library."""

import hashlib
from pathlib import Path

from .input_file import opened

ANY_SIZE = 1 << 62
BLOCK = 1 << 20  # bytes that are in memory at once


def of_file(path: Path) -> str:
    """Of the bytes of a file. Errors: UserError. Cost: of the size."""
    digest = hashlib.sha256()
    with opened(path, ANY_SIZE) as file:
        while block := file.read(BLOCK):
            digest.update(block)
    return digest.hexdigest()


def of_text(text: str) -> str:
    """Of a text in UTF-8."""
    return hashlib.sha256(text.encode()).hexdigest()

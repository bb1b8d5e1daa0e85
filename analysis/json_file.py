"""JSON from files."""

from __future__ import annotations

import json
from pathlib import Path

from .errors import UserError


def read_json(path: Path, remedy: str = "") -> object:
    """What a file holds. remedy: behind what is said of a file that cannot be read. Errors: UserError."""
    try:
        return json.loads(path.read_bytes())
    except OSError as fault:
        raise UserError(f"{path}: {fault.strerror}{remedy}") from None
    except ValueError as fault:
        raise UserError(f"{path}: not JSON: {fault}") from None


def read_object(path: Path) -> dict:
    """A JSON object from a file. Errors: UserError, which says what the file is instead."""
    data = read_json(path)
    if not isinstance(data, dict):
        raise UserError(f"{path}: not a JSON object")
    return data

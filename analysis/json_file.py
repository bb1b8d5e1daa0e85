"""JSON objects from files."""

from __future__ import annotations

import json
from pathlib import Path

from .errors import UserError


def read_object(path: Path) -> dict:
    """A JSON object from a file. Errors: UserError, which says what the file is instead."""
    try:
        data = json.loads(path.read_text())
    except OSError as fault:
        raise UserError(f"{path}: {fault.strerror}") from None
    except ValueError as fault:
        raise UserError(f"{path}: not JSON: {fault}") from None
    if not isinstance(data, dict):
        raise UserError(f"{path}: not a JSON object")
    return data

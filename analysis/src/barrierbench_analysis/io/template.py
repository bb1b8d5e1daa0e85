"""Templates of pages (Jinja), filled with values."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, StrictUndefined
from jinja2.exceptions import TemplateError

from . import input_file
from .errors import UserError


def filled(path: Path, values: dict) -> str:
    """The text; nothing is escaped. Errors: UserError for a template that needs what is not among the
    values, or cannot be read.
    """
    environment = Environment(undefined=StrictUndefined, keep_trailing_newline=True, autoescape=False)
    try:
        return environment.from_string(input_file.read_text(path)).render(values)
    except TemplateError as fault:
        raise UserError(f"{path}: {fault}; allowed: {', '.join(sorted(values))}") from None

"""Templates of pages (Jinja), filled with values."""

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from jinja2.exceptions import TemplateError

from . import input_file
from .errors import UserError

HERE = Path(__file__).resolve().parent


def filled(path: Path, values: dict) -> str:
    """The text. Values are escaped in HTML, whose templates may extend web.html and import its macro `table`
    (caption, head, rows). Errors: UserError for a template that needs what is not among the values, or cannot
    be read.
    """
    environment = Environment(
        loader=FileSystemLoader(HERE),
        undefined=StrictUndefined,
        keep_trailing_newline=True,
        autoescape=path.suffix == ".html",
    )
    try:
        return environment.from_string(input_file.read_text(path)).render(values)
    except TemplateError as fault:
        raise UserError(f"{path}: {fault}; allowed: {', '.join(sorted(values))}") from None

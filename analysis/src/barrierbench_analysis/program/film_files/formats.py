"""The formats of films in one file: extension and reader."""

from collections.abc import Callable
from pathlib import Path

from .alembic import of_alembic
from .film import FilmFile, readable
from .usd import of_usd
from .vtkhdf import of_vtkhdf

FILMS: dict[str, Callable[[Path], FilmFile]] = {
    **dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), of_usd),
    ".abc": of_alembic,
    **dict.fromkeys((".vtkhdf", ".hdf"), of_vtkhdf),
}


def opened_film(path: Path) -> FilmFile:
    """Errors: UserError: no such file, of another format, broken, without a body, or no package for it."""
    with readable(str(path)):
        return FILMS[path.suffix.lower()](path)

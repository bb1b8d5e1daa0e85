"""Pages of one HTML file that need no network: templates in the frame web.html, and figures in them."""

from __future__ import annotations

import base64
import io
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from .style import plt

HERE = Path(__file__).resolve().parent


def filled(template: Path, **values) -> str:
    """A template, which may extend web.html and import its macro `table` (caption, head, rows)."""
    loader = FileSystemLoader([template.parent, HERE])
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, keep_trailing_newline=True
    )
    return environment.get_template(template.name).render(values)


def png(figure: plt.Figure, dpi: int) -> str:
    """A figure as PNG in base64; it is closed."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=dpi)
    plt.close(figure)
    return base64.b64encode(out.getvalue()).decode()

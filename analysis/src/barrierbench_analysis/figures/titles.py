"""Titles of pictures, broken where they would be wider than what they stand above."""

from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties


def _pieces(word: str, fits) -> list[str]:
    """A word that is wider than a line, in parts that are not."""
    parts = []
    while word and not fits(word):
        end = next((n for n in range(len(word) - 1, 1, -1) if fits(word[:n])), 1)
        parts.append(word[:end])
        word = word[end:]
    return [*parts, word] if word else parts


def broken(fig: Figure, text: str, width_in: float, size: float) -> str:
    """The text with line ends, so that no line in this font size is wider than width_in inches."""
    measure = fig.canvas.get_renderer().get_text_width_height_descent
    font = FontProperties(size=size)

    def fits(line: str) -> bool:
        return measure(line, font, False)[0] <= width_in * fig.dpi

    lines: list[str] = []
    for paragraph in text.split("\n"):
        lines.append("")
        for word in (part for whole in paragraph.split() for part in _pieces(whole, fits)):
            longer = f"{lines[-1]} {word}".strip()
            if fits(longer):
                lines[-1] = longer
            else:
                lines.append(word)
    return "\n".join(lines)

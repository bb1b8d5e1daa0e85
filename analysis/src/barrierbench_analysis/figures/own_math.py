"""Mathematics in figures is ours alone: a name that a user gave, `$x` or `a$b^c^d$`, is drawn as it is.
matplotlib would parse whatever stands between two dollars, and end a figure where it cannot.
"""

import re

from matplotlib.text import Text

# Between two dollars, in the texts of this package, and in the labels of ticks.
SEGMENTS = frozenset(
    r"\hat d; \hat{d}; \mu; ^2; b/\hat d^2; -b'/\hat d; b''; \rho=\hat d\,b''/|b'|; u=d/\hat d;"
    r" |\Delta x|_\infty; \kappa; \kappa = m/; \lambda_{\max}; \lambda_{\min}".split("; ")
)
OF_TICKS = re.compile(r"(?=.)(\\mathdefault\{)?[-\u2212+\d.e]*(\\times)?(10\^\{[-\u2212\d.]+\})?\}?")
_preprocessed = Text._preprocess_math  # what of a text is mathematics, whoever draws it


def is_ours(text: str) -> bool:
    """Whether all that stands between dollars is a text of this package."""
    return all(part in SEGMENTS or OF_TICKS.fullmatch(part) for part in text.split("$")[1::2])


def _of_ours(self: Text, text: str) -> tuple[str, bool]:
    return _preprocessed(self, text) if is_ours(text) else (text, False)


def install() -> None:
    """For every text that is drawn from here on."""
    Text._preprocess_math = _of_ours

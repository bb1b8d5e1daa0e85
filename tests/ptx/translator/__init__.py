"""PTX to C++: words, source, operands, arithmetic, memory, body, module, each on top of those before."""

from .module import Module
from .source import Function, split_arguments, statements
from .words import Unknown

__all__ = ["Function", "Module", "Unknown", "split_arguments", "statements", "translate"]


def translate(text: str, name: str, with_faults: bool = False) -> str:
    """C++ of the PTX; name: what messages call it. Errors: Unknown."""
    module = Module(text, name, with_faults)
    module.translate()
    return module.cpp()

"""Hashes of code and of values that a registration fixes."""

import ast
import inspect
import json
import textwrap
from collections.abc import Callable
from types import ModuleType

from .digests import of_text

DIGITS = 16


def sha_of(value: object) -> str:
    """Of a value as JSON, whose keys are sorted."""
    return of_text(json.dumps(value, sort_keys=True, separators=(",", ":")))


def bare(code: Callable | ModuleType) -> str:
    """Source of a function or module without comments and docstrings."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(code)))
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.FunctionDef)) and ast.get_docstring(node):
            node.body = node.body[1:] or [ast.Pass()]
    return ast.unparse(tree)


def code_of(module: ModuleType) -> str:
    """Hash of a module's code without comments and docstrings."""
    return sha_of(bare(module))[:DIGITS]

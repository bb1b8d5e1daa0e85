"""Where things are in the tree. Imports nothing but the standard library."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
SCHEMAS = ROOT / "configs/schema"
METHODS = ROOT / "configs" / "methods"

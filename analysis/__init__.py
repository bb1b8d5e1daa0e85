"""Records to tidy tables to figures and pictures."""

from .load import RecordError, Records, load

__all__ = ["RecordError", "Records", "load"]

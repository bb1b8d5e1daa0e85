"""Records to tidy tables to figures and pictures: `load`, `Records` and `RecordError` of records.py, read
when they are first asked for.
"""

__all__ = ["RecordError", "Records", "load"]


def __getattr__(name: str):
    """The front door of ./bench starts without numpy and pandas, so that nothing is imported here."""
    if name in __all__:
        from . import records

        return getattr(records, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

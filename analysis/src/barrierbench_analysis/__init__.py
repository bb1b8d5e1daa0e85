"""Records to tidy tables to figures and pictures: `load`, `Records` and `RecordError` of records.py, and
`Run`, one run with its trace, frames and matrices, of run.py. Each is read when it is first asked for.
"""

__all__ = ["RecordError", "Records", "Run", "load"]


def __getattr__(name: str):
    """The front door of ./bench starts without numpy and pandas, so that nothing is imported here."""
    if name == "Run":
        from barrierbench_analysis.tables import run

        return run.Run
    if name in __all__:
        from barrierbench_analysis.tables import records

        return getattr(records, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

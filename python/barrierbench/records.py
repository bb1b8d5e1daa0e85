"""Records as tables, and what judges them: functions of the package barrierbench-analysis (pip install -e analysis)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from barrierbench_analysis.tables.records import Records
    from barrierbench_analysis.tables.run import Run


def _missing(error: ImportError) -> ImportError:
    return ImportError(
        f"barrierbench.records needs the package in analysis/ of the source tree: pip install -e analysis ({error})"
    )


def load_run(folder: str | os.PathLike) -> Run:
    """The run of a folder: record, steps and trace as pandas tables, frames as arrays. Errors: RecordError."""
    try:
        from barrierbench_analysis.tables.run import Run
    except ImportError as error:
        raise _missing(error) from None
    return Run(Path(folder))


def load(folder: str | os.PathLike) -> Records:
    """All records below a folder as tidy tables: runs, steps, trace, cond."""
    try:
        from barrierbench_analysis.tables.records import load as load_records
    except ImportError as error:
        raise _missing(error) from None
    return load_records(folder)


def judge(trajectory: str | os.PathLike, about: str | os.PathLike | None = None, **options: Any) -> dict[str, Any]:
    """`bench judge`: the frames of any program before the exact audit; the record that it makes, nothing is written.

    trajectory: a folder of numbered OBJ, PLY or VTU frames, .pvd, .pc2, .npz, or a run. options: topology, reference,
    scale, reach, states_only, as the verb has them. Needs the built program (BARRIERBENCH_PROGRAM or ./bench build).
    Errors: UserError of analysis where it cannot be judged.
    """
    try:
        from barrierbench_analysis.studies.judge import verb
    except ImportError as error:
        raise _missing(error) from None
    words = [str(trajectory), *(["--about", str(about)] if about is not None else [])]
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        words += ([flag] if value else []) if isinstance(value, bool) else [flag, str(value)]
    return verb.judged(verb.parse(words))


def claims(*ids: str) -> int:
    """`bench study claims`: runs what is missing and judges claims; the exit code. All of them: hours."""
    try:
        from barrierbench_analysis.pages.claims import verb
    except ImportError as error:
        raise _missing(error) from None
    return verb.main(list(ids))

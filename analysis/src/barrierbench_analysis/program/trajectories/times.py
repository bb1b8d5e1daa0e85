"""Times of frames, from whatever file."""

from collections.abc import Callable, Sequence

import numpy as np

from barrierbench_analysis.io.errors import UserError


def increasing(times_s: Sequence[float], place: Callable[[int], str]) -> list[float]:
    """The times. place: file and place of the k-th. Errors: UserError for the first that is not finite or not
    above the one before.
    """
    times = [float(t) for t in times_s]
    for k, t in enumerate(times):
        if not np.isfinite(t):
            raise UserError(f"{place(k)}: found the time {t}; a finite number is needed")
        if k and t <= times[k - 1]:
            raise UserError(
                f"{place(k)}: found the time {t!r} s after {times[k - 1]!r} s; a later one is needed"
            )
    return times

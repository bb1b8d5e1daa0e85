"""The one kind of error that a user sees: what is wrong, where, what was found and what is allowed.
Everything else is a mistake of this code.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable

BAD_INPUT = 2
BUILD_FAILED = 70
TRY_AGAIN = 75  # as the program has it: an interrupt among others


class UserError(ValueError):
    """Bad input, or something that is not there. Its text is shown without a traceback, and the command ends
    with `code`.
    """

    def __init__(self, text: str, code: int = BAD_INPUT):
        super().__init__(text)
        self.code = code


def tells(verb: str) -> Callable:
    """For `main(argv)` of a verb: an error for the user, or of a file, is said on stderr, and its code is the
    exit code.
    """

    def around(main: Callable[[list[str]], int]) -> Callable[[list[str]], int]:
        @functools.wraps(main)
        def guarded(argv: list[str]) -> int:
            try:
                return main(argv)
            except BrokenPipeError:
                raise  # nobody reads: no error of the input
            except (UserError, OSError) as error:
                print(f"bench {verb}: {error}", file=sys.stderr)
                return getattr(error, "code", BAD_INPUT)

        return guarded

    return around

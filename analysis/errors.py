"""The one kind of error that a user sees: what is wrong, where, what was found and what is allowed.
Everything else is a mistake of this code.
"""

from __future__ import annotations

import errno
import functools
import sys
import tempfile
from collections.abc import Callable

BAD_INPUT = 2
BUILD_FAILED = 70
TRY_AGAIN = 75  # as the program has it: an interrupt among others
# What another call will meet too; the list of the program (lasts() in core/record/atomic_write.cpp).
LASTING = {
    getattr(errno, name)
    for name in "EACCES EPERM EROFS ENOENT ENOTDIR EISDIR EEXIST ELOOP ENAMETOOLONG EINVAL".split()
}


class UserError(ValueError):
    """Bad input, or something that is not there. Its text is shown without a traceback, and the command ends
    with `code`.
    """

    def __init__(self, text: str, code: int = BAD_INPUT):
        super().__init__(text)
        self.code = code


def code_of(error: UserError | OSError) -> int:
    """The exit code: a full disk, a file too many and their like may be over when it is called again."""
    if isinstance(error, UserError):
        return error.code
    return BAD_INPUT if error.errno is None or error.errno in LASTING else TRY_AGAIN


def text_of(error: UserError | OSError) -> str:
    """What is said: of a file its name and what the system said."""
    if isinstance(error, UserError) or error.errno is None:
        return str(error)
    unnamed = f"a temporary file ({tempfile.gettempdir()}) or a stream"
    return f"{error.filename or unnamed}: {error.strerror}"


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
                print(f"bench {verb}: {text_of(error)}", file=sys.stderr)
                return code_of(error)

        return guarded

    return around

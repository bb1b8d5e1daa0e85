"""The one kind of error that a user sees: what is wrong, where, what was found and what is allowed.
Everything else is a mistake of this code.
"""

import errno
import functools
import os
import sys
import tempfile
from collections.abc import Callable

BAD_INPUT = 2
BUILD_FAILED = 70
TRY_AGAIN = 75  # as the program has it: an interrupt among others
# What another call will meet too; the list of the program (lasts() in core/base/record/atomic_write.cpp).
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


def _temporary() -> str:
    """The folder of temporary files, or that which the user names for it where none can be written to."""
    try:
        return tempfile.gettempdir()
    except OSError:
        return os.environ.get("TMPDIR", "/tmp")


def _cause(error: OSError) -> OSError:
    """Of what tempfile says where it finds no folder, which has no file and the same number for each cause:
    what a file in the folder of temporary files meets.
    """
    if error.errno != errno.ENOENT or error.filename:
        return error
    try:
        with tempfile.TemporaryFile(dir=_temporary()) as probe:
            probe.write(b"a byte")
    except OSError as cause:
        return OSError(cause.errno, cause.strerror, f"a temporary file ({_temporary()})")
    return error


def code_of(error: UserError | OSError) -> int:
    """The exit code: a full disk, a file too many and their like may be over when it is called again."""
    if isinstance(error, UserError):
        return error.code
    number = _cause(error).errno
    return BAD_INPUT if number is None or number in LASTING else TRY_AGAIN


def passed_on(code: int) -> int:
    """The exit code of a verb whose program has failed: what may be tried again stays so."""
    return TRY_AGAIN if code == TRY_AGAIN else BAD_INPUT


def text_of(error: UserError | OSError) -> str:
    """The message: of a file its name and the message of the system."""
    if isinstance(error, UserError) or error.errno is None:
        return str(error)
    error = _cause(error)
    return f"{error.filename or f'a temporary file ({_temporary()}) or a stream'}: {error.strerror}"


def reported(verb: str) -> Callable:
    """For `main(argv)` of a verb: an error of the user, or of a file, is printed on stderr; its code is the
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

"""The one place that opens a file which a user names, as core/base/input/read_file.hpp is in the program.
Only a regular file is opened, since a FIFO or a device can be waited for, or read, for ever, and none that
is larger than its kind.
"""

import os
import stat
from pathlib import Path
from typing import BinaryIO

from .errors import UserError

MIB = 1 << 20
SMALL = 16 * MIB  # a spec, a page, a log, a list
TABLE = 256 * MIB  # a record, a trace, a frame
LARGE = 1024 * MIB  # a mesh, a matrix, a film
TRAJECTORY = 64 * LARGE  # positions of all frames in one file, of an engine or for the judge

_TYPES = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a FIFO"),
    (stat.S_ISCHR, "a character device"),
    (stat.S_ISBLK, "a block device"),
    (stat.S_ISSOCK, "a socket"),
)


def _refuse(path: str | os.PathLike, found: str, more: str) -> UserError:
    return UserError(f"{path}: {found}; a file that can be read is needed{more}")


def below(root: Path, name: str) -> list[Path]:
    """The files of this name in a folder and those within it, by their paths; links to folders are not
    followed. Errors: UserError for a folder that cannot be listed: what it holds would be missed in silence.
    """

    def unreadable(fault: OSError) -> None:
        raise UserError(
            f"{fault.filename}: {fault.strerror}; a folder that can be listed is needed, since there may be a"
            f" {name} in it"
        )

    found = os.walk(root, onerror=unreadable)
    return sorted(Path(folder) / name for folder, _, files in found if name in files)


def opened(path: str | os.PathLike, most: int = LARGE, more: str = "") -> BinaryIO:
    """The bytes of a regular file of at most `most` bytes, to be closed by the caller. more: end of the
    message about a file that cannot be read. Errors: UserError: no path, not there, no regular file, no
    rights, too large.
    """
    if "\0" in os.fsdecode(path):
        raise _refuse(repr(os.fsdecode(path)), "a zero byte in a path", more)
    try:
        mode = os.stat(path).st_mode  # before it is opened: that alone may have an effect on a device
        if stat.S_ISREG(mode):
            file = open(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY), "rb")
            size = os.fstat(file.fileno()).st_size
    except OSError as fault:
        raise _refuse(path, fault.strerror or str(fault), more) from None
    if not stat.S_ISREG(mode):
        raise _refuse(path, next((word for is_it, word in _TYPES if is_it(mode)), "no regular file"), more)
    if size > most:
        file.close()
        raise UserError(f"{path}: {size} bytes; at most {most} are read{more}")
    return file


def read_bytes(path: str | os.PathLike, most: int = TABLE, more: str = "") -> bytes:
    """What a file holds. Errors: UserError, as `opened`."""
    with opened(path, most, more) as file:
        try:
            found = file.read(most + 1)
        except OSError as fault:
            raise _refuse(path, fault.strerror, more) from None
    if len(found) > most:  # files of /proc have no size
        raise UserError(f"{path}: more than {most} bytes; at most {most} are read{more}")
    return found


def read_text(path: str | os.PathLike, most: int = TABLE, more: str = "") -> str:
    """Of UTF-8; what is none is replaced by U+FFFD. Line ends are "\\n". Errors: UserError, as `opened`."""
    text = read_bytes(path, most, more).decode("utf-8", errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")

"""Files that are whole or not there."""

import contextlib
import fcntl
import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO

from . import input_file
from .errors import UserError, code_of


@contextlib.contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A name beside the file, for what is written; it takes the place of the file at the end: a full disk or
    an interrupt leaves what was there. Makes the folder. An error of the system names the file: it names none
    where a disk is full.
    """
    part = path.with_name(f"{path.name}.tmp.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield part
        part.replace(path)
    except OSError as error:
        if error.filename in (None, str(part)):
            error.filename, error.filename2 = str(path), None
        raise
    finally:
        part.unlink(missing_ok=True)


@contextlib.contextmanager
def alone(path: Path) -> Iterator[None]:
    """Waits until no other process is between reading a file and writing it again (flock of a file beside
    it, which stays)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.with_name(f".{path.name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def write_whole(path: Path, text: str) -> None:
    """A text as such a file."""
    write_whole_bytes(path, text.encode())


def write_whole_bytes(path: Path, content: bytes) -> None:
    """Bytes as such a file."""
    with whole(path) as part:
        part.write_bytes(content)


def copy_whole(source: Path, path: Path) -> None:
    """A file as such a file. Errors of the source: UserError."""
    write_whole_bytes(path, input_file.read_bytes(source, input_file.LARGE))


def write_figure(figure, path: Path, **options) -> None:
    """A figure of matplotlib in the format of the ending; options of savefig."""
    write_whole_bytes(path, bytes_of(lambda out: figure.savefig(out, format=path.suffix[1:], **options)))


def bytes_of(write: Callable[[BinaryIO], object]) -> bytes:
    """What `write` writes into an open file."""
    out = io.BytesIO()
    write(out)
    return out.getvalue()


def append_line(path: Path, text: str) -> None:
    """One line more, or none where the disk is full. Makes the folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    content = f"{text}\n".encode()
    with path.open("ab", buffering=0) as out:
        before = os.fstat(out.fileno()).st_size
        try:
            while content:
                content = content[out.write(content) :]
        except OSError as error:
            out.truncate(before)
            error.filename = str(path)
            raise


def check_can_be_written(path: Path) -> None:
    """Before long work whose result goes there: makes the folder, writes into it, and takes that back.
    Errors: UserError that names what is in the way.
    """
    check_folder(path.parent)
    if path.is_dir():
        raise UserError(f"{path}: is a folder; a file, or nothing, is needed there")


def check_folder(folder: Path) -> None:
    """The same of a folder for several files."""
    part = folder / f".written.tmp.{os.getpid()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        try:
            part.write_bytes(b"a byte")
        finally:
            part.unlink(missing_ok=True)
    except OSError as fault:
        raise UserError(
            f"{folder}: {fault.strerror}; a folder that can be written to is needed", code_of(fault)
        ) from None

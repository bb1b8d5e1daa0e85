"""Files that are whole or not there."""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Iterator
from pathlib import Path

from .errors import UserError


@contextlib.contextmanager
def named(path: Path) -> Iterator[None]:
    """An error inside of it that names no file gets this one: the system names none where a disk is full."""
    try:
        yield
    except OSError as error:
        error.filename = error.filename or str(path)
        raise


def write_whole(path: Path, text: str) -> None:
    """write_whole_bytes of a text."""
    write_whole_bytes(path, text.encode())


def check_can_be_written(path: Path) -> None:
    """Before long work whose result goes there: makes the folder, writes into it, and takes that back.
    Errors: UserError that names what is in the way.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(f"{path.name}.tmp.{os.getpid()}")
        part.write_bytes(b"")
        part.unlink()
    except OSError as fault:
        raise UserError(
            f"{path.parent}: {fault.strerror}; a folder that can be written to is needed"
        ) from None
    if path.is_dir():
        raise UserError(f"{path}: is a folder; a file, or nothing, is needed there")


def write_whole_bytes(path: Path, content: bytes) -> None:
    """Writes beside the file and puts that in its place: a full disk or an interrupt leaves what was there.
    Makes the folder.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.tmp.{os.getpid()}")
    try:
        with named(path):
            part.write_bytes(content)
            part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_figure(figure, path: Path, **options) -> None:
    """A figure of matplotlib in the format of the ending; options of savefig."""
    out = io.BytesIO()
    figure.savefig(out, format=path.suffix[1:], **options)
    write_whole_bytes(path, out.getvalue())

"""A study as one file: a ZIP archive of all files below a folder, and archive.json in it, which has the
version of this form and size and sha256 of every file. `study` is how verbs take one in the place of the
folder: it is unpacked, held against archive.json and read as every folder is.
"""

import contextlib
import hashlib
import json
import lzma
import os
import shutil
import tempfile
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.cases import RUNNING, Case, sighted
from barrierbench_analysis.io.digests import BLOCK, of_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.whole_file import whole

SCHEMA = "barrierbench.archive/1"
MANIFEST = "archive.json"
LOCK = "bench.lock"  # of a folder that a run is in
# What reading an entry raises: damaged, cut short, encrypted (RuntimeError), packed in a way that Python
# does not know (NotImplementedError, which is one).
UNREADABLE = (zipfile.BadZipFile, EOFError, zlib.error, lzma.LZMAError, RuntimeError)
EARLIEST = (1980, 1, 1, 0, 0, 0)  # that a ZIP archive can say: the same files make the same archive


def _require_over(folder: Path) -> None:
    """Errors: UserError where a run or a sweep is at work: what it has written so far is no study."""
    holder = sighted(Case(0, folder, "", "", {}))
    if holder.state == RUNNING:
        raise UserError(
            f"{folder}: found {holder.detail}, at work in it; allowed: a folder that no run is in"
        )


def files_of(folder: Path) -> list[Path]:
    """All files below a folder but locks and archive.json of an archive that was unpacked there, by their
    paths. Errors: UserError: no folder, no record in it, a run at work in it.
    """
    if not folder.is_dir():
        raise UserError(
            f"{folder}: no such folder; the folder of a study, with records (run.json), is needed"
        )
    found = sorted(Path(place) / name for place, _, names in os.walk(folder) for name in names)
    for lock in (path for path in found if path.name == LOCK):
        _require_over(lock.parent)
    if not any(path.name == "run.json" for path in found):
        raise UserError(f"{folder}: no run.json below this folder; the folder of a study is needed")
    return [path for path in found if path.name != LOCK and path != folder / MANIFEST]


def _add(archive: zipfile.ZipFile, path: Path, name: str) -> dict:
    """One file; its line of archive.json."""
    info = zipfile.ZipInfo(name, EARLIEST)
    info.compress_type, info.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
    digest, size = hashlib.sha256(), 0
    with input_file.opened(path, input_file.TRAJECTORY) as source:
        with archive.open(info, "w", force_zip64=True) as out:
            while block := source.read(BLOCK):
                digest.update(block)
                size += len(block)
                out.write(block)
    return {"path": name, "bytes": size, "sha256": digest.hexdigest()}


def packed(folder: Path, out: Path) -> list[dict]:
    """Writes the archive, whole or not at all; the lines of its archive.json. Errors: UserError, OSError."""
    files = [path for path in files_of(folder) if path.resolve() != out.resolve()]
    with whole(out) as part, zipfile.ZipFile(part, "w") as archive:
        lines = [_add(archive, path, path.relative_to(folder).as_posix()) for path in files]
        rows = ",\n  ".join(map(json.dumps, lines))
        text = f'{{\n "schema": "{SCHEMA}",\n "files": [\n  {rows}\n ]\n}}\n'
        archive.writestr(zipfile.ZipInfo(MANIFEST, EARLIEST), text, zipfile.ZIP_DEFLATED)
    return lines


def is_archive(path: Path) -> bool:
    """Whether it is a file that begins and ends as a ZIP archive does."""
    return path.is_file() and zipfile.is_zipfile(path)


def _refused(path: Path, found: str) -> UserError:
    return UserError(
        f"{path}: {found}; allowed: an archive of ./bench data archive ({SCHEMA}), as it was written"
    )


def _stays_inside(name: str) -> bool:
    parts = PurePosixPath(name).parts
    return bool(parts) and not name.startswith("/") and ".." not in parts and "\\" not in name


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[zipfile.ZipFile]:
    """To be read."""
    with input_file.opened(path, input_file.TRAJECTORY) as file:
        try:
            archive = zipfile.ZipFile(file)
        except UNREADABLE as error:
            raise _refused(path, f"a ZIP archive that cannot be read ({error})") from None
        with archive:
            yield archive


def _line_fault(line: object) -> str:
    """What is wrong with a line of archive.json; empty: nothing."""
    for key, kind in (("path", str), ("bytes", int), ("sha256", str)):
        if not isinstance(line, dict) or not isinstance(line.get(key), kind):
            return f"{MANIFEST}#/files: found {json.dumps(line)[:100]}, without {key!r}"
    return ""


def manifest(archive: zipfile.ZipFile, path: Path) -> list[dict]:
    """The lines of archive.json. Errors: UserError: none there, another version, a line without what it has
    to say, names that the archive does not have or does not say, names that lead out of the folder.
    """
    try:
        data = json.loads(archive.read(MANIFEST))
        version, lines = data.get("schema"), list(data.get("files"))
    except (KeyError, ValueError, TypeError, AttributeError, *UNREADABLE):
        raise _refused(path, f"no {MANIFEST} in it that can be read") from None
    if version != SCHEMA:
        raise _refused(path, f"{MANIFEST}#/schema: found {version!r}")
    if fault := next(filter(None, map(_line_fault, lines)), ""):
        raise _refused(path, fault)
    names = [line["path"] for line in lines]
    held = sorted(name for name in archive.namelist() if name != MANIFEST)
    twice = [name for of in (Counter(held), Counter(names)) for name, count in of.items() if count > 1]
    if unlike := sorted(set(held) ^ set(names)) or twice:
        raise _refused(path, f"{MANIFEST} and what is in it differ in {unlike[0]!r}")
    if outside := [name for name in names if not _stays_inside(name)]:
        raise _refused(path, f"the name {outside[0]!r}, which leads out of the folder")
    return lines


def _unpack(archive: zipfile.ZipFile, line: dict, path: Path, folder: Path) -> None:
    """One file, held against its line."""
    out, size = folder / line["path"], archive.getinfo(line["path"]).file_size
    if size != line["bytes"]:
        raise _refused(path, f"{line['path']} of {size} bytes, {line['bytes']} in {MANIFEST}")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(line["path"]) as source, out.open("wb") as target:
            shutil.copyfileobj(source, target, BLOCK)
    except (OSError, *UNREADABLE) as error:
        raise _refused(path, f"{line['path']} cannot be read ({error})") from None
    if (found := of_file(out)) != line["sha256"]:
        raise _refused(path, f"{line['path']} with sha256 {found[:16]}, {line['sha256'][:16]} in {MANIFEST}")


def read_manifest(path: Path) -> list[dict]:
    """As `manifest`, of a file. Errors: UserError."""
    if not is_archive(path):
        raise _refused(path, "no ZIP archive")
    with _opened(path) as archive:
        return manifest(archive, path)


@contextlib.contextmanager
def study(*paths: Path) -> Iterator[list[Path]]:
    """The folders of studies: of an archive one that it is unpacked into, which is gone afterwards; any other
    path as it is. Errors: UserError for an archive of another version or one that is damaged.
    """
    with contextlib.ExitStack() as stack:
        folders = []
        for path in paths:
            if not is_archive(path):
                folders.append(path)
                continue
            scratch = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="barrierbench-study-")))
            folder = scratch / (path.stem or path.name)
            folder.mkdir()
            with _opened(path) as archive:
                for line in manifest(archive, path):
                    _unpack(archive, line, path, folder)
            folders.append(folder)
        yield folders


def beside(path: Path, name: str) -> Path:
    """Where a page of a study goes: into its folder; of an archive beside it, with its name before."""
    return path.with_name(f"{path.stem}.{name}") if is_archive(path) else path / name

"""What a Python process reads and writes outside the clone and the folders of its test.

It is told to a file, a line each, which every Python process of a test adds to. Python has no event for a question whether a file is
there; the functions that ask are wrapped.
"""

import os
import sys

TOLD = "BARRIERBENCH_TESTS_OUTSIDE"  # the variable with the path of that file
FOLDERS = "BARRIERBENCH_TESTS_FOLDERS"  # the variable with the folders of the tests
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SYSTEM = ("/usr", "/lib", "/lib64", "/bin", "/sbin", "/etc", "/proc", "/sys", "/dev", "/run", "/var/lib/dpkg", "/opt/cuda")
NOWHERE = ("/nowhere", "/nonexistent", "/none", "/no", "/home/of/nobody")  # what tests need not to be there, on any machine
DEVICES = ("/dev/null", "/dev/full", "/dev/tty", "/dev/shm", "/dev/pts")
READS = {"os.listdir": (1, None), "os.scandir": (1, None), "os.chdir": (1, None)}  # event: paths, and the first folder that they are relative to
WRITES = {"os.mkdir": (1, 2), "os.remove": (1, 1), "os.rmdir": (1, 1), "os.truncate": (1, None), "os.chmod": (1, 2), "os.utime": (1, 3),
          "os.rename": (2, 2), "os.link": (2, 2)}
ASK = ("stat", "lstat", "access")  # functions of os
SETS = ("supports_dir_fd", "supports_effective_ids", "supports_fd", "supports_follow_symlinks")  # of os: which functions can what


def below(path: str, folders) -> bool:
    return any(path == folder or path.startswith(f"{folder.rstrip('/')}/") for folder in folders)


def callers() -> str:
    """The innermost lines of this tree on the way here."""
    import traceback

    frames = [frame for frame in traceback.extract_stack() if frame.filename.startswith(ROOT) and "/.venv/" not in frame.filename]
    return " < ".join(f"{os.path.basename(frame.filename)}:{frame.lineno}" for frame in frames[::-1] if frame.filename != __file__)


class Watch:
    """Of one process; `folders`: those of its test."""

    def __init__(self, folders: list, reported: str):
        self.told = reported
        self.may_read = [ROOT, *folders, sys.prefix, sys.base_prefix, *SYSTEM, *NOWHERE]
        self.may_write = [*folders, f"{ROOT}/build", *DEVICES, *NOWHERE]
        self.busy = False

    def allows(self, path: str, writes: bool) -> bool:
        """A folder above an allowed one may be read: every search for a file passes it."""
        if writes:
            return below(path, self.may_write) or "/__pycache__" in path
        return below(path, self.may_read) or any(below(known, [path]) for known in self.may_read)

    def look(self, path, writes: bool) -> None:
        if self.busy or not isinstance(path, (str, bytes, os.PathLike)):
            return
        self.busy = True
        try:
            text = os.path.normpath(os.path.join(os.getcwd(), os.fsdecode(path)))
            if "\0" not in text and not self.allows(text, writes) and not self.allows(os.path.realpath(text), writes):
                with open(self.told, "a", encoding="utf-8", errors="surrogateescape") as file:
                    file.write(f"{'writes' if writes else 'reads'} {text} ({callers()})\n")
        except OSError:
            pass  # the folder that this process works in is gone
        finally:
            self.busy = False

    def event(self, name: str, arguments: tuple) -> None:
        if name == "open":
            self.look(arguments[0], bool((arguments[2] or 0) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)))
        elif name in READS or name in WRITES:
            n, of_folder = READS.get(name) or WRITES[name]
            for path in arguments[:n]:
                if of_folder is None or len(arguments) <= of_folder or arguments[of_folder] == -1 or os.path.isabs(path):
                    self.look(path, name in WRITES)


def wrapped(function, watch: Watch):
    def requested(path, *words, **more):
        if more.get("dir_fd") is None:
            watch.look(path, False)
        return function(path, *words, **more)

    for name in SETS:
        if function in getattr(os, name):
            getattr(os, name).add(requested)
    return requested


def start() -> None:
    """Watches this process from here on; nothing where the environment names no folders."""
    if TOLD not in os.environ:
        return
    watch = Watch(os.environ[FOLDERS].split(os.pathsep), os.environ[TOLD])
    for name in ASK:
        setattr(os, name, wrapped(getattr(os, name), watch))
    sys.addaudithook(watch.event)

"""Memory that processes can have on this machine."""

from pathlib import Path

from . import input_file
from .errors import UserError

UNKNOWN = 4 << 30  # bytes, where the system does not say it


def free_bytes() -> int:
    """What the system has to give without swapping (MemAvailable of /proc/meminfo)."""
    try:
        lines = input_file.read_text(Path("/proc/meminfo")).splitlines()
        return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (UserError, StopIteration):
        return UNKNOWN

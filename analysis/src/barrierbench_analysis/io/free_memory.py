"""Memory that processes can have on this machine."""

from pathlib import Path

from . import input_file
from .errors import UserError

GROUP = Path("/sys/fs/cgroup")  # limits of a container (cgroup v2)


def _number(path: Path) -> int | None:
    """None where there is no file, or no limit in it."""
    try:
        text = input_file.read_text(path).strip()
    except UserError:
        return None
    return int(text) if text.isdigit() else None


def free_bytes() -> int | None:
    """What the system has to give without swapping (MemAvailable of /proc/meminfo), within the limit of a
    container. None where the system does not say it.
    """
    try:
        lines = input_file.read_text(Path("/proc/meminfo")).splitlines()
        free = 1024 * next(int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (UserError, StopIteration):
        return None
    most, used = _number(GROUP / "memory.max"), _number(GROUP / "memory.current")
    return free if most is None or used is None else min(free, max(0, most - used))

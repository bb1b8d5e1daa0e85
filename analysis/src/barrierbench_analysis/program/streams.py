"""What this process says: the standard streams show control characters of names and paths instead of sending
them to the terminal, and a warning of a library is one line without the path of its source.
"""

import sys
import warnings

SENT = "\n\t"
SHOWN = {code: f"\\x{code:02x}" for code in (*range(0x20), *range(0x7F, 0xA0)) if chr(code) not in SENT}


class Shown:
    """A text stream that writes control characters as \\x1b and passes on everything else."""

    def __init__(self, stream):
        self._stream = stream

    def write(self, text: str) -> int:
        self._stream.write(text.translate(SHOWN))
        return len(text)

    def writelines(self, lines) -> None:
        for line in lines:
            self.write(line)

    def command(self, text: str) -> None:
        """A command for the terminal, as it is."""
        self._stream.write(text)

    def __getattr__(self, name: str):
        if name in ("buffer", "detach"):  # bytes would pass as they are
            raise AttributeError(name)
        return getattr(self._stream, name)


def command(text: str, stream=None) -> None:
    """Sends a command to the terminal of a stream, or of the standard output."""
    stream = stream or sys.stdout
    getattr(stream, "command", stream.write)(text)


def _say_warning(message, category, filename, lineno, file=None, line=None) -> None:
    print(f"bench: warning: {' '.join(str(message).split())}", file=file or sys.stderr)


def prepare() -> None:
    """For the whole process, which is a verb of the front door or one that it starts (processes.pool); a
    second call does nothing. A stream that is closed stays so.
    """
    for name in ("stdout", "stderr"):
        if (stream := getattr(sys, name)) is not None and not isinstance(stream, Shown):
            setattr(sys, name, Shown(stream))
    warnings.showwarning = _say_warning

"""What a program writes on a terminal.

Linux may answer EIO to a read of a pseudo-terminal whose last writer is gone although a part of what was written has not been read. So the
test keeps the writing end open, writes a mark into it once the program has ended, and reads up to the mark.
"""

import fcntl
import os
import pty
import struct
import subprocess
import termios
import threading

END = b"\x00end of the program\x00"


def shown(command: list[str], columns: int = 80, output: bool = True, **settings) -> tuple[int, str]:
    """Exit status, and what stands on a terminal of 40 lines of that width: the standard output and error of the command, or its error alone.

    settings: more arguments of subprocess.Popen (cwd, env).
    """
    ours, its = pty.openpty()
    fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
    written = its if output else subprocess.DEVNULL
    child = subprocess.Popen(command, stdout=written, stderr=its, stdin=subprocess.DEVNULL, **settings)
    ended = threading.Thread(target=lambda: (child.wait(), os.write(its, END)))
    ended.start()
    read = b""
    while not read.endswith(END):
        read += os.read(ours, 65536)
    ended.join()
    os.close(its)
    os.close(ours)
    return child.returncode, read.removesuffix(END).decode()

"""Hostile input of the verbs in Python: what is no file, what is too large for its header, and programs that are none."""

from dataclasses import dataclass, field
from typing import Optional

from tests.hostile.files import BLOCK, Content, fifo, link_to, sparse

CALL_AGAIN = 75


@dataclass(frozen=True)
class VerbCase:
    name: str
    words: tuple  # of ./bench, in the folder of the files
    says: tuple = ()
    files: dict = field(default_factory=dict)
    code: int = 2
    environment: dict = field(default_factory=dict)
    closed: tuple = ()  # numbers of streams that the shell has closed
    output: Optional[str] = None  # where the standard output goes
    writes: tuple = ()


def named(verb: str, kind: str, content: Content, words: tuple, says: str, name: str = "x") -> VerbCase:
    return VerbCase(f"{verb.replace(' ', '-')}-{kind}", (*verb.split(), *words), (says,), {name: content})


READERS = {  # a verb whose file is x: its words
    "gate compare": ("x", "x"), "gate run": ("--record", "x", "--baseline", "x"), "gate accept": ("--record", "x", "--baseline", "b.json", "--reason", "r"), "draw figure": ("x",),
    "study match": ("x",),
}
SPECIAL = {"fifo": fifo, "zero": link_to("/dev/zero")}
HUGE_MATRIX = "%%MatrixMarket matrix coordinate real symmetric\n2000000000 2000000000 1\n1 1 1\n"
MANY_ENTRIES = "%%MatrixMarket matrix coordinate real general\n3 3 4000000000\n1 1 1\n"
DENSE = "%%MatrixMarket matrix array real general\n2000000000 2000000000\n1\n"

VERBS = [
    *[named(verb, kind, content, words, "x") for verb, words in READERS.items() for kind, content in SPECIAL.items()],
    *[named("gate accept", f"matrix-{kind}", text, ("--matrix", "x", "--baseline", "b.json", "--reason", "r"), "its header says") for kind, text in
      {"huge": HUGE_MATRIX, "entries": MANY_ENTRIES, "dense": DENSE}.items()],
    *[named("study", kind, content, ("x.json", "plan"), "x.json", "x.json") for kind, content in SPECIAL.items()],
    *[named("study", f"own-{kind}", content, ("x.json",), "x.json", "x.json") for kind, content in SPECIAL.items()],
    named("gate accept", "matrix-fifo", fifo, ("--matrix", "x", "--baseline", "b.json", "--reason", "r"), "x: a FIFO"),
    named("gate accept", "matrix-sparse", sparse(1 << 40), ("--matrix", "x", "--baseline", "b.json", "--reason", "r"), "1099511627776 bytes; at most"),
    named("data collect", "fifo", fifo, ("run", "t.csv"), "no record that can be read", "run/run.json"),
    named("data collect", "list-fifo", fifo, ("run", "t.csv"), "run", "run/cases.json"),
    *[VerbCase(f"program-{name}", ("list", "shapes"), (f"BARRIERBENCH_PROGRAM: found {path}", "allowed: a built program"), environment={"BARRIERBENCH_PROGRAM": path})
      for name, path in {"yes": "/usr/bin/yes", "cat": "/bin/cat", "true": "/bin/true", "folder": "/etc", "text": "/etc/passwd", "device": "/dev/zero"}.items()],
    VerbCase("program-yes-of-a-verb-in-python", ("study", "score", "log", "--out", "o"), ("does not list shapes",), environment={"BARRIERBENCH_PROGRAM": "/usr/bin/yes"}),
    *[VerbCase(f"closed-{name}", ("run", BLOCK, "--set", "/time/steps=1", "--out", "o"), code=0, closed=numbers, writes=("o",))
      for name, numbers in {"output": (1,), "everything": (0, 1, 2)}.items()],
    VerbCase("closed-help", ("help",), code=0, closed=(1,)),
    VerbCase("full-help", ("help",), ("the standard output cannot be written: No space left on device",), code=CALL_AGAIN, output="/dev/full"),
    VerbCase("full-verb-help", ("test", "--help"), ("the standard output cannot be written",), code=CALL_AGAIN, output="/dev/full"),
    VerbCase("letters-in-an-ascii-locale", ("status", "gr\u00f6\u00dfe"), ("no such folder",),
             environment={"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}),
]

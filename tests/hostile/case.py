"""One case of hostile input: what is handed to the program, and what it has to answer; and the cases that differ in one file or line."""

from dataclasses import dataclass, field
from typing import Callable, Optional

from tests.hostile.files import BLOCK, Content, one_mesh

REFUSED, INTERRUPTED_OR_FULL, DONE = 2, 75, 0
DEEP = 100_000
HUGE = 2**64 - 1


@dataclass(frozen=True)
class Case:
    name: str
    command: tuple  # arguments of the program, which starts in the folder of the files
    files: dict = field(default_factory=dict)  # name: content
    libraries: dict = field(default_factory=dict)  # name: which plugin of plugin_cases.c
    code: int = REFUSED
    says: tuple = ()
    stdin: bytes = b""
    environment: dict = field(default_factory=dict)
    prepare: Optional[Callable[[], None]] = None  # in the child, before the program
    writes: tuple = ()  # names at the top of the folder that may appear
    seconds: float = 30


def check(name: str, content: Content, *says: str, **more) -> Case:
    """`check` of one config file."""
    return Case(f"check-{name}", ("check", "a.json", *more.pop("extra", ())), {"a.json": content, **more.pop("files", {})}, says=says, **more)


def override(name: str, value: str, *says: str, **more) -> Case:
    """`check` of a sound config with one --set."""
    return Case(f"set-{name}", ("check", BLOCK, "--set", value), says=says, **more)


def dry(name: str, content: Content, *says: str, **more) -> Case:
    """`sweep --dry-run` of one sweep file."""
    return Case(f"sweep-{name}", ("sweep", "s.json", "--dry-run"), {"s.json": content, **more.pop("files", {})}, says=says, **more)


def mesh(name: str, file: str, content: Content, *says: str, **more) -> Case:
    """`check` of a config whose only body is this mesh file."""
    return Case(f"mesh-{name}", ("check", "a.json"), {"a.json": one_mesh(file), file: content}, says=says, **more)


def refused_run(name: str, content: Content, *says: str, **more) -> Case:
    """`run` of what `check` refuses: exit 2 before anything is written."""
    return Case(f"run-{name}", ("run", "a.json", "--out", "out"), {"a.json": content, **more.pop("files", {})}, says=says, **more)


def query(name: str, line, *says: str, **more) -> Case:
    return Case(f"eval-{name}", ("eval",), stdin=line if isinstance(line, bytes) else line.encode(), says=says, **more)


def plugin(name: str, bad: str, *says: str, **more) -> Case:
    return Case(f"plugin-{name}", ("--plugin", "p.so", "list", "shapes"), libraries={"p.so": bad}, says=says, **more)

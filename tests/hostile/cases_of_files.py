"""Files as such: what is no regular file, what is too large, plugins, matrices with their side-cars, streams, and what lies in the output folder already."""

import os
import resource

from tests.hostile.case import DEEP, DONE, HUGE, INTERRUPTED_OR_FULL, Case, plugin
from tests.hostile.files import BLOCK, fifo, folder, link_to, nested, one_mesh, sparse, sweep, unix_socket

# --- what is no regular file, for every reader

NO_FILES = {"fifo": (fifo, "FIFO"), "folder": (folder, "folder"), "socket": (unix_socket, "socket"),
            "zero": (link_to("/dev/zero"), "character device"), "absent": (None, "No such file"),
            "loop": (link_to("it"), "Too many levels")}
READERS = {
    "config": (("check", "it"), {}),
    "sweep": (("sweep", "it", "--dry-run"), {}),
    "plugin": (("--plugin", "it", "list"), {}),
    "eval": (("eval", "it"), {}),
    "mesh": (("check", "a.json"), {"a.json": one_mesh("it")}),
    "matrix": (("matrix", "it"), {}),
    "extends": (("check", "a.json"), {"a.json": {"schema": "barrierbench.config/1", "extends": "it"}}),
}
FILES = [Case(f"file-{reader}-{kind}", command, {**files, **({"it": content} if content else {})}, says=(says, "it"))
         for reader, (command, files) in READERS.items() for kind, (content, says) in NO_FILES.items()]
FILES += [
    Case("file-config-too-large", ("check", "it"), {"it": sparse((16 << 20) + 1)}, says=("16777216 bytes",)),
    Case("file-sweep-too-large", ("sweep", "it", "--dry-run"), {"it": sparse((16 << 20) + 1)}, says=("16777216 bytes",)),
    Case("file-mesh-too-large", ("check", "a.json"), {"a.json": one_mesh("m.ply"), "m.ply": sparse((1 << 30) + 1)},
         says=("1073741824 bytes",)),
    Case("file-plugin-too-large", ("--plugin", "it", "list"), {"it": sparse((256 << 20) + 1)}, says=("268435456 bytes",)),
    Case("file-config-no-name", ("check", ""), says=("no path",)),
    Case("file-sweep-no-name", ("sweep", "", "--dry-run"), says=("no path",)),
    Case("file-eval-no-name", ("eval", ""), says=("no path",)),
    Case("file-mesh-zero-byte", ("check", "a.json"), {"a.json": one_mesh("a\0b.ply")}, says=("#/scene/bodies/0/mesh/file", "without control characters")),
    Case("file-sweep-base-fifo", ("sweep", "s.json", "--dry-run"),
         {"s.json": sweep([{"pointer": "/time/steps", "values": [1]}], base="it"), "it": fifo}, says=("FIFO",)),
    Case("file-presets-nowhere", ("check", BLOCK, "--set", "/formulation=cubic"), environment={"BARRIERBENCH_CONFIGS": "nowhere"},
         says=("cubic",)),
]

# --- plugins

PLUGINS = [
    plugin("sound", "sound", "hostile_shape", code=DONE),
    plugin("null-array", "null_array", "1 shapes in a NULL array"),
    plugin("wild-array", "wild_array", "signal 11"),
    plugin("wild-name", "wild_name", "signal 11"),
    plugin("2-64-entries", "many_entries", "18446744073709551615 shapes"),
    plugin("smoothness", "smoothness", "smoothness_at_d_hat = -7"),
    plugin("flag", "flag", "infinite_at_zero = 2"),
    plugin("long-name", "long_name", "snake_case"),
    plugin("null-plugin", "null_plugin", "NULL"),
    plugin("constructor-crashes", "constructor_crashes", "signal 11"),
    plugin("constructor-exits", "constructor_exits", "exit(0)"),
    plugin("constructor-hangs", "constructor_hangs", "no end within 10 s"),
    plugin("entry-aborts", "entry_crashes", "signal 6"),
    plugin("cut-header", "sound:0.003", "p.so"),
    plugin("cut-early", "sound:0.05", "beyond its end"),
    plugin("cut-half", "sound:0.5", "beyond its end"),
    plugin("cut-late", "sound:0.99", "beyond its end"),
    Case("plugin-text", ("--plugin", "p.so", "list"), {"p.so": "not a library"}, says=("no ELF header",)),
    Case("plugin-empty", ("--plugin", "p.so", "list"), {"p.so": ""}, says=("no ELF header",)),
    Case("plugin-twice", ("--plugin", "p.so", "--plugin", "p.so", "list"), libraries={"p.so": "sound"}, says=("not yet taken",)),
]

# --- matrices and their side-cars

MTX = "%%MatrixMarket matrix coordinate real symmetric\n"
MATRICES = [
    *(Case(f"side-car-{kind}", ("matrix", "a.mtx"), {"a.mtx": MTX + "1 1 1\n1 1 1\n", "a.json": content}, says=("a.json", says))
      for kind, (content, says) in NO_FILES.items() if content and kind != "loop"),
    Case("side-car-dangling", ("matrix", "a.mtx"), {"a.mtx": MTX + "1 1 1\n1 1 1\n", "a.json": link_to("nowhere")}, says=("a.json", "No such file")),
    Case("side-car-nested", ("matrix", "a.mtx"), {"a.mtx": MTX + "1 1 1\n1 1 1\n", "a.json": nested(DEEP)}, says=("a.json:1", "64 levels")),
    Case("matrix-counts-of-2^62", ("matrix", "a.mtx"), {"a.mtx": MTX + f"{2**62} {2**62} {2**62}\n1 1 1\n"}, says=("a.mtx:2", "at most")),
    Case("matrix-rows-of-2^40", ("matrix", "a.mtx"), {"a.mtx": MTX + f"{2**40} {2**40} 1\n1 1 1\n"}, says=("a.mtx:2", "rows")),
    Case("matrix-count-beyond-integers", ("matrix", "a.mtx"), {"a.mtx": MTX + f"1 1 {HUGE}\n1 1 1\n"}, says=("a.mtx:2", "an integer")),
    Case("matrix-zeros", ("matrix", "a.mtx"), {"a.mtx": sparse(1 << 20)}, says=("a.mtx:1",)),
    Case("matrix-too-large", ("matrix", "a.mtx"), {"a.mtx": sparse((1 << 30) + 1)}, says=("a.mtx", "a Matrix Market file")),
]

# --- streams, limits and what lies in the output folder already

def no_stderr() -> None:
    os.close(2)


def full_stderr() -> None:
    os.dup2(os.open("/dev/full", os.O_WRONLY), 2)


def full_stdout() -> None:
    os.dup2(os.open("/dev/full", os.O_WRONLY), 1)


def small_files() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))


SHORT = ("run", BLOCK, "--set", "/time/steps=1", "--out", "out")
OUTPUTS = [
    Case("stderr-closed", ("check", BLOCK, "--set", "/time/dt_s=-1"), prepare=no_stderr),
    Case("stderr-full", ("check", BLOCK, "--set", "/time/dt_s=-1"), prepare=full_stderr),
    Case("stderr-full-plugin", ("--plugin", "nowhere.so", "list"), prepare=full_stderr),
    Case("files-of-4000-bytes", SHORT, code=INTERRUPTED_OR_FULL, says=("File too large",), prepare=small_files, writes=("out",)),
    Case("stdout-full", ("list", "shapes"), code=INTERRUPTED_OR_FULL, says=("the standard output cannot be written",), prepare=full_stdout),
    *(Case(f"empty-{option.strip('-')}", (*verb, option, ""), says=(option,))
      for *verb, option in (("steps", BLOCK, "--at"), ("run", BLOCK, "--out"), ("run", BLOCK, "--set"), ("run", BLOCK, "--time-limit"), ("sweep", "s.json", "--index"),
                            ("sweep", "s.json", "--jobs"), ("ccd", "--random"), ("ccd", "--seed"), ("matrix", "a.mtx", "--tol"), ("explain", BLOCK, "--contacts"), ("--plugin",),
                            ("--progress-every",), ("--progress",))),
    Case("name-of-a-file-with-escapes", ("check", "a\x1b[31m\x07.json"), says=("a\\x1b[31m\\x07.json",)),
    Case("out-run-json-a-fifo", SHORT, {"out/run.json": fifo}, says=("out/run.json: found a file that is no record of a run", "--replace")),
    Case("out-run-json-nested", SHORT, {"out/run.json": nested(DEEP)}, says=("out/run.json: found a file that is no record of a run", "--replace")),
    Case("out-run-json-nested-replaced", (*SHORT, "--replace"), {"out/run.json": nested(DEEP)}, code=DONE, writes=("out",)),
    Case("out-a-file", SHORT, {"out": "text"}, says=("out",)),
    Case("run-a-nested-record", ("run", "r.json", "--out", "out"), {"r.json": '{"schema": {"name": "barrierbench.run"}, "x": ' + nested(DEEP) + "}"},
         says=("64 levels",)),
]

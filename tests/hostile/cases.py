"""The table of hostile input: what is handed to the program, and what it has to answer."""

import os
import resource
from dataclasses import dataclass, field
from typing import Callable, Optional

from tests.hostile.files import (
    BLOCK, FACES, POINTS, SCENES, SQUARE, TRIANGLE_BYTES, VERTICES, Content, binary_ply, binary_points, binary_stl, bodies, body,
    case, config, fifo, folder, grid, link_to, nested, one_mesh, ply, sparse, sweep, unix_socket)

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
    Case("file-plugin-no-name", ("--plugin", "", "list"), says=("no path",)),
    Case("file-eval-no-name", ("eval", ""), says=("no path",)),
    Case("file-mesh-zero-byte", ("check", "a.json"), {"a.json": one_mesh("a\0b.ply")}, says=("zero byte",)),
    Case("file-sweep-base-fifo", ("sweep", "s.json", "--dry-run"),
         {"s.json": sweep([{"pointer": "/time/steps", "values": [1]}], base="it"), "it": fifo}, says=("FIFO",)),
    Case("file-presets-nowhere", ("check", BLOCK, "--set", "/formulation=cubic"), environment={"BARRIERBENCH_CONFIGS": "nowhere"},
         says=("cubic",)),
]

# --- JSON, wherever it is read

CONFIG_TEXT = '{"schema": "barrierbench.config/1", "scene": {"name": "hang"%s}}'
JSON = [
    check("nested-arrays", nested(DEEP), "a.json:1", "64 levels"),
    check("nested-objects", nested(DEEP, '{"a":', "}"), "64 levels"),
    check("nested-unclosed", "[" * 10_000_000, "64 levels"),
    check("nested-in-a-key", CONFIG_TEXT % (', "n": ' + nested(DEEP)), "64 levels"),
    check("nested-65", CONFIG_TEXT % (', "n": ' + nested(63)), "64 levels"),
    dry("nested", nested(DEEP), "64 levels"),
    dry("nested-value", '{"axes": [{"values": [' + nested(DEEP) + "]}]}", "64 levels"),
    override("nested", "/scene/n=" + nested(60_000), "64 levels"),
    override("nested-objects", "/scene=" + nested(20_000, '{"a":', "}"), "64 levels"),
    query("nested", nested(DEEP) + "\n", "64 levels"),
    query("nested-id", '{"id": ' + nested(1000) + ', "kind": "rho", "shape": "cubic", "u": 0.5}\n', "64 levels"),
    check("extends-nested", {"schema": "barrierbench.config/1", "extends": "b.json"}, "b.json:1", "64 levels",
          files={"b.json": nested(DEEP)}),
    check("repeated-key", '{"schema": "barrierbench.config/1",\n "scene": {"name": "hang"},\n "scene": {"name": "hang"}}',
          "a.json:3", '"scene" twice'),
    check("repeated-key-nested", CONFIG_TEXT % ', "n": 3, "n": 4', '"n" twice'),
    check("repeated-key-escaped", CONFIG_TEXT % ', "n": 3, "\\u006e": 4', '"n" twice'),
    dry("repeated-key", '{"schema": "barrierbench.sweep/1", "name": "a", "name": "b", "base": "b", "axes": []}', '"name" twice'),
    dry("repeated-key-in-a-set", '{"schema": "barrierbench.sweep/1", "name": "a", "base": "%s", "axes": [{"cases": [{"label": "x", '
        '"set": {"/time/steps": 1, "/time/steps": 2}}]}]}' % BLOCK, '"/time/steps" twice'),
    override("repeated-key", '/time={"dt_s": 0.01, "dt_s": 0.02}', '"dt_s" twice'),
    query("repeated-key", '{"kind": "rho", "shape": "cubic", "u": 0.5, "u": 0.25, "id": 7}\n', "/u", '"id":7'),
    query("repeated-key-nested", '{"kind": "rho", "shape": "cubic", "u": {"a": 1, "a": 2}}\n', "twice"),
    check("number-overflow", CONFIG_TEXT % ',\n "x": 1e999', "a.json:2", "1e999"),
    dry("number-overflow", '{"schema": "barrierbench.sweep/1",\n "name": "a", "base": "b", "axes": [{"pointer": "/a", "values": [1e999]}]}',
        "s.json:2", "1e999"),
    dry("number-overflow-negative", '{"axes": [{"values": [-1e999]}]}', "1e999"),
    override("number-overflow", "/time/dt_s=1e999", "1e999"),
    query("number-overflow", '{"id": 3, "kind": "rho", "shape": "cubic", "u": 1e999}\n', "out of range", '"id":3'),
    override("seed-beyond-2-53", f"/seeds/main={2**53 + 1}", "9007199254740993", "2^53"),
    override("seed-beyond-2-64", f"/seeds/main={2**64}", "/seeds/main"),
    check("seed-beyond-2-53-has-its-pointer", {**config({"name": "hang"}), "seeds": {"main": 2**53 + 1}}, "a.json:1#/seeds/main: found 9007199254740993", "2^53"),
    check("count-beyond-2-53-has-its-pointer", bodies(body(grid()), body(grid(n_x=HUGE), name="b")), "a.json:1#/scene/bodies/1/mesh/n_x: found 18446744073709551615"),
    check("integer-beyond-2-53-in-an-array", bodies(body(grid(), pins=[{"indices": [0, 1, 2**60]}])), "a.json:1#/scene/bodies/0/pins/0/indices/2"),
    override("diagnose-seed-beyond-2-53", f"/diagnose/seed={2**53 + 1}", "2^53"),
    check("count-2-64-1", bodies(body(grid(n_x=HUGE))), "18446744073709551615", "2^53"),
    check("count-2-63", bodies(body(grid(n_x=2**63))), "9223372036854775808"),
    check("count-minus-2-63", bodies(body(grid(n_x=-(2**63)))), "-9223372036854775808"),
    dry("seed-beyond-2-53", sweep([{"pointer": "/seeds/main", "values": [2**53 + 1]}]), "2^53"),
    check("empty", "", "a.json:1"),
    check("blank", " \n\t\n", "a.json"),
    check("cut", '{"schema": "barrierbench.config/1",\n"scene": {', "a.json:2"),
    check("zero-bytes", bytes(1000), "a.json:1"),
    check("no-utf8", b'{"schema": "\xff\xfe"}', "a.json:1"),
    check("two-values", '{"schema": 1} {}', "a.json:1"),
    check("nan", CONFIG_TEXT % ', "x": NaN', "a.json:1"),
    check("comment", "// a config\n{}", "a.json:1"),
    check("an-array", "[]", "an object"),
    check("a-number", "1", "an object"),
    dry("an-array", "[]", "an object"),
    dry("empty", "", "s.json:1"),
    override("no-utf8", b"/scene/name=\xff\xfe".decode("utf-8", "surrogateescape"), "UTF-8"),
    override("half-an-object", '/time={"dt_s": 0.01', "JSON"),
    check("extends-itself", {"schema": "barrierbench.config/1", "extends": "a.json"}, "#/extends"),
    check("extends-for-ever", {"schema": "barrierbench.config/1", "extends": "e1.json"}, "at most 16 configs",
          files={f"e{i}.json": {"extends": f"e{i + 1}.json"} for i in range(1, 40)}),
    query("a-line-too-long", "[" + "1," * (9 << 20), "16777216 bytes"),
]

# --- overrides

OVERRIDES = [
    override("index-into-nothing", "/seeds/300000000=1", "/seeds/300000000"),
    override("index-beyond-an-array", "/scene/bodies/300000000/name=a", "/scene/bodies"),
    check("index-beyond-an-array", bodies(body(grid())), "--set /scene/bodies/300000000/name=a",
          extra=("--set", "/scene/bodies/300000000/name=a")),
    check("index-append", bodies(body(grid())), "--set /scene/bodies/-=a", extra=("--set", "/scene/bodies/-=a")),
    override("index-into-a-missing-section", "/diagnose/scalings/4000000000=none", "/diagnose/scalings"),
    override("index-2-64", f"/scene/bodies/{2**64}/name=a", "/scene/bodies"),
    override("index-append", "/scene/bodies/-=a", "/scene/bodies"),
    override("index-negative", "/scene/bodies/-1=a", "/scene/bodies"),
    override("below-a-number", "/time/dt_s/x=1", "/time/dt_s"),
    override("bad-escape", "/time/~2=1", "/time/~2"),
    override("no-pointer", "time/dt_s=1", "/pointer=value"),
    override("no-value", "/time/dt_s", "/pointer=value"),
    override("the-empty-key", "/=1", "unknown key"),
    override("whole-document", "=1", "/pointer=value"),
    override("long", "/time/" + "x" * 100_000 + "=1", "unknown key"),
    override("long-value", "/formulation/name=" + "x" * 100_000, "/formulation/name"),
]

NUMBERS = [
    Case(f"option-{verb[0]}-{option.strip('-')}-{text}", (*verb, option, text), says=(option, text))
    for verb, option in ((("explain", BLOCK), "--contacts"), (("explain", BLOCK), "--blocks-per-contact"), (("explain", BLOCK), "--candidates-per-contact"),
                         (("run", BLOCK, "--out", "out"), "--time-limit"), (("run", BLOCK, "--out", "out"), "--progress-every"), (("matrix", "a.mtx"), "--tol"))
    for text in ("nan", "inf", "-inf", "1e400", "-1")
]

# --- sweeps

STEPS = {"pointer": "/time/steps", "values": [1]}
HUNDRED = {"pointer": "/time/steps", "values": list(range(1, 101))}
SWEEPS = [
    dry("four-axes-of-100", sweep([HUNDRED] * 4), "100000000 combinations", "at most 10000"),
    dry("fifty-axes-of-100", sweep([HUNDRED] * 50), "combinations", "at most 10000"),
    dry("200-axes-of-100", sweep([HUNDRED] * 200), "combinations"),
    dry("unknown-key", sweep([STEPS], axs=[]), "#/axs", "did you mean axes?"),
    dry("unknown-key-in-an-axis", sweep([{**STEPS, "value": [2]}]), "#/axes/0/value", "did you mean values?"),
    dry("unknown-key-in-a-case", sweep([{"cases": [case("a", sets={})]}]), "#/axes/0/cases/0/sets"),
    dry("pointer-beside-cases", sweep([{"pointer": "/time/steps", "cases": [case("a")]}]), "#/axes/0", "{pointer, values}"),
    dry("values-beside-cases", sweep([{"values": [1], "cases": [case("a")]}]), "#/axes/0"),
    dry("all-three", sweep([{**STEPS, "cases": [case("a")]}]), "#/axes/0"),
    dry("an-empty-axis", sweep([{}]), "#/axes/0", "an object with nothing"),
    dry("no-axes", sweep([]), "#/axes"),
    dry("no-values", sweep([{"pointer": "/time/steps", "values": []}]), "#/axes/0/values"),
    dry("no-cases", sweep([{"cases": []}]), "#/axes/0/cases"),
    dry("axes-an-object", sweep({"pointer": "/time/steps"}), "#/axes"),
    dry("an-axis-a-number", sweep([3]), "#/axes/0"),
    dry("values-a-number", sweep([{"pointer": "/time/steps", "values": 3}]), "#/axes/0/values"),
    dry("set-an-array", sweep([STEPS], set=[1]), "#/set"),
    dry("set-without-a-slash", sweep([STEPS], set={"time/dt_s": 1}), "#/set", "a JSON pointer"),
    dry("pointer-without-a-slash", sweep([{"pointer": "time", "values": [1]}]), "#/axes/0/pointer", "a JSON pointer"),
    dry("pointer-with-an-equals-sign", sweep([{"pointer": "/name=x", "values": [1, 2]}]), "#/axes/0/pointer", "without \"=\""),
    dry("set-with-an-equals-sign", sweep([STEPS], set={"/time/dt_s=1": 1}), "#/set", "/time/dt_s=1"),
    dry("pointer-with-a-bad-escape", sweep([{"pointer": "/time/~2", "values": [1]}]), "#/axes/0/pointer"),
    dry("one-pointer-on-two-axes", sweep([STEPS, {"pointer": "/time/steps", "values": [2]}]), "#/axes/1", "axis 0 sets too"),
    dry("one-label-twice", sweep([{"cases": [case("a"), case("a")]}]), "#/axes/0/cases/1/label", "again"),
    dry("one-value-twice", sweep([{"pointer": "/time/steps", "values": [1, 1]}]), "#/axes/0/values/1"),
    dry("one-run-twice", sweep([{"cases": [case("a"), case("b")]}]), "[b]", "the same run as [a]"),
    dry("label-a-number", sweep([{"cases": [{"label": 3, "set": {}}]}]), "#/axes/0/cases/0/label"),
    dry("label-missing", sweep([{"cases": [{"set": {}}]}]), "#/axes/0/cases/0/label"),
    dry("label-empty", sweep([{"cases": [case("")]}]), "#/axes/0/cases/0/label"),
    dry("label-of-300", sweep([{"cases": [case("x" * 300)]}]), "150 bytes"),
    dry("labels-of-300-together", sweep([{"cases": [{"label": c * 100, "set": {f"/seeds/{c}": 1}}]} for c in "abc"]), "150 bytes"),
    dry("label-upwards", sweep([{"cases": [case("../../up")]}]), "#/axes/0/cases/0/label", "folders are named after it"),
    dry("label-a-path", sweep([{"cases": [case("a/b")]}]), "#/axes/0/cases/0/label"),
    dry("label-a-line-feed", sweep([{"cases": [case("a\nb")]}]), "#/axes/0/cases/0/label"),
    dry("label-a-zero-byte", sweep([{"cases": [case("a\0b")]}]), "#/axes/0/cases/0/label"),
    dry("label-a-dot", sweep([{"cases": [case(".hidden")]}]), "#/axes/0/cases/0/label"),
    dry("name-upwards", sweep([STEPS], name="../../up"), "#/name", "folders are named after it"),
    dry("name-absolute", sweep([STEPS], name="/tmp/up"), "#/name"),
    dry("name-dots", sweep([STEPS], name=".."), "#/name"),
    dry("name-of-300", sweep([STEPS], name="n" * 300), "#/name"),
    dry("value-of-300", sweep([{"pointer": "/formulation/name", "values": ["x" * 300]}]), "150 bytes"),
    dry("base-absent", sweep([STEPS], base="nowhere.json"), "nowhere.json"),
    dry("base-a-sweep", sweep([STEPS], base="s.json"), "s.json"),
    dry("schema-of-a-config", sweep([STEPS], schema="barrierbench.config/1"), "#/schema"),
    dry("value-a-path", sweep([{"pointer": "/scene/bodies/0/mesh/file", "values": ["../x.ply"]}], base="a.json"), "x.ply",
        files={"a.json": one_mesh("m.obj"), "m.obj": SQUARE}),
    Case("sweep-run-1e999", ("sweep", "s.json", "--out", "out"),
         {"s.json": '{"schema": "barrierbench.sweep/1", "name": "a", "base": "b", "axes": [{"pointer": "/time/dt_s", "values": [1e999]}]}'},
         says=("1e999",)),
    Case("sweep-run-label-of-300", ("sweep", "s.json", "--out", "out"), {"s.json": sweep([{"cases": [case("x" * 300)]}])},
         says=("150 bytes",)),
]

# --- meshes

FAR = "v 0 0 0\nv %s 0 0\nv 0 1 0\nf 1 2 3\n"
MESHES = [
    mesh("ply-10-18-without-properties", "m.ply", ply([VERTICES, ("mystery", 10**18, [])], POINTS), "10"),
    mesh("ply-10-18-binary-without-properties", "m.ply", binary_ply([VERTICES, FACES, ("mystery", 10**18, [])], TRIANGLE_BYTES),
         "without a property"),
    mesh("ply-10-18-empty-lists", "m.ply", binary_ply([VERTICES, ("mystery", 10**18, ["list uchar int x"])], TRIANGLE_BYTES),
         "1000000000000000000 mystery"),
    mesh("ply-10-18-vertices", "m.ply", ply([("vertex", 10**18, VERTICES[2])], POINTS), "1000000000000000000 vertex"),
    mesh("ply-10-18-faces", "m.ply", binary_ply([VERTICES, ("face", 10**18, FACES[2])], TRIANGLE_BYTES), "1000000000000000000 face"),
    mesh("ply-count-10-19", "m.ply", ply([("vertex", 10**19, VERTICES[2])], POINTS), "m.ply:3"),
    mesh("ply-count-negative", "m.ply", ply([("vertex", -1, VERTICES[2])], POINTS), "m.ply:3"),
    mesh("ply-one-vertex-more", "m.ply", binary_ply([("vertex", 4, VERTICES[2])], TRIANGLE_BYTES[:72]), "4 vertex"),
    mesh("ply-list-of-4-billion", "m.ply", binary_ply([VERTICES, ("face", 1, ["list uint int vertex_indices"])],
                                                      TRIANGLE_BYTES[:72] + b"\xff\xff\xff\xff"), "face 0"),
    mesh("ply-list-negative", "m.ply", binary_ply([VERTICES, ("face", 1, ["list char int vertex_indices"])], TRIANGLE_BYTES[:72] + b"\xff"),
         "a list of -1"),
    mesh("ply-data-behind", "m.ply", ply([VERTICES, FACES], POINTS + "3 0 1 2\n0 0 9\n"), "behind the last element"),
    mesh("ply-data-behind-binary", "m.ply", binary_ply([VERTICES, FACES], TRIANGLE_BYTES + b"\0"), "1 bytes behind"),
    mesh("ply-property-twice", "m.ply", ply([("vertex", 3, ["double x", "double y", "double z", "double x"]), FACES], POINTS), "x twice"),
    mesh("ply-corners-twice", "m.ply", ply([VERTICES, ("face", 1, [*FACES[2], "list uchar int vertex_index"])], POINTS), "twice"),
    mesh("ply-element-twice", "m.ply", ply([VERTICES, VERTICES], POINTS * 2), "vertex twice"),
    mesh("ply-format-twice", "m.ply", b"ply\nformat ascii 1.0\nformat ascii 1.0\nend_header\n", "m.ply:3"),
    mesh("ply-version", "m.ply", ply([VERTICES, FACES], POINTS, version="9.9"), "m.ply:2"),
    mesh("ply-property-list-of-floats", "m.ply", ply([VERTICES, ("face", 1, ["list float int vertex_indices"])], POINTS), "m.ply:"),
    mesh("ply-a-million-properties", "m.ply", ply([("vertex", 1, [f"char p{i}" for i in range(300_000)])]), "at most 1000"),
    mesh("ply-no-end-of-header", "m.ply", b"ply\nformat ascii 1.0\n" + b"comment x\n" * 100_000, "end_header"),
    mesh("ply-empty", "m.ply", b"", "m.ply"),
    mesh("ply-zero-bytes", "m.ply", bytes(100_000), "m.ply:1"),
    mesh("ply-x-is-a-list", "m.ply", ply([("vertex", 1, ["list uchar double x", "double y", "double z"])], "1 0 0 0\n"), "property x"),
    mesh("ply-index-negative", "m.ply", binary_ply([VERTICES, FACES], TRIANGLE_BYTES[:-4] + b"\xff\xff\xff\xff"), "index -1"),
    mesh("ply-infinite", "m.ply", binary_ply([VERTICES, FACES], binary_points(0, 0, float("inf")) + TRIANGLE_BYTES[24:]), "vertex 0"),
    mesh("stl-4-billion-triangles", "m.stl", binary_stl(0xFFFFFFFF, 50), "m.stl"),
    mesh("stl-cut", "m.stl", binary_stl(2, 99), "m.stl"),
    mesh("stl-behind-endsolid", "m.stl", "solid a\nendsolid a\nfacet normal 0 0 1\n", "behind endsolid"),
    mesh("stl-four-numbers", "m.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0 0\n", "m.stl:4"),
    mesh("stl-large", "m.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e200 0 0\nvertex 0 1e200 0\nendloop\nendfacet\n"
         "endsolid a\n", "1e+15"),
    mesh("obj-zero-bytes", "m.obj", bytes(100_000), "m.obj"),
    mesh("obj-index-2-63", "m.obj", SQUARE + f"f 1 2 {2**63}\n", "m.obj:7"),
    mesh("obj-index-minus-2-63", "m.obj", SQUARE + f"f 1 2 {-2**63}\n", "m.obj:7"),
    mesh("obj-one-long-line", "m.obj", "v" + " 1" * 1_000_000, "without mass"),
    mesh("obj-a-face-of-a-million", "m.obj", SQUARE + "f" + " 1" * 1_000_000, "m.obj:7"),
    mesh("obj-coordinate-1e154", "m.obj", FAR % "1e154", "m.obj:2", "1e+15"),
    mesh("obj-coordinate-1e78", "m.obj", FAR % "-1e78", "m.obj:2", "1e+15"),
    mesh("obj-coordinate-1e308", "m.obj", FAR % "1e308", "m.obj:2"),
    mesh("obj-coordinate-1e309", "m.obj", FAR % "1e309", "m.obj:2"),
    mesh("obj-coordinate-denormal", "m.obj", "v 0 0 0\nv 1e-310 0 0\nv 0 1e-310 0\nf 1 2 3\n", "m.obj:4"),
    mesh("extension", "m.xyz", SQUARE, "m.xyz"),
    mesh("ply-empty-lines", "m.ply", ply([VERTICES, FACES], "\n" * 1_000_000), "m.ply"),
]

# --- scenes that config and files show to be wrong: `run` and `check` alike

RIGID_FAR = body(grid(), name="plate", kind="rigid", transform={"translate_m": [0, 0, -1]})


def with_obstacle(kind: str, **more) -> dict:
    """A cloth at z = 0 and one obstacle."""
    return config({"bodies": [body(grid())], "obstacles": [{"name": "thing", "kind": kind, "point_m": [0, 0, -1], **more}]})


WRONG_SCENES = {
    "model": (bodies(body(grid(), material={"model": "corotationl"})), "corotationl"),
    "mesh": ({**one_mesh("m.obj")}, "m.obj:4"),
    "pin": (bodies(body(grid(), pins=[{"indices": [9]}])), "vertex 9"),
    "empty-pin": (bodies(body(grid(), pins=[{"box_m": [[5, 5, 5], [6, 6, 6]]}])), "no vertex selected"),
    "pin-box-inverted": (bodies(body(grid(), pins=[{"box_m": [[-5, 5, -5], [5, -5, 5]]}])), "/scene/bodies/0/pins/0/box_m: found an inverted box: along y its min 5 is above its max -5"),
    "sphere-of-radius-0": (with_obstacle("sphere", radius_m=0), "/scene/obstacles/0/radius_m: found 0"),
    "sphere-of-radius-minus-1": (with_obstacle("sphere", radius_m=-1), "/scene/obstacles/0/radius_m: found -1"),
    "cylinder-without-radius": (with_obstacle("cylinder", axis=[0, 0, 1]), "/scene/obstacles/0/radius_m"),
    "density": (bodies(body(grid(), material={"density_kg_per_m2": 0})), "without mass"),
    "all-pinned": (bodies(body(grid(), pins=[{"all": True}])), "no free vertex"),
    "no-body": (bodies(), "at least one body"),
    "name-twice": (bodies(body(grid()), body(grid())), "cloth"),
    "grid-20000": (bodies(body(grid(n_x=20000, n_y=20000))), "GiB"),
    "cylinder-20000": (bodies(body({"generator": "cylinder", "n_around": 20000, "n_along": 20000})), "GiB"),
    "drape-of-100-layers": (config({"name": "drape", "n": 1000, "layers": 100}), "GiB"),
    "scaled-far": (bodies(body(grid(), transform={"scale": 1e100})), "1e+15"),
    "moved-far": (bodies(body(grid(), transform={"translate_m": [1e155, 0, 0]})), "1e+15"),
    "plate-driven-far": (bodies(body(grid()), {**RIGID_FAR, "motion": {"velocity_m_per_s": [1e200, 0, 0]}}), "driven too far"),
    "plate-vanishes": (bodies(body(grid()), {**RIGID_FAR, "transform": {"scale": 1e160, "translate_m": [0, 0, -1]}}), "1e+15"),
    "obstacle-far": (config({"bodies": [body(grid())], "obstacles": [{"name": "o", "kind": "plane", "point_m": [0, 0, -1e155]}]}), "1e+15"),
    "jitter-far": ({**bodies(body(grid())), "seeds": {"jitter_m": 1e200}}, "1e+15"),
    "zero-size": (bodies(body(grid(size_x_m=0))), "size_x_m"),
    "planar-bending": (bodies(body(grid(), material={"bending_J": 1}), planar=True), "planar"),
}
SCENE_CASES = [
    make(name, content, says, files={"m.obj": "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"} if name == "mesh" else {})
    for name, (content, says) in WRONG_SCENES.items() for make in (check, refused_run)
]
SCENE_CASES += [
    check("bowl-smaller-than-what-is-in-it", with_obstacle("sphere", radius_m=0.2, inside=True), 'body "cloth" inside obstacle "thing"', "found 1.41421 m across", "less than 0.4 m"),
    check("obstacle-that-touches-at-the-start", with_obstacle("sphere", radius_m=1.0), "obstacle_triangle: thing, cloth[0]", "gap 0 m"),
    check("plane-that-touches-at-the-start", config({"bodies": [body(grid())], "obstacles": [{"name": "floor", "kind": "plane", "point_m": [0, 0, 0]}]}),
          "obstacle: floor", "gap 0 m"),
    check("ten-thousand-and-one-bodies", bodies(*[body(grid(), name=f"b{i}") for i in range(10_001)]), "at most 10000"),
    check("formulation-upwards", {**bodies(body(grid())), "formulation": {
        "name": "../../up", "shape": "log", "argument": "gap", "stiffness_policy": {"name": "fixed"}, "d_hat_m": 0.01}}, "/formulation/name"),
    check("formulation-a-path", {**bodies(body(grid())), "formulation": {"name": "a/b", "d_hat_m": 0.01}}, "/formulation/name"),
    check("formulation-of-300", {**bodies(body(grid())), "formulation": {
        "name": "n" * 300, "shape": "log", "argument": "gap", "stiffness_policy": {"name": "fixed"}, "d_hat_m": 0.01}}, "150 bytes"),
    check("mesh-and-hash", one_mesh("m.obj"), "sha256", files={"a.json": bodies(body({"file": "m.obj", "sha256": "0" * 64})), "m.obj": SQUARE}),
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

# --- queries

QUERIES = [
    query("not-json", "kind\n", "not JSON"),
    query("an-array", "[1]\n", "not an object"),
    query("zero-bytes", "\0\0\n", "not JSON"),
    query("no-utf8", b'{"kind": "\xff"}\n', "not JSON"),
    query("long-id", '{"id": %s, "kind": "rho", "shape": "cubic", "u": 0.5}\n' % ("9" * 400), "error"),
    query("id-of-30-digits", '{"id": %s, "kind": "rho", "shape": "cubic", "u": 0.5}\n' % ("9" * 30), '"id":' + "9" * 30, code=DONE),
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


def small_files() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))


SHORT = ("run", BLOCK, "--set", "/time/steps=1", "--out", "out")
OUTPUTS = [
    Case("stderr-closed", ("check", BLOCK, "--set", "/time/dt_s=-1"), prepare=no_stderr),
    Case("stderr-full", ("check", BLOCK, "--set", "/time/dt_s=-1"), prepare=full_stderr),
    Case("stderr-full-plugin", ("--plugin", "nowhere.so", "list"), prepare=full_stderr),
    Case("files-of-4000-bytes", SHORT, code=INTERRUPTED_OR_FULL, says=("File too large",), prepare=small_files, writes=("out",)),
    Case("out-run-json-a-fifo", SHORT, {"out/run.json": fifo}, code=DONE, writes=("out",)),
    Case("out-run-json-nested", SHORT, {"out/run.json": nested(DEEP)}, code=DONE, writes=("out",)),
    Case("out-a-file", SHORT, {"out": "text"}, says=("out",)),
    Case("run-a-nested-record", ("run", "r.json", "--out", "out"), {"r.json": '{"schema": {"name": "barrierbench.run"}, "x": ' + nested(DEEP) + "}"},
         says=("64 levels",)),
]

CASES = [*FILES, *JSON, *OVERRIDES, *NUMBERS, *SWEEPS, *MESHES, *SCENE_CASES, *PLUGINS, *QUERIES, *MATRICES, *OUTPUTS]

"""JSON that the program reads: configs and sweep files, overrides, numbers of options, queries."""

from tests.hostile.case import DEEP, DONE, HUGE, Case, check, dry, override, query
from tests.hostile.files import BLOCK, bodies, body, config, grid, nested, sweep

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
    *(override(f"size-{pointer.split('/')[-1]}-{value}", f"{pointer}={value}", f"{pointer}: found {value.replace('e308', 'e+308')}; allowed: a number >= {allowed}")
      for pointer, allowed in (("/time/dt_s", "1e-18 and <= 1e+09 (s)"), ("/formulation/d_hat_m", "1e-15 and <= 1e+15 (m)"),
                               ("/formulation/stiffness_policy/kappa_N_per_m", "1e-36 and <= 1e+18 (N/m)"), ("/friction/eps_v_m_per_s", "1e-15 and <= 1e+12 (m/s)"),
                               ("/step_solver/tol_velocity_m_per_s", "1e-15 and <= 1e+12 (m/s)"), ("/matching/load_N", "1e-36 and <= 1e+18 (N)"), ("/scene/mass_kg", "1e-36 and <= 1e+18 (kg)"))
      for value in ("1e308", "5e-324")),
    override("size-jitter", "/seeds/jitter_m=1e308", "found 1e+308; allowed: 0, or a number >= 1e-15 and <= 1e+15 (m)"),
    override("long", "/time/" + "x" * 100_000 + "=1", "unknown key"),
    override("long-value", "/formulation/name=" + "x" * 100_000, "/formulation/name"),
]

NUMBERS = [
    Case(f"option-{verb[0]}-{option.strip('-')}-{text}", (*verb, option, text), says=(option, text))
    for verb, option in ((("explain", BLOCK), "--contacts"), (("explain", BLOCK), "--blocks-per-contact"), (("explain", BLOCK), "--candidates-per-contact"),
                         (("run", BLOCK, "--out", "out"), "--time-limit"), (("run", BLOCK, "--out", "out"), "--progress-every"), (("matrix", "a.mtx"), "--tol"))
    for text in ("nan", "inf", "-inf", "1e400", "-1")
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

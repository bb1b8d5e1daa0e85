"""docs/reference: pages that are made from what the program prints are those that are committed, and leave nothing out."""

import json
import re
import subprocess

import pytest

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.pages.reference import MARK, fields, kinds, make, settings, text
from barrierbench_analysis.program import verbs

HELP = """every setting of a config: name, default, what is allowed; below it what it means

/: All of it.
  name                                                a string
                             A label.

/time: Length of the run.
  dt_s                       0.01                     a number >= 1e-18 and <= 1e+09 (s)
                             Time step, 1 < 2 and *all* of <NAME>.
  near_obstacles_factor_per_s factor_per_s             a number > 0 and <= 1
  axis                       x, where the model or shrinking has a direction an array of 3 numbers, not all 0
                             Direction.
"""


def test_settings_are_read_by_their_columns():
    root, time = settings.places(HELP)
    assert (root.pointer, root.meaning, [s.name for s in root.settings]) == ("/", "All of it.", ["name"])
    dt, near, axis = time.settings
    assert (dt.default, dt.allowed, dt.unit) == ("0.01", "a number >= 1e-18 and <= 1e+09", "s")
    assert (near.default, near.allowed, near.meaning) == ("factor_per_s", "a number > 0 and <= 1", "")
    assert (axis.default, axis.allowed) == ("x, where the model or shrinking has a direction", "an array of 3 numbers, not all 0")
    assert r"1 < 2 and \*all\* of &lt;NAME>" in text.place_block(time)
    for wrong in ("what is this", f"  {'name':<26} what is this"):
        with pytest.raises(UserError, match="what is this"):
            settings.places(f"first line\n/: All.\n{wrong}\n")


def test_fields_are_read_by_their_columns():
    found = fields.fields("schema              what the file is\nids.build_id        of the executable\nmem_bytes    bytes  memory\ndt_s         s      time step [or null: nan]\n")
    assert [(f.name, f.unit, f.meaning) for f in found][2:] == [("mem_bytes", "bytes", "memory"), ("dt_s", "s", "time step [or null: nan]")]
    with pytest.raises(UserError, match="found 'alone'"):
        fields.fields("alone\n")


def test_the_pages_are_what_the_program_prints(program):
    made = make.made()
    assert len(made) > 15 and all(page.splitlines()[1] == MARK and page.count("\n") <= 300 for page in made.values())
    assert make.stale(ROOT) == []


def test_a_page_that_is_edited_left_over_or_lost_is_told(program, tmp_path):
    wanted = make.write(tmp_path)
    assert make.stale(tmp_path) == [] and make.write(tmp_path) == [] and len(wanted) == len(make.kept(tmp_path))
    eval_page, sweep = (tmp_path / make.FOLDER / name for name in ("eval.md", "sweep.md"))
    eval_page.write_text(eval_page.read_text().replace("metres", "feet"))
    sweep.unlink()
    (tmp_path / make.FOLDER / "old.md").write_text(f"# Old\n{MARK}\n")
    (tmp_path / make.FOLDER / "by_hand.md").write_text("# By hand\n")
    assert [line.partition(": ")[0].rpartition("/")[2] for line in make.stale(tmp_path)] == ["eval.md", "old.md", "sweep.md"]
    assert len(make.write(tmp_path)) == 3 and make.stale(tmp_path) == [] and (tmp_path / make.FOLDER / "by_hand.md").exists()


def pages(name: str) -> str:
    return "".join(page for path, page in make.kept(ROOT).items() if path.startswith(f"{make.FOLDER}/{name}"))


EARLIER = re.compile("The earlier name of ")  # a setting that pages name as it is called now


def keys(node: dict) -> set[str]:
    """Names of all properties of a JSON Schema."""
    found = {name for name, one in node.get("properties", {}).items() if not EARLIER.match(one.get("description", "") if isinstance(one, dict) else "")}
    below = [*node.get("properties", {}).values(), *node.get("oneOf", []), *node.get("anyOf", []), *([node["items"]] if "items" in node else [])]
    return found.union(*(keys(one) for one in below if isinstance(one, dict)))


@pytest.mark.parametrize(("name", "least"), [("config", 250), ("sweep", 20)])
def test_no_key_of_the_schema_is_left_out(program, name, least):
    schema = json.loads(subprocess.run([program, "help", name, "--schema"], capture_output=True, text=True, check=True).stdout)
    told = set(re.findall(r"^\| `(\w+)` \|", pages(name), re.M)) | set(re.findall(r"[/`](\w+)", " ".join(re.findall(r"^## (.*)$", pages(name), re.M))))
    assert len(keys(schema)) > least and keys(schema) - told == set()


def test_no_field_kind_or_verb_is_left_out(program):
    record = subprocess.run([program, "help", "record"], capture_output=True, text=True, check=True).stdout
    names = {field.name for field in fields.fields(record)}
    told = set(re.findall(r"^(?:\| |## )`([^`]+)`", pages("record"), re.M))
    assert len(names) > 500 and names - told - {f"{name}[]" for name in told} == set()
    schema = json.loads(subprocess.run([program, "eval", "--schema"], capture_output=True, text=True, check=True).stdout)
    found = [name for name, _, _ in kinds.kinds(schema)]
    assert len(found) >= 13 and found == re.findall(r"^## `(\w+)`", pages("eval"), re.M)
    lines = re.findall(r"^\| `./bench (.*)$", pages("verbs"), re.M)
    assert len(lines) == len(verbs.every()) > 50
    assert [verb.name for verb in verbs.every() if not any(re.match(rf"{verb.name}[` ]", line) for line in lines)] == []

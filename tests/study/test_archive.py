"""A study as one file: the same pages and verdicts as of its folder, and refusals by name."""

import json
import re
import shutil
import zipfile

import pytest
from study_files import edit

from analysis.errors import UserError
from analysis.figures import verb as figures
from analysis.gate import compare
from analysis.report import verb as report
from analysis.study import archive, archive_verb
from analysis.study.archive import MANIFEST, SCHEMA, packed, study
from analysis.sweeps import collect


@pytest.fixture
def file(kept_study, tmp_path):
    packed(kept_study, tmp_path / "study.zip")
    return tmp_path / "study.zip"


def rewritten(file, change, out):
    """Another archive: `change` takes name -> bytes."""
    with zipfile.ZipFile(file) as old:
        content = {name: old.read(name) for name in old.namelist()}
    change(content)
    with zipfile.ZipFile(out, "w") as new:
        for name, data in content.items():
            new.writestr(name, data)
    return out


def of_manifest(change):
    def changed(content):
        data = json.loads(content[MANIFEST])
        change(data)
        content[MANIFEST] = json.dumps(data).encode()
    return changed


def test_it_holds_every_file_and_the_same_files_make_the_same_bytes(kept_study, file, tmp_path):
    lines = packed(kept_study, tmp_path / "again.zip")
    assert (tmp_path / "again.zip").read_bytes() == file.read_bytes()
    there = sorted(path.relative_to(kept_study).as_posix() for path in kept_study.rglob("*") if path.is_file())
    assert [line["path"] for line in lines] == there and len(there) >= 10
    with study(file) as (folder,):
        assert folder.name == "study" and all((folder / name).read_bytes() == (kept_study / name).read_bytes() for name in there)
    assert not folder.exists()


def test_a_folder_is_taken_as_it_is(kept_study):
    with study(kept_study) as (folder,):
        assert folder == kept_study


def test_the_verb_says_what_it_holds(kept_study, tmp_path, capsys):
    assert archive_verb.main([str(kept_study), str(tmp_path / "a.zip")]) == 0
    assert "4 records" in capsys.readouterr().out
    assert archive_verb.main([str(kept_study), str(tmp_path / "a.tar")]) == 2 and ".zip is needed" in capsys.readouterr().err
    (tmp_path / "empty").mkdir()
    assert archive_verb.main([str(tmp_path / "empty"), str(tmp_path / "b.zip")]) == 2 and "no run.json below" in capsys.readouterr().err
    assert not (tmp_path / "b.zip").exists()


def test_compare_takes_it_for_the_folder(kept_study, file, tmp_path, capsys):
    assert compare.main([str(kept_study), str(file)]) == 0
    assert compare.main([str(file), str(file)]) == 0
    other = shutil.copytree(kept_study, tmp_path / "other")
    for record in other.glob("*/run.json"):
        edit(record, ("summary", "newton_iterations"), 10**6)
    packed(other, tmp_path / "other.zip")
    capsys.readouterr()
    assert compare.main([str(file), str(tmp_path / "other.zip")]) == 1
    assert "newton" in capsys.readouterr().out


def test_a_report_of_it_is_that_of_the_folder(kept_study, file, tmp_path, capsys):
    assert report.main([str(file), "--players", "0"]) == 0
    page = tmp_path / "study.report.html"
    assert page.is_file() and str(page) in capsys.readouterr().out
    assert report.main([str(kept_study), "--players", "0", "--out", str(tmp_path / "folder.html")]) == 0
    of_archive, of_folder = (re.findall("<td[^>]*>(.*?)</td>", path.read_text()) for path in (page, tmp_path / "folder.html"))
    same = [a == b for a, b in zip(of_archive, of_folder, strict=True)]
    assert len(same) > 40 and sum(same) >= len(same) - 8  # commands name the place of a record
    assert report.main([str(file), str(kept_study), "--out", str(tmp_path / "two.html")]) == 0


def test_figures_and_tables_of_it_are_those_of_the_folder(kept_study, file, tmp_path, capsys, unpainted):
    assert figures.main([str(file)]) == figures.main([str(kept_study), str(tmp_path / "figures")])
    made = {path.name: path for path in (tmp_path / "study.figures").iterdir()}
    assert len(made) > 5 and made.keys() == {path.name for path in (tmp_path / "figures").iterdir()}
    for name in (name for name in made if name.endswith(".csv")):
        assert made[name].read_bytes() == (tmp_path / "figures" / name).read_bytes(), name
    assert collect.main([str(file), str(tmp_path / "a.csv")]) == 0 and collect.main([str(kept_study), str(tmp_path / "b.csv")]) == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


@pytest.mark.parametrize("change, says", [
    (of_manifest(lambda data: data.update(schema="barrierbench.archive/2")), "archive.json#/schema: found 'barrierbench.archive/2'"),
    (lambda content: content.pop(MANIFEST), "no archive.json in it"),
    (lambda content: content.update({MANIFEST: b"{"}), "no archive.json in it that can be read"),
    (lambda content: content.update({"sweep.json": content["sweep.json"].replace(b"own", b"owm")}), "sweep.json with sha256"),
    (lambda content: content.update({"sweep.json": b""}), "sweep.json of 0 bytes"),
    (lambda content: content.pop("cases.json"), "differ in 'cases.json'"),
    (lambda content: content.update({"more.txt": b"x"}), "differ in 'more.txt'"),
])
def test_another_version_and_what_is_damaged_are_refused(file, tmp_path, capsys, change, says):
    bad = rewritten(file, change, tmp_path / "bad.zip")
    for verb, words in ((compare, [bad, bad]), (report, [bad]), (figures, [bad]), (collect, [bad, tmp_path / "t.csv"])):
        assert verb.main([str(word) for word in words]) == 2
        said = capsys.readouterr().err
        assert says in said and str(bad) in said and f"allowed: an archive of ./bench archive ({SCHEMA})" in said
    assert not (tmp_path / "t.csv").exists()


def test_a_name_that_leads_out_is_refused(file, tmp_path):
    def outside(content):
        content["../evil"] = b"x"
        of_manifest(lambda data: data["files"].append({"path": "../evil", "bytes": 1, "sha256": "0" * 64}))(content)
    with pytest.raises(UserError, match="leads out"), study(rewritten(file, outside, tmp_path / "bad.zip")):
        pass
    assert not archive._stays_inside("/a") and not archive._stays_inside("a/../../b") and archive._stays_inside("a/b")


def test_a_torn_file_is_no_archive(file, tmp_path, capsys):
    torn = tmp_path / "torn.zip"
    torn.write_bytes(file.read_bytes()[:-2000])
    assert report.main([str(torn)]) == 2 and "found a file" in capsys.readouterr().err

"""A study as one file: the same pages and verdicts as of its folder, and refusals by name."""

import json
import os
import re
import shutil
import socket
import subprocess
import sys
import zipfile
from pathlib import Path
from urllib.parse import unquote

import pytest
from study_files import edit

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.figures.plots import verb as figures
from barrierbench_analysis.studies.gate import compare
from barrierbench_analysis.pages.report import verb as report
from barrierbench_analysis.tables import archive
from barrierbench_analysis.studies.archives import archive_verb, verify
from barrierbench_analysis.tables.archive import MANIFEST, SCHEMA, packed, study
from barrierbench_analysis.tables.sweeps import collect


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


def test_an_archive_that_was_unpacked_is_packed_again_to_the_same_bytes(file, tmp_path):
    with zipfile.ZipFile(file) as old:
        old.extractall(tmp_path / "study")
    assert (tmp_path / "study" / MANIFEST).is_file()
    packed(tmp_path / "study", tmp_path / "again.zip")
    assert (tmp_path / "again.zip").read_bytes() == file.read_bytes()
    with study(tmp_path / "again.zip") as (folder,):
        assert len(list(folder.glob("*/run.json"))) == 4


def test_a_folder_that_a_run_is_in_is_refused(kept_study, tmp_path, capsys):
    """One whose process is gone has left its lock there, which is not packed."""
    mine = shutil.copytree(kept_study, tmp_path / "mine")
    place = next(mine.glob("*/run.json")).parent
    lock = place / archive.LOCK
    lock.write_text(f"process {os.getpid()} on {socket.gethostname()} since 2026-01-01T00:00:00Z")
    assert archive_verb.main([str(mine), str(tmp_path / "a.zip")]) == 2
    said = capsys.readouterr().err
    assert f"{place}: found process {os.getpid()} on" in said and "at work in it; allowed: a folder that no run is in" in said
    assert not (tmp_path / "a.zip").exists()
    gone = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, text=True, check=True).stdout.strip()
    lock.write_text(f"process {gone} on {socket.gethostname()} since 2026-01-01T00:00:00Z")
    assert archive_verb.main([str(mine), str(tmp_path / "a.zip")]) == 0
    assert archive.LOCK not in {Path(line["path"]).name for line in archive.read_manifest(tmp_path / "a.zip")}


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
    text = page.read_text()
    of_archive, of_folder = (re.findall("<td[^>]*>(.*?)</td>", one) for one in (text, (tmp_path / "folder.html").read_text()))
    unlike = [(a, b) for a, b in zip(of_archive, of_folder, strict=True) if a != b]
    names = sorted(path.parent.name for path in kept_study.glob("*/run.json"))
    assert len(of_folder) > 40 and len(unlike) == 2 * len(names)
    assert sorted(a for a, b in unlike if "<a href=" in b) == [f"{name}/run.json" for name in names]  # its place in the archive
    assert [a for a, b in unlike if "data-copy=" in b] == ["-"] * len(names)  # no verb runs a record that is in an archive
    assert_names_no_scratch(text, file)
    for two, others in (("two", [kept_study]), ("archives", [file])):
        assert report.main([str(file), *map(str, others), "--out", str(tmp_path / f"{two}.html")]) == 0
        assert_names_no_scratch((tmp_path / f"{two}.html").read_text(), file)
    assert report.main([str(kept_study), str(file), "--out", str(tmp_path / "two.html")]) == 0
    assert_names_no_scratch((tmp_path / "two.html").read_text(), file)


def assert_names_no_scratch(page: str, file) -> None:
    """Nothing of the folder that an archive was unpacked into: links and commands are of files that stay."""
    assert "barrierbench-study-" not in page and re.search(f"<code>./bench report [^<]*{re.escape(str(file))}", page)
    links = [link for link in re.findall('href="([^"]*)"', page) if not link.startswith(("#", "data:"))]
    assert all((file.parent / unquote(link)).is_file() for link in links)


def test_what_cannot_be_read_in_an_archive_is_named_as_it_is_there(kept_study, tmp_path):
    mine = shutil.copytree(kept_study, tmp_path / "mine")
    one, two, *_ = sorted(mine.glob("*/run.json"))
    one.write_text("{")
    (two.parent / "trace.jsonl").unlink()
    packed(mine, tmp_path / "mine.zip")
    assert report.main([str(tmp_path / "mine.zip"), "--players", "0"]) == 0
    text = (tmp_path / "mine.report.html").read_text()
    assert "barrierbench-study-" not in text and f">{one.parent.name}/run.json: not JSON" in text and f">{two.parent.name}/trace.jsonl: " in text
    assert report.main([str(mine), "--players", "0"]) == 0 and f"{one}: not JSON" in (mine / "report.html").read_text()


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
    (of_manifest(lambda data: data["files"][0].pop("bytes")), "without 'bytes'"),
    (of_manifest(lambda data: data["files"][0].pop("sha256")), "without 'sha256'"),
    (of_manifest(lambda data: data["files"][0].update(sha256=1)), "without 'sha256'"),
    (of_manifest(lambda data: data["files"].append("a")), "without 'path'"),
    (of_manifest(lambda data: data.update(files=7)), "no archive.json in it that can be read"),
    (of_manifest(lambda data: data["files"].append(data["files"][0])), "differ in"),
    (lambda content: content.pop("cases.json"), "differ in 'cases.json'"),
    (lambda content: content.update({"more.txt": b"x"}), "differ in 'more.txt'"),
])
def test_another_version_and_what_is_damaged_are_refused(file, tmp_path, capsys, change, says):
    bad = rewritten(file, change, tmp_path / "bad.zip")
    for verb, words in ((compare, [bad, bad]), (report, [bad]), (figures, [bad]), (collect, [bad, tmp_path / "t.csv"])):
        assert verb.main([str(word) for word in words]) == 2
        said = capsys.readouterr().err
        assert says in said and str(bad) in said and f"allowed: an archive of ./bench data archive ({SCHEMA})" in said
    assert not (tmp_path / "t.csv").exists()


def with_entries(file, out, offset: int, value: int, name: bytes):
    """An archive whose headers of an entry say something else: `offset` in its local header, +2 in that of the directory."""
    data = bytearray(file.read_bytes())
    at = data.index(name) - 30, data.rindex(name) - 46
    assert data[at[0] : at[0] + 4] == b"PK\x03\x04" and data[at[1] : at[1] + 4] == b"PK\x01\x02"
    for place in (at[0] + offset, at[1] + offset + 2):
        data[place] = value
    out.write_bytes(data)
    return out


@pytest.mark.parametrize("name", ["sweep.json", MANIFEST])
@pytest.mark.parametrize("offset, value", [(6, 1), (8, 77)])  # the flag of encryption, the method
def test_an_encrypted_entry_and_an_unknown_method_are_refused(file, tmp_path, capsys, offset, value, name):
    bad = with_entries(file, tmp_path / "bad.zip", offset, value, name.encode())
    for verb, words in ((compare, [bad, bad]), (verify, [bad]), (report, [bad]), (figures, [bad]), (collect, [bad, tmp_path / "t.csv"])):
        assert verb.main([str(word) for word in words]) == 2
        said = capsys.readouterr().err
        assert name in said and "can" in said and "be read" in said and f"allowed: an archive of ./bench data archive ({SCHEMA})" in said


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

"""What the build refuses: an include of a module that is not named, a module named for nothing, a circle, a file of core that includes one from outside."""
import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(not shutil.which("cmake"), reason="cmake is not here")


def check(folder: Path, modules: str, files: dict[str, str]) -> subprocess.CompletedProcess:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    (folder / "modules.txt").write_text(modules)
    return subprocess.run(["cmake", f"-DMODULES={folder}/modules.txt", f"-DSOURCE_DIR={folder}", "-DPRINT=ON",
                           "-P", str(ROOT / "cmake/ModuleCheck.cmake")],
                          capture_output=True, text=True, env={**os.environ, "COLUMNS": "200"}, check=False)


LOW = {"core/low/a.hpp": "#pragma once\n"}
HIGH = {"core/high/b.cpp": '#include <vector>\n#include "core/low/a.hpp"\n'}


def test_a_declared_include_passes_and_the_graph_is_printed(tmp_path):
    done = check(tmp_path, "low|core/low|-\nhigh|core/high|low\n", LOW | HIGH)
    assert done.returncode == 0, done.stderr
    assert [line.split()[0] for line in done.stdout.splitlines() if "files" in line] == ["low", "high"]


@pytest.mark.parametrize("modules, files, words", [
    ("low|core/low|-\nhigh|core/high|-\n", LOW | HIGH, ["core/high/b.cpp", "core/low/a.hpp", "'low'"]),
    ("low|core/low|-\nhigh|core/high|low\n", LOW | {"core/high/b.cpp": "int b;\n"}, ["core/high", "includes nothing"]),
    ("low|core/low|high\nhigh|core/high|low\n", HIGH | {"core/low/a.hpp": '#include "core/high/b.hpp"\n'},
     ["circle", "low", "high"]),
    ("low|core/low|-\nhigh|core/high|-\n", LOW | {"core/high/list.inc": '#include "core/low/a.hpp"\n'},
     ["core/high/list.inc", "'low'"]),
    ("low|core/low|-\nnone|core/none|-\n", HIGH | LOW, ["core/none", "no files"]),
    ("log|barriers|-\nhigh|core/high|log\n", {"barriers/log.hpp": "", "core/high/b.cpp": '#include "barriers/log.hpp"\n'},
     ["core/high/b.cpp: includes barriers/log.hpp", "core alone"]),
], ids=["undeclared", "unused", "circle", "list", "empty", "core"])
def test_what_is_not_declared_is_refused(tmp_path, modules, files, words):
    done = check(tmp_path, modules, files)
    assert done.returncode != 0
    text = " ".join(done.stderr.split())
    for word in words:
        assert word in text


def test_links_that_no_include_shows_are_printed(tmp_path):
    modules = "low|core/low|-|high,low\nhigh|core/high|low|low\nover|core/over|-|-\nover_in|core/over/in|-|-\n"
    more = {"core/over/c.hpp": "", "generated/core/over/c.cpp": '#include "core/high/b.hpp"\n#include "core/over/c.hpp"\n',
            "core/over/in/d.hpp": "", "generated/core/over/in/d.cpp": '#include "core/low/a.hpp"\n'}
    done = check(tmp_path, modules, LOW | HIGH | more)
    assert done.returncode == 0, done.stderr
    lines = {line.split()[0]: line.split("<-")[1].split() for line in done.stdout.splitlines() if "<-" in line}
    assert lines == {"low": ["linked:", "high"], "high": ["low"], "over": ["generated:", "high"], "over_in": ["generated:", "low"]}

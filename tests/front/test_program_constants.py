"""Numbers and words that the Python package has in common with the C++ of the program: each is read from the source that
decides it, so a change of one side alone fails here. Words of outcomes and of errno: test_words.py, test_full_disk.py."""
import importlib
import inspect
import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = "barrierbench_analysis"
NUMBER = r"([-\d.e]+(?: \* \([^)]*\))?)"
SHIFTED = r"std::uint64_t\{(\d+)\} << (\d+)"
COPIES = [  # module, name, file, what stands there
    ("tables.gap_rule", "LEAST_LOAD_SHARE", "experiments/run/comparability.cpp", rf"least_load_share = {NUMBER}"),
    ("tables.gap_rule", "LEAST_TIME_SHARE", "experiments/run/comparability.cpp", rf"least_time_share = {NUMBER};"),
    ("tables.gap_rule", "NO_LOAD", "experiments/run/comparability.cpp", rf"found == gaps.end\(\) \? {NUMBER} :"),
    ("tables.gap_rule", "MAX_RATIO", "core/base/record/judged_record.hpp", rf"of every pair with load is\"\) = {NUMBER};"),
    ("tables.records", "LARGEST_COND", "core/linear/condition.hpp", rf"largest_known_cond = {NUMBER};"),
    ("studies.gate.matrices", "LARGEST_COND", "core/linear/condition.hpp", rf"largest_known_cond = {NUMBER};"),
    ("studies.rules.gap_map.measured", "LARGEST", "core/linear/condition.hpp", rf"largest_known_cond = {NUMBER};"),
    ("studies.gate.matrices", "PCG_TOLERANCE", "experiments/run/pcg_probe.cpp", rf"\"tol_rel\", {NUMBER}\}}"),
    ("studies.gate.matrices", "LARGEST_DENSE", "experiments/matrix/replay.hpp", rf"dense_rows = {NUMBER};"),
    ("figures.plots.matrices", "TOLERANCE", "experiments/run/pcg_probe.cpp", rf"\"tol_rel\", {NUMBER}\}}"),
    ("figures.plots.kappa_cycle", "SETTLED", "core/terms/report.cpp", rf"settled_kappa = {NUMBER};"),
    ("figures.plots.kappa_cycle", "UNSETTLED_ITERATIONS", "core/terms/report.cpp", rf"unsettled_iterations = {NUMBER};"),
    ("program.formula.grammar", "MOST_CHARACTERS", "barriers/formulas.hpp", rf"most_formula_bytes = {NUMBER};"),
    ("program.formula.accuracy", "MOST_ERROR", "barriers/stiffness/formula.hpp", rf"largest_slope_error =\s+{NUMBER};"),
    ("program.trajectories.trajectory", "MOST_METRES", "experiments/judge/subject.cpp", rf"most_metres = {NUMBER};"),
    ("io.cases", "DEAD_AFTER_S", "core/base/record/folder_lock.hpp", rf"dead_after_s = {NUMBER};"),
    ("io.errors", "BAD_INPUT", "experiments/cli/verbs.hpp", rf"exit_bad_input = {NUMBER};"),
    ("io.errors", "TRY_AGAIN", "experiments/cli/verbs.hpp", rf"exit_try_again = {NUMBER};"),
    ("studies.judge.ask", "CROSSED", "experiments/cli/verbs.hpp", rf"exit_not_clean = {NUMBER};"),
    ("studies.judge.ask", "CLEAN", "experiments/cli/verbs.hpp", rf"exit_ok = {NUMBER};"),
    ("studies.engines.launch", "REFUSED", "engines/common.py", rf"^REFUSED = {NUMBER}"),
    ("io.input_file", "SMALL", "core/base/input/read_file.hpp", rf"config_file\{{[^;]*{SHIFTED}"),
    ("io.input_file", "SMALL", "core/base/input/read_file.hpp", rf"sweep_file\{{[^;]*{SHIFTED}"),
    ("io.input_file", "TABLE", "core/base/input/read_file.hpp", rf"record_file\{{[^;]*{SHIFTED}"),
    ("io.input_file", "LARGE", "core/base/input/read_file.hpp", rf"mesh_file\{{[^;]*{SHIFTED}"),
    ("io.input_file", "LARGE", "core/base/input/read_file.hpp", rf"matrix_file\{{[^;]*{SHIFTED}"),
    ("pages.reference.settings", "NAME_WIDTH", "experiments/cli/help.cpp", r"fmt::format\(\"  \{:<(\d+)\} \{:<\d+\} \{\}\""),
    ("pages.reference.settings", "DEFAULT_WIDTH", "experiments/cli/help.cpp", r"fmt::format\(\"  \{:<\d+\} \{:<(\d+)\} \{\}\""),
]
WORDS = [  # module, name, file, what one word looks like there, from where on
    ("tables.gap_rule", "QUANTILES", "experiments/run/comparability.cpp", r"\{\"(\w+)\", \"[^\"]+\", &PairGaps", "quantiles[]"),
    ("studies.gate.records", "NOT_FINITE", "core/base/record/number.hpp", r"\"(\w+)\"", "static const char* word(double v)"),
    ("program.mesh_arrays", "SUFFIXES", "core/model/mesh/read_mesh.cpp", r"extension == \"(\.\w+)\"", ""),
    ("io.cases", "CHECKPOINT", "experiments/run/checkpoint.cpp", r"folder / \"(checkpoint\.[\w.]+)\"", ""),
]


def of_python(module: str, name: str):
    return getattr(importlib.import_module(f"{PACKAGE}.{module}"), name)


def value_of(groups: tuple[str, ...]) -> float:
    if len(groups) == 2:
        return int(groups[0]) << int(groups[1])
    factor, _, difference = groups[0].partition(" * (1 - ")
    return float(factor) * (1 - float(difference[:-1])) if difference else float(factor)


@pytest.mark.parametrize(("module", "name", "file", "pattern"), COPIES, ids=[f"{m}.{n}-{Path(f).stem}-{k}" for k, (m, n, f, _) in enumerate(COPIES)])
def test_a_number_that_stands_twice_is_one(module, name, file, pattern):
    found = {match.groups() for match in re.finditer(pattern, (ROOT / file).read_text(), re.MULTILINE)}
    assert len(found) == 1, f"{file}: found {found or 'nothing'} of {pattern}"
    assert of_python(module, name) == value_of(found.pop()), f"{module}.{name} is not what {file} has"


@pytest.mark.parametrize(("module", "name", "file", "pattern", "begin"), WORDS, ids=[f"{m}.{n}" for m, n, *_ in WORDS])
def test_words_that_stand_twice_are_the_same(module, name, file, pattern, begin):
    text = (ROOT / file).read_text()
    part = text[text.index(begin):].partition("};" if begin else "\0")[0]
    assert set(re.findall(pattern, part)) == set(of_python(module, name)), f"{module}.{name} is not what {file} has"


def test_the_default_target_gap_is_that_of_the_schema():
    """`help config --schema` of the program is configs/schema/config.schema.json (tests/config/test_config_schema.py)."""
    from barrierbench_analysis.studies.claims.merged import theta_of

    matching = json.loads((ROOT / "configs/schema/config.schema.json").read_text())["properties"]["matching"]["properties"]
    assert theta_of({}) == theta_of({"matching": {"rule": "equal_force"}}) == matching["theta"]["default"]


def test_keys_that_a_policy_of_a_limit_shares_with_that_of_contact():
    from barrierbench_analysis.studies.kit.formulations import OF_LIMIT

    rows = re.findall(r"list\.(?:\w+\(\s*\"(\w+)\"|(refresh)\()", (ROOT / "barriers/stiffness/elasticity_inclusive.hpp").read_text())
    assert set(OF_LIMIT) == {word or own for word, own in rows}


@pytest.mark.parametrize(("shape", "header"), [("exponential", "exponential"), ("minimax_bounded", "minimax_bounded"), ("minimax", "minimax_bounded")])
def test_exponents_of_plain_names_are_those_of_the_shapes(shape, header):
    from barrierbench_analysis.tables.accuracy import shapes

    default = re.search(r"default_exponent = (\d+)", (ROOT / f"barriers/shapes/{header}.hpp").read_text())
    assert inspect.signature(shapes.SHAPES[shape]).parameters["a"].default == float(default[1])

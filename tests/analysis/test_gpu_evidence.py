"""Records of cards from raw files as the script leaves them, and the page of them."""

import dataclasses
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from barrierbench_analysis.studies.device import gpu_evidence, gpu_model, gpu_report, gpu_tables

ROOT = Path(__file__).resolve().parents[2]
PRICES = {"currency": "USD", "cards": [
    {"name": "X100 80 GB", "match": ["X100"], "price_per_hour": 3.0, "as_of": "2026-01-02", "source": "a list"},
    {"name": "Y200", "match": ["Y200"], "price_per_hour": None, "as_of": None, "source": None}]}
NCU = '''==PROF== Connected to process 1
"ID","Process ID","Kernel Name","Metric Name","Metric Unit","Metric Value"
"0","1","void bb::exec::run_blocks<bb::exec::SpmvDot>(T1)","dram__bytes.sum","byte","3,000,000"
"0","1","void bb::exec::run_blocks<bb::exec::SpmvDot>(T1)","gpu__time_duration.sum","ns","2,000"
"1","1","void bb::exec::run_blocks<bb::exec::SpmvDot>(T1)","dram__bytes.sum","byte","3,000,000"
"1","1","void bb::exec::run_blocks<bb::exec::SpmvDot>(T1)","gpu__time_duration.sum","ns","2,000"
"2","1","void bb::exec::run_each<bb::exec::UpdateP>(long, T1)","dram__bytes.sum","byte","1000"
"2","1","void bb::exec::run_each<bb::exec::UpdateP>(long, T1)","gpu__time_duration.sum","ns","9000"
'''


def run_json(outcome="ok"):
    return {"schema": {"name": "barrierbench.run", "version": "3.99.0"}, "status": {"outcome": outcome, "valid": outcome == "ok"}, "scene": {"vertices": 1048576},
            "ids": {"run_id": "1"}, "labels": {"scene": "drape", "formulation": "log", "dt_s": 0.01, "linear_solver": "pcg"}, "steps": [],
            "summary": {"steps": 2, "newton_iterations": 10, "linear_iterations": 500, "wall_s": 4.0, "time": {"linear_solve_s": 2.5, "end_check_s": 2.0}, "contacts": {"max": 7e6}, "state_hash": "0f"}}


@pytest.fixture
def raw(tmp_path):
    folder = tmp_path / "raw"
    (folder / "logs").mkdir(parents=True)
    (folder / "device.json").write_text(json.dumps({"usable": True, "card": "NVIDIA X100 80GB", "driver": "13.0",
                                                    "copy": {"on_the_card_Bps": 3e12, "to_the_card_Bps": 5e10, "from_the_card_Bps": 5e10}}))
    (folder / "card.csv").write_text("name, driver_version, clocks.max.sm [MHz]\nNVIDIA X100 80GB, 580.1, 1980\n")
    (folder / "parts.tsv").write_text("device_tests\tpassed\t0\t3\nmemcheck\tfailed\t9\t20\nracecheck\tleft_out\tcompute-sanitizer was not found\t0\ndense_8m\tfailed\t2\t1\n")
    (folder / "logs/memcheck.err").write_text("a line\n========= ERROR SUMMARY: 3 errors\n")
    (folder / "logs/dense_8m.err").write_text("no memory for matrix values: 9 GiB\n")
    (folder / "logs/kernels.out").write_text(NCU)
    (folder / "logs/device_tests.out").write_text("[  PASSED  ]\nX100: 3 kernels in 9 launches, 9 compared with the host, 0 kernels differ\n")
    for scene, outcome in (("drape_82k", "ok"), ("drape_1m", "ok")):
        (folder / scene).mkdir()
        (folder / scene / "run.json").write_text(json.dumps(run_json(outcome)))
    return folder


def test_a_record_has_what_the_script_saw(raw):
    record = gpu_evidence.collect(raw, "abc", 500)
    assert record["parts"]["memcheck"] == {"status": "failed", "seconds": 20, "why": "========= ERROR SUMMARY: 3 errors"}
    assert record["parts"]["racecheck"]["why"] == "compute-sanitizer was not found"
    assert record["card"]["driver_version"] == "580.1" and record["card"]["clocks.max.sm"] == "1980"
    scene = record["scenes"]["drape_1m"]
    assert (scene["newton_ms"], scene["pcg_ms"], scene["step_s"]) == (400.0, 5.0, 2.0)
    assert record["scenes"]["dense_8m"] is None
    assert [k["name"] for k in record["kernels"]] == ["bb::exec::UpdateP", "bb::exec::SpmvDot"]
    assert record["kernels"][1] == {"name": "bb::exec::SpmvDot", "launches": 2, "idle": 0, "seconds": pytest.approx(4e-6), "bytes": 6e6, "Bps": pytest.approx(1.5e12)}


def test_kernels_of_a_library_are_named_without_what_they_are_templates_of():
    assert gpu_evidence.functor("void radix_sort::Onesweep<policy<unsigned, cub::Null>, int>(T7 *, int)") == "radix_sort::Onesweep"
    assert gpu_evidence.functor("void bb::exec::run_each<bb::A<bb::B>>(long, T1)") == "bb::A<bb::B>"


def row_of(name, number, n_bytes, ns):
    kernel = f'"{number}","1","void bb::exec::run_blocks<bb::exec::{name}>(T1)"'
    return f'{kernel},"dram__bytes.sum","byte","{n_bytes}"\n{kernel},"gpu__time_duration.sum","ns","{ns}"\n'


def test_launches_after_the_end_of_a_solve_are_not_in_the_means(raw, tmp_path, capsys):
    """A graph of iterations goes on when its solve is over; a kernel of another kind may have small launches that work."""
    launches = [("MultiplyDot", 80e6, 50000)] * 2 + [("MultiplyDot", 1000, 2000)] * 2 + [("Sort", 9e6, 3000), ("Sort", 1000, 1000)]
    (raw / "logs/kernels.out").write_text(NCU.splitlines()[1] + "\n" + "".join(row_of(name, k, n, ns) for k, (name, n, ns) in enumerate(launches)))
    found = {kernel["name"].split("::")[-1]: kernel for kernel in gpu_evidence.collect(raw, "", 1)["kernels"]}
    assert found["MultiplyDot"] == {"name": "bb::exec::MultiplyDot", "launches": 2, "idle": 2, "seconds": pytest.approx(1e-4), "bytes": 160e6, "Bps": pytest.approx(1.6e12)}
    assert (found["Sort"]["launches"], found["Sort"]["idle"]) == (2, 0)
    assert "| `bb::exec::MultiplyDot` | 2 | 2 | 50 | 1,600 | 53 % |" in page(raw, tmp_path, capsys)


def test_a_record_that_cannot_tell_them_apart_has_no_means_of_such_kernels():
    kernels = [{"name": f"bb::exec::{name}", "launches": 4, "seconds": 1e-4, "bytes": 160e6, "Bps": 1.6e12} for name in ("MultiplyDot", "GatherBlocks")]
    rows = gpu_tables.kernel_rows({"kernels": kernels}, 3.2e12)
    assert rows[0][2:] == ["not known"] * 4 and rows[1][3:] == ["25", "1,600", "50 %"]


def test_rates_are_held_against_the_fastest_copy_of_the_card():
    """A copy that was measured while the clocks were low is slower than kernels."""
    records = [{"device": {"card": card, "copy": {"on_the_card_Bps": rate}}} for card, rate in (("X", 1.4e12), ("X", 3e12), ("Y", 4e12))]
    assert [gpu_tables.copy_rate(record, records) for record in records] == [3e12, 3e12, 4e12]


def test_the_memory_run_of_old_records_had_another_name():
    old = {"scenes": {"dense_184m": None}, "parts": {"dense_184m": {"why": "exit code 137"}}}
    assert gpu_tables._memory_run(old) == "exit code 137"


def test_a_scene_for_a_card_is_named_by_its_vertices():
    """Not by contacts that it has not: one was called after the 184 million of a paper and holds 27 million."""
    named = {path.stem: json.loads(path.read_text())["scene"] for path in (ROOT / "configs/gpu").glob("*.json") if path.stem != "dense_patch"}
    assert len(named) >= 4
    for name, scene in named.items():
        number, unit = re.fullmatch(r"\w+_(\d+)([km])", name).groups()
        assert scene.get("layers", 5) * scene["n"] ** 2 == pytest.approx(int(number) * {"k": 1e3, "m": 1e6}[unit], rel=0.06), name


def test_pages_say_the_contacts_and_bytes_of_the_scene_that_they_name():
    dense, million = gpu_model.SIZES[-1], gpu_model.Size("drape_1m", 1048576, 2e6, "")
    known = gpu_model.read_inputs()
    contacts = gpu_model.contacts(dense, known["dense_patch"])
    assert dense.name == "dense_8m" and f"--contacts {round(contacts, -5):.0f} " in (ROOT / "docs/guides/card.md").read_text()
    page = (ROOT / "docs/device.md").read_text()
    record = json.loads((ROOT / "results/gpu/nvidia_h200-2026-11-26.json").read_text())
    scene = record["scenes"]["drape_1m"]
    patch = dataclasses.replace(known["dense_patch"], contacts_a_vertex=scene["contacts"] / million.vertices)
    moved = gpu_model.solver_bytes(million, patch)
    assert scene["vertices"] == million.vertices and f"with at most {scene['contacts']:.0f} contacts: an iteration of conjugate gradients moves {moved / 1e9:.2f} GB" in page
    assert f"which take {1e3 * moved / record['device']['copy']['on_the_card_Bps']:.2f} ms" in page and f"The record has {scene['pcg_ms']:.3f} ms" in page


def test_without_counters_kernels_have_times_and_no_rates(raw):
    (raw / "logs/kernels.out").write_text("==ERROR== ERR_NVGPUCTRPERM - The user does not have permission\n")
    (raw / "kernel_times.json").write_text('{"schema": "barrierbench.kernel_times/1", "kernels": {"bb::A": {"launches": 4, "seconds": 0.5}}}')
    assert gpu_evidence.collect(raw, "", 1)["kernels"] == [{"name": "bb::A", "idle": None, "launches": 4, "seconds": 0.5, "bytes": None, "Bps": None}]


def test_a_device_without_a_card_is_no_record(raw, capsys):
    (raw / "device.json").write_text('{"usable": false}')
    assert gpu_evidence.main([str(raw)]) == 2
    assert "no usable card" in capsys.readouterr().err


def test_raw_files_of_another_form_are_named(raw):
    (raw / "parts.tsv").write_text("device_tests passed\n")
    with pytest.raises(gpu_evidence.UserError, match="not a part: 'device_tests passed'"):
        gpu_evidence.collect(raw, "", 1)


def page(raw, tmp_path, capsys):
    records = tmp_path / "records"
    assert gpu_evidence.main([str(raw), "--records", str(records), "--commit", "abcdef0123456"]) == 0
    (records / "prices.json").write_text(json.dumps(PRICES))
    assert gpu_report.main(["--records", str(records), "--results", str(tmp_path)]) == 0
    capsys.readouterr()
    return (tmp_path / "GPU.md").read_text()


def test_the_page_has_a_row_a_card(raw, tmp_path, capsys):
    text = page(raw, tmp_path, capsys)
    row = next(line for line in text.splitlines() if line.startswith("| NVIDIA X100"))
    for part in ("580.1", "3,000", "memcheck **failed**; device tests passed", "racecheck, initcheck, synccheck not run", "abcdef0123", "| 5 | 400 | 5 | 400 |", "no memory for matrix values"):
        assert part in row
    assert "| drape_1m | card | ok | 1,048,576 | 7,000,000 | 2 | 10 | 500 | 2 | 400 | 5 | 50 % |" in text
    assert "- device_tests: X100: 3 kernels in 9 launches, 9 compared with the host, 0 kernels differ" in text
    assert "- dense_8m: **failed**: no memory for matrix values: 9 GiB" in text
    assert "| `bb::exec::SpmvDot` | 2 | 0 | 2 | 1,500 | 50 % |" in text
    assert gpu_report.NEVER not in text
    # 2 s a step of 0.01 s: 200 s for a second of the scene, at 3 USD an hour.
    assert "| X100 80 GB | 3 USD (2026-01-02, a list) | 1,800 | 0.167 USD |" in text
    assert "| Y200 | enter yours, with date and source, in results/gpu/prices.json | not measured | not measured |" in text
    assert (tmp_path / "gpu_kernels.png").stat().st_size > 1000


def test_a_run_that_failed_has_no_times(raw, tmp_path, capsys):
    (raw / "drape_1m/run.json").write_text(json.dumps(run_json("timeout")))
    text = page(raw, tmp_path, capsys)
    assert "| 5 | 400 | not measured | not measured |" in text
    assert "1,800" not in text


def test_without_a_record_nothing_was_timed(tmp_path, capsys):
    (tmp_path / "prices.json").write_text(json.dumps(PRICES))
    assert gpu_report.main(["--records", str(tmp_path), "--results", str(tmp_path / "out")]) == 0
    text = (tmp_path / "out/GPU.md").read_text()
    assert gpu_report.NEVER in text and "| X100 80 GB | 3 USD (2026-01-02, a list) | not measured | not measured |" in text
    assert not (tmp_path / "out/gpu_kernels.png").exists()


def test_a_file_of_another_schema_is_refused(tmp_path, capsys):
    (tmp_path / "x.json").write_text('{"schema": "other/1"}')
    (tmp_path / "prices.json").write_text(json.dumps(PRICES))
    assert gpu_report.main(["--records", str(tmp_path), "--results", str(tmp_path)]) == 2
    assert "x.json" in capsys.readouterr().err


def test_prices_that_are_committed_are_whole_or_empty():
    cards = json.loads((ROOT / "results/gpu/prices.json").read_text())["cards"]
    assert len(cards) >= 3
    for card in cards:
        assert len({card[key] is None for key in ("price_per_hour", "as_of", "source")}) == 1


FAKE_BENCH = '''#!/bin/sh
case "$1" in
  device) cat "$RAW/device.json"; exit ${DEVICE_CODE:-0} ;;
  scenes) touch "$4" ;;
  run) while [ "$1" != --out ]; do shift; done; mkdir -p "$2"; cp "$RAW/drape_1m/run.json" "$2" ;;
esac
'''


def script(raw, tmp_path, only="tests,sanitizer,same,catalogue,scenes,memory,kernels", **more):
    bench, tests = tmp_path / "bench", tmp_path / "tests"
    bench.write_text(FAKE_BENCH)
    tests.mkdir()
    for name in ("test_device", "test_formula_log", "test_formula_functions", *(f"test_card_{room}" for room in ("sums", "linear", "elements", "contact", "system", "runs"))):
        (tests / name).write_text(f"#!/bin/sh\n{'echo no such kernel >&2; exit 1' if name == 'test_device' else 'exit 0'}\n")
        (tests / name).chmod(0o755)
    bench.chmod(0o755)
    environment = {**os.environ, "BARRIERBENCH_BENCH": str(bench), "BARRIERBENCH_DEVICE_TESTS": str(tests), "RAW": str(raw), **more}
    return subprocess.run([ROOT / "experiments/gpu_evidence.sh", "--only", only, "--out", tmp_path / "out", "--records", tmp_path / "kept"], capture_output=True, text=True, check=False, env=environment)


def test_the_script_makes_a_record_of_what_passed_and_what_failed(raw, tmp_path):
    done = script(raw, tmp_path)
    assert done.returncode == 0, done.stderr
    record = json.loads(Path(done.stdout.strip()).read_text())
    assert record["parts"]["device_tests"] == {"status": "failed", "seconds": record["parts"]["device_tests"]["seconds"], "why": "no such kernel"}
    assert record["parts"]["drape_82k"]["status"] == "passed" and record["scenes"]["dense_8m"]["vertices"] == 1048576
    assert all(record["parts"][f"card_{room}"]["status"] == "passed" for room in ("contact", "elements", "linear", "runs", "sums", "system"))
    same = {run["name"]: run for run in record["same"]}
    accepted = [file.stem for file in (ROOT / "configs/catalogue").glob("*.json") if not file.stem.startswith("intersect-")]
    assert len(accepted) > 20 and {name for name in same if name.startswith("catalogue_")} == {f"catalogue_{name}" for name in accepted}
    assert len(same) > 10 and same["drape_cubic"]["same_bits"] and same["drape_cubic"]["card"]["newton_iterations"] == 10


def test_runs_that_differ_are_not_the_same(raw):
    for device, state in (("cuda", "a"), ("host", "b")):
        (raw / f"same/sheet.{device}").mkdir(parents=True)
        run = run_json()
        run["summary"]["state_hash"] = state
        (raw / f"same/sheet.{device}/run.json").write_text(json.dumps(run))
    (raw / "same/alone.cuda").mkdir()
    (raw / "same/alone.cuda/run.json").write_text(json.dumps(run_json()))
    found = gpu_evidence.collect(raw, "", 1)["same"]
    assert [(run["name"], run["same_bits"]) for run in found] == [("sheet", False)]
    for device in ("cuda", "host"):
        run["summary"]["state_hash"] = ""
        (raw / f"same/sheet.{device}/run.json").write_text(json.dumps(run))
    assert gpu_evidence.collect(raw, "", 1)["same"][0]["same_bits"] is None  # two unknown states are not the same


def test_the_page_has_a_row_a_run_beside_the_host(raw, tmp_path, capsys):
    for device, steps in (("cuda", 10), ("host", 12)):
        (raw / f"same/sheet.{device}").mkdir(parents=True)
        run = run_json()
        run["summary"]["newton_iterations"] = steps
        (raw / f"same/sheet.{device}/run.json").write_text(json.dumps(run))
    assert "| sheet | 1,048,576 | 2 | ok | 10, host 12 | 500 | 7,000,000 | yes |" in page(raw, tmp_path, capsys)


def test_the_page_has_stages_phases_and_counters_of_a_lease(raw, tmp_path, capsys):
    (raw / "stages.tsv").write_text("tests\t0\t21\t35\ngrowth\t75\t170\t175\n")
    (raw / "logs/counters.out").write_text(NCU.splitlines()[1] + "\n" + "".join(
        f'"0","1","void bb::exec::run_each<bb::exec::RankRows>(long, T1)","{metric}","","{value}"\n'
        for metric, value in (("gpu__time_duration.sum", "4,000"), ("dram__bytes.sum", "3,000,000"), ("l1tex__t_requests_pipe_lsu_mem_global_op_ld.sum", "10"),
                              ("l1tex__t_sectors_pipe_lsu_mem_global_op_ld.sum", "85"), ("launch__registers_per_thread", "138"))))
    run = run_json()
    run["steps"] = [{"wall_s": 9.0, "newton_iterations": 4, "time": {"broad_phase_s": 9.0}}, {"wall_s": 1.0, "newton_iterations": 2, "time": {"broad_phase_s": 0.5, "assembly_s": 0.3}}]
    (raw / "packed_8m.8").mkdir(), (raw / "synchronized").write_text("packed_8m.8\n")
    (raw / "packed_8m.8/run.json").write_text(json.dumps(run))
    text = page(raw, tmp_path, capsys)
    assert "| growth | 75 | 170 | 175 |" in text and "| `bb::exec::RankRows` | 4 | 3 | not measured | 138 | 8.5 | not measured |" in text
    assert "| phase | packed_8m.8, synchronised |" in text and "| broad phase | 250 |" in text and "| assembly | 150 |" in text and "| linear analyze | 0 |" in text
    (record,) = (json.loads(path.read_text()) for path in (tmp_path / "records").glob("nvidia*.json"))
    assert record["scenes"]["packed_8m.8"]["first_step_s"] == 9.0 and len(record["scenes"]["packed_8m.8"]["phases_ms"]) == 17


def test_a_stage_of_another_form_is_named(raw):
    (raw / "stages.tsv").write_text("tests 0 21 35\n")
    with pytest.raises(gpu_evidence.UserError, match="not a stage: 'tests 0 21 35'"):
        gpu_evidence.stages_of(raw)


def test_a_bundle_says_its_commit_and_its_seconds(raw):
    (raw / "commit").write_text("abc\n"), (raw / "seconds").write_text("77\n")
    record = gpu_evidence.collect(raw, "", 0)
    assert (record["git_commit"], record["seconds"]) == ("abc", 77)


def test_parts_that_no_group_asks_for_are_left_out(raw, tmp_path):
    done = script(raw, tmp_path, only="tests")
    assert done.returncode == 0, done.stderr
    assert set(json.loads(Path(done.stdout.strip()).read_text())["parts"]) == {"device_tests", "formula_log", "formula_functions"} | {f"card_{room}" for room in ("contact", "elements", "linear", "runs", "sums", "system")}


def one_run(raw, name, states):
    for device, state in states.items():
        (raw / f"same/{name}.{device}").mkdir(parents=True)
        run = run_json()
        run["summary"]["state_hash"] = state
        (raw / f"same/{name}.{device}/run.json").write_text(json.dumps(run))


def test_a_run_without_the_bits_of_the_host_has_failed(raw, tmp_path, capsys):
    one_run(raw, "sheet", {"cuda": "a", "host": "b"})
    text = page(raw, tmp_path, capsys)
    assert "- sheet: **not the bits of the host**" in text and "may differ" not in text


def test_in_a_record_with_plain_runs_these_have_to_have_them(raw, tmp_path, capsys):
    one_run(raw, "sheet", {"cuda": "a", "host": "b"})
    one_run(raw, "plain_sheet", {"cuda": "a", "host": "b"})
    text = page(raw, tmp_path, capsys)
    assert "- plain_sheet: **not the bits of the host**" in text and "- sheet: **" not in text and "may differ" in text


@pytest.mark.parametrize("words", ["test", "tests,,scene", ""])
def test_groups_that_are_none_are_refused(raw, tmp_path, words):
    done = script(raw, tmp_path, only=words)
    assert done.returncode == 2 and done.stdout == "" and ("of tests, sanitizer, same" in done.stderr or "usage" in done.stderr)
    assert not (tmp_path / "out").exists() and not (tmp_path / "kept").exists()


def test_raw_files_of_another_commit_are_not_mixed(raw, tmp_path):
    assert script(raw, tmp_path, only="tests").returncode == 0
    (tmp_path / "out/commit").write_text("another\n")
    (tmp_path / "bench").unlink(), shutil.rmtree(tmp_path / "tests")
    done = script(raw, tmp_path, only="scenes")
    assert done.returncode == 2 and "of commit another" in done.stderr


def test_the_script_says_why_there_is_no_card(raw, tmp_path):
    done = script(raw, tmp_path, DEVICE_CODE="5")
    assert done.returncode == 5 and done.stdout == ""
    assert not (tmp_path / "kept").exists()

"""A stand-in for the program: it writes records for every case of a sweep file, as a function of the case says."""

import json
import sys
from pathlib import Path

from synthetic import write_run

STAND_IN = """#!{python}
import json, sys
nan, inf = float("nan"), float("inf")
sys.path[:0] = {path!r}
from made_records import write_sweep
write_sweep(sys.argv[2], sys.argv[sys.argv.index("--out") + 1], {gaps!r}, {edits!r})
"""


def install(tmp_path: Path, monkeypatch, gaps: dict, edits: dict | None = None) -> None:
    """gaps: start of a label -> gap of its run (None: no contact); edits: start of a label -> {pointer: value} put into its record."""
    path = tmp_path / "stand-in"
    here = Path(__file__).parent
    path.write_text(STAND_IN.format(python=sys.executable, path=[str(here), str(here.parent / "analysis"), str(here.parents[1])], gaps=gaps, edits=edits or {}))
    path.chmod(0o755)
    monkeypatch.setenv("BARRIERBENCH_PROGRAM", str(path))


def _of(label: str, table: dict, default):
    return next((table[key] for key in sorted(table, key=len, reverse=True) if label.startswith(key)), default)


def _put(record: dict, pointer: str, value) -> None:
    *way, last = pointer.strip("/").split("/")
    for name in way:
        record = record.setdefault(name.replace("~1", "/"), {})
    record[last] = value


def write_sweep(file: str, out: str, gaps: dict, edits: dict) -> None:
    sweep = json.loads(Path(file).read_text())
    seeds = sweep["axes"][1]["values"] if len(sweep["axes"]) > 1 else [None]
    k = 0
    for case in sweep["axes"][0]["cases"]:
        for seed in seeds:
            k += 1
            label = case["label"] + (f" main={seed}" if seed is not None else "")
            gap = _of(label, gaps, 0.1)
            name = case["set"]["/formulation"]
            verdict = "comparable" if gap and 0.05 <= gap <= 0.2 else "not_comparable"
            record = write_run(Path(out), name, 1.0, gap or 0.1, note=f"{sweep['name']}: {label}", verdict=verdict, folder=f"case{k}")
            if gap is None:
                record["comparability"] |= {"gap_rel": None, "ratio": None, "pair": "", "pair_quantile": "", "pair_gap_rel": None, "pair_ratio": None}
                record["summary"]["gap_min_rel"]["min"] = None
            record["config"] = {"scene": {"n": 4}, "formulation": {"name": name, "d_hat_m": 0.01}, "time": {"dt_s": 0.01}}
            record["ids"]["build_id"] = "b"
            record["status"]["ended_utc"] = "2024-01-31T12:00:02Z"
            record["matching"] |= {"load_N": 2.0, "load_source": "pilot", "contact": "sheet[1]", "contact_step": 3.0, "kappa_N_per_m": 50.0, "scale": None, "pilot_note": "",
                                   "limit_load_N_per_m": 30.0, "limit_stiffness_N_per_m": 400.0, "limit_scale": None}
            record["summary"] |= {"cond": {f"{stage}/{scaling}": {"log10_cond": {"p95": 3.0, "median": 2.0, "max": 4.0}} for stage in (
                "full", "without_contact", "without_contact_and_limit") for scaling in ("none", "block_jacobi")}, "factorizations": 7, "wall_s": 0.5}
            for pointer, value in _of(label, edits, {}).items():
                _put(record, pointer, value)
            (Path(out) / f"case{k}" / "run.json").write_text(json.dumps(record))

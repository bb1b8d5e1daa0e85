"""One record of what experiments/gpu_evidence.sh saw on a card, from its raw files, or from the archives of a
lease (--lease): results/gpu/<card>-<day>.json.
"""

import argparse
import csv
import datetime
import json
import re
import sys
import tarfile
import tempfile
from pathlib import Path

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.json_file import read_object
from barrierbench_analysis.io.places import ROOT
from barrierbench_analysis.io.record_file import read_record
from barrierbench_analysis.io.whole_file import write_whole

SCHEMA = "barrierbench.gpu_evidence/1"
SCENES = ("drape_20k", "drape_20k.cpu", "drape_82k", "drape_82k.cpu", "drape_1m", "dense_500k", "dense_8m")
RECORDS = ROOT / "results/gpu"
RUN_SCHEMA = ROOT / "configs/schema/run.schema.json"
# Kernels of the graph of iterations, which return at once when the solve is over.
OF_SOLVE = frozenset(
    "MultiplyDot UpdateBlockJacobi StepDirection SolveClusters UpdateResidual AddLevels".split()
)
IDLE_SHARE = 0.1  # of the bytes of a kernel's largest launch: what moves less did nothing


def parts_of(folder: Path) -> dict[str, dict]:
    """name -> status (passed, failed, timed_out, left_out), seconds, why."""
    parts = {}
    for name, status, more, seconds in _fields(folder / "parts.tsv", (str, str, str, int), "part"):
        why = more if status == "left_out" else ""
        parts[name] = {"status": status, "seconds": seconds, "why": why}
        if status in ("failed", "timed_out"):
            said = _lines(folder / "logs" / f"{name}.err")
            parts[name]["why"] = said[-1] if said else f"exit code {more}"
        judged = [line for line in _lines(folder / "logs" / f"{name}.out") if " kernels in " in line]
        if judged:  # a test of the modules: kernels and launches
            parts[name]["judged"] = judged[-1]
    return parts


def _fields(path: Path, types: tuple, what: str) -> list[list]:
    """Lines of fields between tabs, each of its type. Errors: UserError."""
    found = []
    for line in input_file.read_text(path).splitlines():
        try:
            found.append([of(text) for of, text in zip(types, line.split("\t"), strict=True)])
        except ValueError:
            raise UserError(f"{path}: not a {what}: {line!r}") from None
    return found


def _lines(log: Path) -> list[str]:
    return input_file.read_text(log).strip().splitlines() if log.exists() else []


def card_state(folder: Path) -> dict:
    """Driver, clocks (MHz), power (W), as nvidia-smi says; empty where it was not there."""
    path = folder / "card.csv"
    rows = csv.DictReader(_lines(path), skipinitialspace=True)
    return {key.split(" [")[0]: value for key, value in next(rows, {}).items()}


def scene_numbers(folder: Path) -> dict | None:
    """Sizes and times of a run; None where it left no record."""
    path = folder / "run.json"
    if not path.exists():
        return None
    run = read_record(path)
    summary, steps = run["summary"], max(run["summary"]["steps"], 1)
    newton, pcg = summary["newton_iterations"], summary["linear_iterations"]
    wall = summary["wall_s"]
    time = summary["time"] if wall is not None else {}

    def per(seconds, n):
        return 1000.0 * seconds / n if seconds is not None and n > 0 else None

    return {
        "outcome": run["status"]["outcome"],
        "vertices": run["scene"]["vertices"],
        "contacts": summary["contacts"]["max"],
        "steps": summary["steps"],
        "dt_s": run["labels"]["dt_s"],
        "newton_iterations": newton,
        "pcg_iterations": pcg,
        "wall_s": wall,
        "step_s": wall / steps if wall is not None else None,
        "newton_ms": per(wall, newton),
        "pcg_ms": per(time.get("linear_solve_s"), pcg),
        "end_check_s": time.get("end_check_s"),
        **_phases(run["steps"]),
        "linear_solver": run["labels"]["linear_solver"],
        "run_id": run["ids"]["run_id"],
        "state_hash": summary.get("state_hash"),
    }


def _phases(steps: list[dict]) -> dict:
    """Every phase in ms a Newton iteration, of the steps after the first one, which warms up; of that where
    it is alone. Nothing of a run that took no times. A record leaves out what took no time.
    """
    timed = [step for step in steps if step.get("time")]
    counted = timed[1:] or timed
    newton = sum(step["newton_iterations"] for step in counted)
    names = read_object(RUN_SCHEMA)["$defs"]["PhaseTimes"]["properties"] if newton > 0 else ()
    seconds = {name: sum(step["time"].get(name, 0.0) for step in counted) for name in names}
    phases = {name: 1000.0 * of / newton for name, of in seconds.items()}
    return {"first_step_s": timed[0]["wall_s"] if timed else None, "phases_ms": phases}


def stages_of(folder: Path) -> list[dict]:
    """The stages of a lease in their order; empty where there was none."""
    path, names = folder / "stages.tsv", ("name", "exit_code", "seconds", "limit_s")
    lines = _fields(path, (str, int, int, int), "stage") if path.exists() else []
    return [dict(zip(names, line)) for line in lines]


def same_runs(folder: Path) -> list[dict]:
    """Runs on the card beside those of the host executor; what has no record on one side is left out."""
    rows = []
    for path in sorted(folder.glob("same/*.cuda")):
        name = path.name.removesuffix(".cuda")
        card, host = (scene_numbers(path.with_name(f"{name}.{device}")) for device in ("cuda", "host"))
        if card is None or host is None:
            continue
        keys = ("outcome", "newton_iterations", "pcg_iterations", "contacts", "wall_s", "state_hash")
        row = {"name": name, "vertices": card["vertices"], "steps": card["steps"]}
        row["same_bits"] = card["state_hash"] == host["state_hash"] if card["state_hash"] else None
        both = (("card", card), ("host", host))
        rows.append(row | {side: {key: of[key] for key in keys} for side, of in both})
    return rows


def functor(kernel: str) -> str:
    """bb::exec::SpmvDot of `void bb::exec::run_each<bb::exec::SpmvDot>(long, T1)`; of a library's
    kernel its name without what it is a template of.
    """
    found = re.search(r"run_(?:each|blocks)<(.*)>\(", kernel)
    return found.group(1) if found else re.sub(r"[<(].*", "", kernel.removeprefix("void "))


def launches_of(path: Path) -> dict[str, dict[str, dict[str, float]]]:
    """functor -> number of a launch -> metrics, of Nsight Compute's table; empty where it was not there or
    had no rights.
    """
    lines = _lines(path)
    start = next((i for i, line in enumerate(lines) if line.startswith('"ID"')), None)
    launches: dict[str, dict[str, dict[str, float]]] = {}
    for row in csv.DictReader(lines[start:]) if start is not None else []:
        if row.get("Metric Name"):
            of_launch = launches.setdefault(functor(row["Kernel Name"]), {}).setdefault(row["ID"], {})
            of_launch[row["Metric Name"]] = float(row["Metric Value"].replace(",", ""))
    return launches


def counters_of(folder: Path) -> list[dict]:
    """Hardware counters of one launch of each kernel, in a lease; longest first."""
    rows = [
        {"name": name, **metrics}
        for name, of in launches_of(folder / "logs/counters.out").items()
        for metrics in of.values()
    ]
    return sorted(rows, key=lambda row: (-row.get("gpu__time_duration.sum", 0.0), row["name"]))


def measured_kernels(folder: Path) -> dict[str, dict]:
    """functor -> launches, seconds, bytes, of Nsight Compute's table; empty where it was not there or had no
    rights. `idle` of the launches did nothing: those of conjugate gradients that a graph makes after the last
    iteration. Their seconds and bytes are not counted.
    """
    launches = launches_of(folder / "logs/kernels.out")
    return {name: _of_launches(name, list(of.values())) for name, of in launches.items()}


def _of_launches(name: str, launches: list[dict[str, float]]) -> dict:
    """The sums over the launches of a kernel that did something."""
    most = max(one.get("dram__bytes.sum", 0.0) for one in launches)
    working = [one for one in launches if one.get("dram__bytes.sum", 0.0) >= IDLE_SHARE * most]
    counted = working if name.split("::")[-1] in OF_SOLVE else launches
    return {
        "launches": len(counted),
        "idle": len(launches) - len(counted),
        "seconds": sum(1e-9 * one.get("gpu__time_duration.sum", 0.0) for one in counted),
        "bytes": sum(one.get("dram__bytes.sum", 0.0) for one in counted),
    }


def _rate(bytes: float | None, seconds: float, **_) -> float | None:
    return bytes / seconds if bytes and seconds else None


def kernels_of(folder: Path) -> list[dict]:
    """Kernels with their time, longest first; bytes and rate are null without Nsight Compute."""
    kernels = measured_kernels(folder)
    path = folder / "kernel_times.json"
    if not kernels and path.exists():
        kernels = {
            name: {"idle": None, **times, "bytes": None}
            for name, times in read_object(path)["kernels"].items()
        }
    rows = [{"name": name, **entry, "Bps": _rate(**entry)} for name, entry in kernels.items()]
    return sorted(rows, key=lambda row: (-row["seconds"], row["name"]))


def collect(folder: Path, commit: str, seconds: int, dry: bool = False) -> dict:
    """The record; commit and seconds of a bundle are in its raw files. dry: also of a lease without a card.
    Errors: UserError.
    """
    if (folder / "dry").exists() and not dry:
        raise UserError(
            f"{folder}/dry: these files are of a lease without a card (--dry), and no record is "
            "made of them; allowed: files of a machine with a card"
        )
    if not commit and (folder / "commit").exists():
        commit = input_file.read_text(folder / "commit").strip()
    if seconds == 0 and (folder / "seconds").exists():
        seconds = int(input_file.read_text(folder / "seconds"))
    device = read_object(folder / "device.json")
    if not device.get("usable") or not device.get("copy"):
        raise UserError(f"{folder}/device.json: no usable card with a measured copy")
    return {
        "schema": SCHEMA,
        "date_utc": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "git_commit": commit,
        "seconds": seconds,
        "device": device,
        "card": card_state(folder),
        "parts": parts_of(folder),
        "scenes": {name: scene_numbers(folder / name) for name in scene_names(folder)},
        "same": same_runs(folder),
        "kernels": kernels_of(folder),
        "stages": stages_of(folder),
        "synchronized": _lines(folder / "synchronized"),  # runs whose phases wait for what they launched
        "counters": counters_of(folder),
    }


def scene_names(folder: Path) -> list[str]:
    """Those of every record, then what else ran: a lease has runs of its own."""
    own = sorted(path.parent.name for path in folder.glob("*/run.json"))
    return [*SCENES, *(name for name in own if name not in SCENES)]


def unpacked(folder: Path, into: Path) -> Path:
    """The raw files: `folder` itself, or `into` with what the archives of a lease in it hold, the last one's
    version of each file. Errors: UserError for an archive that cannot be read.
    """
    archives = sorted(folder.glob("[1-8]-*.tar.gz"))
    for path in archives:
        try:
            with input_file.opened(path) as file, tarfile.open(fileobj=file) as archive:
                for member in archive:
                    if not member.isfile() or ".." in Path(member.name).parts or member.name.startswith("/"):
                        raise UserError(
                            f"{path}: {member.name!r}; allowed: files below the folder of a lease"
                        )
                    archive.extract(member, into, set_attrs=False)
        except (tarfile.TarError, OSError, EOFError) as error:
            raise UserError(f"{path}: not an archive of a lease: {error}") from None
    return into if archives else folder


def file_name(record: dict) -> str:
    card = re.sub(r"[^a-z0-9]+", "_", record["device"]["card"].lower()).strip("_")
    return f"{card}-{record['date_utc'][:10]}.json"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="gpu_evidence", description=__doc__)
    parser.add_argument("folder", type=Path, help="raw files, or the archives of a lease")
    parser.add_argument("--commit", default="", help="of the program")
    parser.add_argument("--seconds", type=int, default=0, help="that the script took")
    parser.add_argument(
        "--records", type=Path, default=RECORDS, help="folder of the record (default: results/gpu)"
    )
    asked = parser.parse_args(arguments)
    try:
        with tempfile.TemporaryDirectory() as scratch:
            record = collect(unpacked(asked.folder, Path(scratch)), asked.commit, asked.seconds)
    except (UserError, OSError, KeyError, ValueError) as error:
        print(f"gpu_evidence: {asked.folder}: {error}", file=sys.stderr)
        return 2
    path = asked.records / file_name(record)
    write_whole(path, json.dumps(record, indent=1) + "\n")
    print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())

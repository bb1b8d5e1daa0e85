"""Where kept numbers come from: day, machine and program of their records."""

from datetime import datetime

ID_DIGITS = 16  # of run_id and build_id, in tables


ONE_THREAD = ", 1 thread a run"  # behind the machine of a sweep, which gives every run one processor
PLACES = {
    "date": lambda record: record["status"]["started_utc"][:10],
    "machine": lambda record: f"{record['machine']['cpu_model']}, {record['machine']['cores']} cores",
    "commit": lambda record: record["provenance"].get("git_commit", "")[:10],
    "build": lambda record: record["ids"]["build_id"][:ID_DIGITS],
    "version": lambda record: record["schema"]["version"],
}


def stamp(record: dict, *keys: str, threads: str = "") -> dict[str, str]:
    """What made a record, of PLACES, in the order of the keys: day, machine, commit and build of the program,
    version of the record. threads: behind the machine.
    """
    found = {key: PLACES[key](record) for key in keys}
    return found | {"machine": found["machine"] + threads} if "machine" in found else found


def run_of(record: dict) -> str:
    """Its run_id, as tables have it."""
    return record["ids"]["run_id"][:ID_DIGITS]


def origin(records: list[dict]) -> dict[str, str]:
    """date, machine, commit and build of all records of a sweep, every value once."""
    keys = ("date", "machine", "commit", "build")
    stamps = [stamp(record, *keys, threads=ONE_THREAD) for record in records]
    return {key: ", ".join(sorted({one[key] for one in stamps})) for key in keys}


def seconds_of_run(record: dict) -> float:
    """From start to end of a run, all passes."""
    start, end = (
        datetime.fromisoformat(record["status"][key].replace("Z", "+00:00"))
        for key in ("started_utc", "ended_utc")
    )
    return (end - start).total_seconds()

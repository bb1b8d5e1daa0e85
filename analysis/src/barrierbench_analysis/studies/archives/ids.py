"""The ids of a record, computed anew from what it holds, as fill_ids of core/base/record does: a config or a
provenance that was edited afterwards has others.
"""

import json
from pathlib import Path, PurePosixPath

from barrierbench_analysis.io import input_file
from barrierbench_analysis.io.digests import of_text


class Literal(str):
    """A number as the file has it: the program wrote it, and its id is of those letters."""


def _letters(value: object) -> str:
    """JSON with sorted keys and no blanks. A file counts by its content (sha256) and the ending of its
    name.
    """
    if isinstance(value, dict):
        named = dict(value)
        if "sha256" in named and isinstance(named.get("file"), str):
            named["file"] = PurePosixPath(named["file"]).suffix
        return "{" + ",".join(f"{_letters(key)}:{_letters(named[key])}" for key in sorted(named)) + "}"
    if isinstance(value, list):
        return f"[{','.join(map(_letters, value))}]"
    return value if isinstance(value, Literal) else json.dumps(value, ensure_ascii=False)


def config_id(config: dict) -> str:
    """Of a config whose numbers are literals."""
    return of_text(_letters({key: value for key, value in config.items() if key != "threads"}))


def run_id(record: dict, config: str) -> str:
    """Of everything that decides a run; `config`: its config_id."""
    ids, provenance = record["ids"], record["provenance"]
    lines = [config, ids["build_id"], ids["machine_id"], str(provenance["threads"])]
    lines += [f"{name} {version}" for name, version in sorted(provenance["libraries"].items())]
    lines.append(f"BLAS kernel {provenance['blas']['kernel']}")
    lines += sorted(plugin["sha256"] for plugin in provenance["plugins"])
    return of_text("".join(f"{line}\n" for line in lines))


def of_record(path: Path) -> tuple[str, str]:
    """config_id and run_id that the record should have. The record is one that record_file.py has read."""
    record = json.loads(input_file.read_text(path), parse_float=Literal, parse_int=Literal)
    config = config_id(record["config"])
    return config, run_id(record, config)

"""When an entry of a JSON file was committed, from git. Without a history nothing is verified."""

import json
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from barrierbench_analysis.io.git import NoHistory, git


@dataclass(frozen=True)
class Commit:
    sha: str
    at: datetime
    oldest: bool  # the last commit that is known here: in a shallow clone the entry may be older


def _is_shallow(root: Path) -> bool:
    return git(root, "rev-parse", "--is-shallow-repository").strip() == "true"


def brought(root: Path, file: str, way: tuple[str, ...], value) -> Commit | None:
    """The commit, an ancestor of HEAD, since which every commit of the file has this value at this place;
    None when HEAD has another.
    """
    lines = git(root, "log", "--format=%H %ct", "HEAD", "--", file).split("\n")
    known, found = [line.split() for line in lines if line], None
    for k, (sha, seconds) in enumerate(known):
        try:
            at = json.loads(git(root, "show", f"{sha}:{file}"))
        except (NoHistory, ValueError):  # the file is not there, or is none
            break
        for word in way:
            at = at.get(word) if isinstance(at, dict) else None
        if at != value:
            break
        found = Commit(
            sha, datetime.fromtimestamp(int(seconds), timezone.utc), k == len(known) - 1 and _is_shallow(root)
        )
    return found

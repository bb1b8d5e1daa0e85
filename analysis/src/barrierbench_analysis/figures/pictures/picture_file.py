"""The file of a picture that a verb writes where the user says (--out)."""

from pathlib import Path

from barrierbench_analysis.io.errors import UserError

SUFFIX = ".png"
MEANS = f"a file that ends in {SUFFIX} (it is added to a name without an ending), or a folder that is there"


def picture_file(out: str | Path, name: str) -> Path:
    """The very file that will be written. name: what it is called in a folder that is there. Errors:
    UserError for another ending, since a picture of another kind would bear it.
    """
    out = Path(out)
    if out.is_dir():
        return out / name
    if not out.suffix:
        return out.with_name(out.name + SUFFIX)
    if out.suffix.lower() != SUFFIX:
        raise UserError(f"--out {out}: found the ending {out.suffix}; allowed: {MEANS}")
    return out

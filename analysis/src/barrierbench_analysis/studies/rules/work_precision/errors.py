"""How far each run is from the reference of its scene: a closed form, or the middle of two refined runs."""

from pathlib import Path

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.record_file import RecordError
from barrierbench_analysis.studies.kit.metrics import FOLDER
from barrierbench_analysis.studies.kit.study.spec import Cell, Study
from barrierbench_analysis.tables.accuracy.errors import MEANING, NotFinite
from barrierbench_analysis.tables.accuracy.reference import CLOSED_FORMS, NoReference, measure, refined
from barrierbench_analysis.tables.accuracy.state import Motion, read_motion
from barrierbench_analysis.tables.outcomes import OK, outcome_of

from .scenes import REFERENCE, Scene, scenes_of


def dt_factor(place: dict[str, str]) -> str:
    """Of the time step of a run, in units of the anchor."""
    return place["factor"] if place["axis"] in ("dt_s", REFERENCE) else "1"


def needs(study: Study, cell: Cell) -> list[Cell]:
    """The refined runs from which a run is measured; of one of the two its fellow."""
    return [
        other
        for other in study.cells
        if other.place["axis"] == REFERENCE
        and other.place["scene"] == cell.place["scene"]
        and dt_factor(other.place) == dt_factor(cell.place)
        and other is not cell
    ]


def _reference_motion(scene: Scene, record: dict) -> Motion:
    status = record["status"]
    if outcome_of(record) != OK:
        raise UserError(
            f"scene {scene.name}: reference run {record['labels'].get('note')!r} ended {status['outcome']}"
            f" {status['detail']}; a reference has to be ok and valid"
        )
    return read_motion(Path(record[FOLDER]))


def errors_of(study: Study, cell: Cell, record: dict, *others: dict) -> dict[str, float | None]:
    """Error -> value of a run, None where it failed; of a refined run its distance to its fellow, which is
    the uncertainty of the reference. others: records of the cells that it needs. Errors: UserError.
    """
    scene = next(scene for scene in scenes_of(study) if scene.name == cell.place["scene"])
    nothing = dict.fromkeys(MEANING)
    if outcome_of(record) != OK and cell.place["axis"] != REFERENCE:
        return nothing
    pair = [_reference_motion(scene, other) for other in others]
    if cell.place["axis"] == REFERENCE:
        return nothing | refined(_reference_motion(scene, record), *pair, "reference").band
    try:
        known = refined(*pair, "reference") if pair else CLOSED_FORMS[scene.reference["closed_form"]]()
        found, skipped = measure(read_motion(Path(record[FOLDER])), known)
    except RecordError:
        raise  # it names its file
    except (NotFinite, NoReference, UserError) as error:
        raise UserError(f"scene {scene.name}: {record[FOLDER]}: {error}") from None
    if scene.error not in found:
        raise UserError(
            f"scene {scene.name}: {record[FOLDER]}: {scene.error} does not apply:"
            f" {skipped.get(scene.error)}; it has {', '.join(found)}"
        )
    return nothing | found

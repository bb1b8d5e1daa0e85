"""What a run is counted as in studies: one that ended ok and failed a check of its validity is not ok."""

from collections.abc import Mapping

OK, NOT_VALID = "ok", "not_valid"


def counted_as(outcome: str, valid: bool, not_valid: str = NOT_VALID) -> str:
    """The word of a run. not_valid: the word of one that ended ok and is not valid."""
    return not_valid if outcome == OK and not valid else outcome


def outcome_of(record: Mapping) -> str:
    """The word of the run that a record is of."""
    return counted_as(record["status"]["outcome"], record["status"]["valid"])

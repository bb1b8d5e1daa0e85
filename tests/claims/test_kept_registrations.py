"""What was registered before its runs is still so: no file that a registered sweep is made of has changed since."""

from barrierbench_analysis.studies.claims import registry, table
from barrierbench_analysis.studies.claims.entry import read_claim


def test_no_kept_registration_is_refused():
    """A changed method, preset or base config would take its verdict from a confirmed claim. Without the history of git a registration
    cannot be verified, but a change is found all the same."""
    kept, entries = table.read(table.FILE), registry.read()
    states = {name: registry.state(read_claim(name), kept, entries) for name in entries}
    assert len(states) > 15 and {name: state.why for name, state in states.items() if state.refused} == {}

"""When a claim was registered: the commit of its entry beside the start of its first run, and what a history cannot say."""

import copy
import shutil
import subprocess
from dataclasses import replace

import pytest
from registered import CLAIM, FILE

from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.studies.claims import registry
from barrierbench_analysis.studies.claims.entry import read_claim
from barrierbench_analysis.studies.claims.table import Table


def test_an_earlier_run_of_the_scenes_is_said(repository):
    registry.register(CLAIM, Table(), repository.root / FILE, "2026-11-30, by another rule")
    repository.commit()
    state = repository.state(repository.run())
    assert state.verified and "before the run of these numbers; an earlier run of these scenes was seen: 2026-11-30, by another rule" in state.why


@pytest.mark.parametrize("started, refused", [("2026-12-01T11:59:59Z", True), ("2026-12-01T12:00:00Z", True), ("2026-12-01T12:00:01Z", False)])
def test_registered_after_the_first_run_is_refused(repository, started, refused):
    repository.register()
    repository.commit()
    state = repository.state(repository.run(started))
    assert state.refused == refused and state.verified != refused and (not refused or "2026-12-01 12:00:00 UTC" in state.why and "after the first run" in state.why)


def test_the_commit_is_the_one_since_which_the_entry_stands(repository):
    """An old entry that was replaced by another one proves nothing for that."""
    parts = copy.deepcopy(list(CLAIM.parts))
    parts[0]["above"] = 2
    repository.register(replace(CLAIM, parts=tuple(parts)))
    repository.commit("2026-11-01T12:00:00+00:00")
    repository.register()
    repository.commit("2026-12-03T12:00:00+00:00")
    assert repository.state(repository.run("2026-12-02T00:00:00Z")).refused and repository.state(repository.run("2026-12-04T00:00:00Z")).verified


def test_an_entry_that_came_back_is_as_old_as_its_return(repository):
    parts = copy.deepcopy(list(CLAIM.parts))
    parts[0]["above"] = 2
    for month, claim in (("10", CLAIM), ("11", replace(CLAIM, parts=tuple(parts))), ("12", CLAIM)):
        repository.register(claim)
        repository.commit(f"2026-{month}-03T12:00:00+00:00")
    assert repository.state(repository.run("2026-12-02T00:00:00Z")).refused and repository.state(repository.run("2026-12-04T00:00:00Z")).verified


def test_entries_of_other_claims_may_come_later(repository):
    repository.register()
    repository.commit()
    repository.register(read_claim("K13"))
    repository.commit("2026-12-09T12:00:00+00:00")
    assert repository.state(repository.run("2026-12-02T00:00:00Z")).verified
    assert repository.state(repository.run("2026-12-02T00:00:00Z"), read_claim("K13")).refused


def test_an_entry_of_no_commit_or_of_another_branch_is_refused(repository):
    repository.commit()
    repository.git("checkout", "--quiet", "-b", "other")
    repository.register()
    repository.commit()
    kept = (repository.root / FILE).read_text()
    repository.git("checkout", "--quiet", "main")
    (repository.root / FILE).write_text(kept)
    assert repository.state(repository.run()).refused and "in no commit that leads to HEAD" in repository.state(repository.run()).why


def test_nothing_is_run_before_the_entry_is_committed(repository):
    repository.commit()
    repository.register()
    with pytest.raises(UserError, match="K12: commit claims/confirmation/registry.json before the first run of shells_modes"):
        registry.ready(CLAIM, repository.entries(), repository.root)
    repository.commit()
    registry.ready(CLAIM, repository.entries(), repository.root)
    parts = copy.deepcopy(list(CLAIM.parts))
    parts[0]["above"] = 2
    with pytest.raises(UserError, match="no confirmation is run: claims/K12.json: the rule is another"):
        registry.ready(replace(CLAIM, parts=tuple(parts)), repository.entries(), repository.root)


def test_without_a_history_nothing_is_confirmed(repository):
    repository.register()
    repository.commit()
    shutil.rmtree(repository.root / ".git")
    state = repository.state(repository.run())
    assert (state.word, state.verified) == ("not verifiable here", False) and "no git history here" in state.why


def test_records_that_keep_no_time(repository):
    repository.register()
    repository.commit()
    assert repository.state(repository.run(started="")).word == "not verifiable here"


def test_a_shallow_clone_does_not_accuse(repository, tmp_path):
    repository.register()
    repository.commit()
    (repository.root / "x").write_text("x")
    repository.commit("2026-12-05T12:00:00+00:00")
    subprocess.run(["git", "clone", "--quiet", "--depth", "1", f"file://{repository.root}", str(tmp_path / "shallow")], check=True, capture_output=True)
    state = registry.state(CLAIM, repository.run(), repository.entries(), tmp_path / "shallow")
    assert (state.word, state.verified) == ("not verifiable here", False) and "shallow" in state.why

"""What the summary of `bench test` reads from ctest's log."""

from analysis.front.test import ptx_share, skipped_cpp

LOG = """\
 1/4 Test  #1: Accd.StopsAtItsLevel ..............   Passed    0.50 sec
 2/4 Test  #2: ptx.ptx_linear ....................   Passed   65.25 sec
 3/4 Test #13: Device.Runs ........................***Skipped   0.01 sec
 4/4 Test  #4: ptx.kernel_table ..................***Failed    1.24 sec
"""


def test_the_share_of_ptx_is_said_in_seconds_of_one_core():
    assert ptx_share(LOG) == ["PTX      2 C++ tests run PTX: 66 of 67 s of one core"]


def test_without_ptx_tests_nothing_is_said():
    assert ptx_share(LOG.replace("ptx.", "own.")) == []


def test_a_skip_is_named():
    assert skipped_cpp(LOG) == ["SKIPPED  1 C++ tests:", "           Device.Runs"]

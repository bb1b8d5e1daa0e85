"""What the summary of `bench test` reads from ctest's log."""

from barrierbench_analysis.front.test import not_passed_cpp, ptx_share, without_passed

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


def test_what_was_skipped_and_what_failed_is_named():
    assert not_passed_cpp(LOG) == [
        "SKIPPED  1 C++ tests:",
        "           Device.Runs",
        "FAILED   1 C++ tests:",
        "           ptx.kernel_table",
    ]


def test_a_log_without_what_passed():
    log = "      Start  1: Accd.StopsAtItsLevel\n" + LOG + "accd.cpp:3: Failure\n"
    assert [line.split()[-1] for line in without_passed(log).splitlines()] == ["sec", "sec", "Failure"]
    assert "Passed" not in without_passed(log)

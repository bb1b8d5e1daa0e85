"""The program's machine code fuses no product with a sum that the source does not fuse: records would depend on
what the compiler vectorises, and the exact predicates of the audit would be wrong.
"""

import re
import shutil
import subprocess

import pytest


def test_the_compiler_fuses_no_multiply_add_by_itself(program):
    if not shutil.which("objdump"):
        pytest.skip("no objdump (Debian: binutils)")
    code = subprocess.run(["objdump", "-d", "--no-show-raw-insn", program], check=True, capture_output=True, text=True).stdout
    products = len(re.findall(r"\tv?mul[sp]d\b", code))
    assert products > 5_000, "this is not the code of the pipeline"
    if not re.search(r"\tvfn?m(?:add|sub)\d", code):
        pytest.skip("built for processors without fused multiply-add: std::fma is a call there, and nothing can be fused")
    # Alternating signs are the one form that no source contains (std::fma has one sign), and the one that g++ 12 makes in spite
    # of -ffp-contract=off.
    assert re.findall(r"\tvfm(?:addsub|subadd)\w+", code) == []

"""docs/guides/python.md, followed: its examples in order."""

import re
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs/guides/python.md"


def test_the_guide_runs(bb):
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(blocks) == 6
    names: dict = {}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    assert names["bb"] is bb and names["record"]["status"]["outcome"] == "ok"
    assert names["record"]["labels"]["step_solver"] == "newton_of_the_guide"
    assert names["record"]["steps"][-1]["contacts"]["total"] > 0
    assert names["found"].d.shape == (100,) and names["rest"].stiffness_N_per_m > 0

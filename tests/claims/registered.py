"""A repository of its own for tests of the registry of confirmations."""

import os
import shutil
import subprocess

from made import runs

from barrierbench_analysis.studies.claims import registry
from barrierbench_analysis.studies.claims.entry import ROOT, read_claim, read_sweep
from barrierbench_analysis.studies.claims.inputs import inputs_of
from barrierbench_analysis.studies.claims.table import Table

NAME, FILE = "shells_modes", "claims/confirmation/registry.json"
CLAIM = read_claim("K12")


class Repository:
    """A checkout with the confirmation sweep of K12, its own git, and the times of commits."""

    def __init__(self, root):
        self.root = root
        for file in (f"claims/confirmation/{NAME}.json", *(f"claims/sweeps/{name}.json" for name in CLAIM.sweeps), "configs/scenes/hang.json"):
            (root / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / file, root / file)
        self.git("init", "--quiet", "--initial-branch=main")

    def git(self, *words, at="2026-12-01T12:00:00+00:00"):
        made = {**os.environ, "GIT_AUTHOR_DATE": at, "GIT_COMMITTER_DATE": at}
        subprocess.run(["git", "-C", str(self.root), "-c", "user.name=t", "-c", "user.email=t@t", *words], check=True, capture_output=True, env=made)

    def commit(self, at="2026-12-01T12:00:00+00:00"):
        self.git("add", "-A")
        self.git("commit", "--quiet", "--allow-empty", "-m", "x", at=at)

    def sweep(self, name):
        return read_sweep.__wrapped__(name, self.root / "claims")

    def register(self, claim=CLAIM, table=None):
        return registry.register(claim, table or Table(), self.root / FILE)

    def entries(self):
        return registry.read(self.root / FILE)

    def state(self, table, claim=CLAIM):
        return registry.state(claim, table, self.entries(), self.root)

    def run(self, started="2026-12-02T00:00:00Z", factor=2.0):
        """Records of the sweep, in which clamping takes `factor` times the iterations."""
        sweep = self.sweep(NAME)
        places = sweep.cases.values()
        scenes, levels = (tuple(dict.fromkeys(p[k] for p in places)) for k in (0, 1))
        made = runs(lambda s, lv, c, k: {"newton": 10 * factor if c == "clamped" else 10.0, "seconds": 1.0, "factorizations": 9}, scenes=scenes, levels=levels,
                    cases=("clamped", "exact_or_clamped", "progressive"), seeds=(1,))
        made.about |= {"sha256": sweep.sha256, "inputs_sha256": inputs_of(sweep), "first_started_utc": started}
        return Table({NAME: made})

"""All statements that are attacked, and those that are not, with the reason."""

import functools
import json
from dataclasses import dataclass

from barrierbench_analysis.studies.kit.study.spec import Study

from . import of_claims, of_size
from .statement import Left, Statement

READ = ("size", "grown_size", "changes", "unless_decided", "verdicts")  # of `about`


@dataclass(frozen=True)
class Gathered:
    statements: list[Statement]
    left: list[Left]

    def named(self, label: str) -> Statement:
        return next(one for one in self.statements if one.label == label)


@functools.cache
def _gathered(about: str, metrics: str) -> Gathered:
    """By the kept rows of the study at size and of the claims at the first call of the process. Cost: all
    claims are judged."""
    of = json.loads(about)
    pairs = [of_size.of_size(of), of_claims.of_claims(of, json.loads(metrics))]
    return Gathered([one for found, _ in pairs for one in found], [one for _, left in pairs for one in left])


def gathered(study: Study) -> Gathered:
    about = {name: study.about[name] for name in READ}
    return _gathered(json.dumps(about), json.dumps(study.data["metrics"]))

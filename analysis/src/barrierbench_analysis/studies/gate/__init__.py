"""Gates: whether a change of the code, or of somebody's solver, made results wrong, badly conditioned or more
expensive.

records.py reads, metrics.py, shares.py and invariants.py say what is looked at, measure.py collects it,
envelope.py says how far a number may move, baseline.py keeps that, drift.py holds it against the first
baseline, judge.py gives verdicts, and one file a verb asks for them: compare.py, gate.py, calibrate.py,
accept.py, matrices.py.
"""

"""Gates: whether a change of the code, or of somebody's solver, made results wrong, badly conditioned or more expensive.

records.py reads, metrics.py and invariants.py say what is looked at, envelope.py how far a number may move, baseline.py keeps that,
judge.py gives verdicts, and one file a verb asks for them: compare.py, gate.py, calibrate.py, accept.py, matrices.py.
"""

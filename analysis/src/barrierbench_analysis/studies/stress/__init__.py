"""The stress suite: configs/stress/ID.json run over all formulations and held against what was expected
before the first run.
"""

"""How far a run is from what is known: shapes and closed forms of their own, states of a run, the errors,
refined references.
"""

"""Formulations made comparable: the verbs `match` and `pareto`. Stiffness is matched by the program alone;
this package asks it and shows the answers.
"""

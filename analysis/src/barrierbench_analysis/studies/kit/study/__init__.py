"""A study: a spec (configs/studies/NAME.json), a rule (studies/rules/NAME.py) and a page template
(configs/studies/NAME.md). Cells -> runs -> rows -> store -> numbers of the rule -> page and figures.
"""

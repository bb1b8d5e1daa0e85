"""Barriers as formulas: read, checked for what a barrier has to be, printed as C++ and compiled into a
plugin. docs/reference/formulas.md.
"""

"""The front door of ./bench: the table of verbs, their help, the builds that they need. Imports nothing but
the standard library.
"""

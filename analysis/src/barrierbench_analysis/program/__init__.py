"""The program: how it is built, started and called, what reads files through it, and the table of verbs."""

"""The program: how it is built, started and asked, what reads files through it, and the table of verbs."""

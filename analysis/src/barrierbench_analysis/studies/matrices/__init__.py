"""The corpus of hard systems, and who finds their condition numbers."""

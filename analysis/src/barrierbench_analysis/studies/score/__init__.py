"""One page for a new barrier: matched beside four others, what it takes, where it fails (`bench study
score`)."""

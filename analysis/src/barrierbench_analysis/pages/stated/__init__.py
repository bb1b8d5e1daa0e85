"""Numbers that pages state, each with what it is of, so that two statements on one thing can be compared."""

"""Frames of a run as files that other tools read, and a finer mesh that follows the simulated one (`bench
data frames`)."""

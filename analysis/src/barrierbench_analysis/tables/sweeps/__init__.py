"""Folders of sweeps: their list of cases, where each of them is, and their records as one table."""

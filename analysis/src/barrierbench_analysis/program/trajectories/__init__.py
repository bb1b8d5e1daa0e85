"""Trajectories of any program: one reader a format."""

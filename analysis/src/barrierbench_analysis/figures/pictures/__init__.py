"""Stills and films of runs."""

"""Figures of the comparison, each a spec of configs/figures, drawn of sweeps and of kept studies."""

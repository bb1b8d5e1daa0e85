"""Figures and pictures: one look, one module a figure."""

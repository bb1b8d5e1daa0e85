"""One module a figure; each writes PNG, PDF and the plotted numbers as CSV."""

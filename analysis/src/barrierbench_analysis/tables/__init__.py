"""Records as tidy tables, and the statistics of them."""

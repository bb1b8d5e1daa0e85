"""Records to tidy tables to figures."""

"""Verdicts on the claims in claims/, computed from records."""

"""The verb claims and its page."""

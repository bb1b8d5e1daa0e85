"""Scenes of other programs read as configs of this one, each with a card of all keys of its source."""

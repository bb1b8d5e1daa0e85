"""Numbers and snippets of README.md and docs/results: made and checked by `bench dev readme`."""

"""Numbers and snippets of README.md and docs/results.md: made and checked by `bench dev readme`."""

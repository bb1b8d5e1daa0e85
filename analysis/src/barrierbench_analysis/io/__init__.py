"""Files: records and their schemas, frames, matrices, specs, text tables. Nothing here starts a program."""

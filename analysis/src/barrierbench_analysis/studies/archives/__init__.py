"""A study, the folder of its records, as one file, and held against what its records name."""

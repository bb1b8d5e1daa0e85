"""Films in one file of another program, each format by a package that is installed on demand."""

"""The contact pipeline beside the IPC Toolkit."""

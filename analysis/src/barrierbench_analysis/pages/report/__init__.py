"""One HTML page of the records below a folder, or of two folders beside each other. Reads records through
record_file.py, figures and players through figures/ and play/; runs nothing.
"""

"""Python processes that a test starts are watched too: this folder is on their PYTHONPATH."""

import outside

outside.start()

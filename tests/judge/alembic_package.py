"""Where the package alembic3d can be installed."""

import platform

NO_WHEEL = "" if platform.machine() in ("x86_64", "AMD64") else f"alembic3d has no wheel for {platform.machine()}"

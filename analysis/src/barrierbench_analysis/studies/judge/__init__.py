"""`bench judge`: the trajectory of any program before the exact audit of this one."""

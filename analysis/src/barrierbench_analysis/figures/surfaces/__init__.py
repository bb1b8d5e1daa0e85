"""Geometry of frames: triangles and rays to pixels, finer meshes that follow a coarse one."""

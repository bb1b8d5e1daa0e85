"""The gap map: condition numbers and iterations against the gap that contact reaches, by shape, scene,
resolution and strain limit, and the area law beside them.
"""

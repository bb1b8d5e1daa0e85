"""The scenes of Ando 2024 and of the other sources: one file each in configs/catalogue, at the size `mini`
and at the source's own.
"""

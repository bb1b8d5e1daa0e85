"""What a formulation costs for what it gets right: error against work, over tolerance, time step, d_hat and
stiffness.
"""

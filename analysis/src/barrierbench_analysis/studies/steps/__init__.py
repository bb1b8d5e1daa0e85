"""Hard time steps as data: results/steps and their page."""

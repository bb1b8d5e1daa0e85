"""The config of a small run whose frames are looked at: a cloth and a rod that fall onto a ball."""

CLOTH_ON_BALL = {
    "schema": "barrierbench.config/1",
    "scene": {
        "bodies": [
            {"name": "cloth", "mesh": {"generator": "grid", "n_x": 6, "n_y": 6, "size_x_m": 0.4, "size_y_m": 0.4},
             "transform": {"translate_m": [0.03, 0.01, 0.106]}, "velocity_m_per_s": [0, 0, -0.5]},
            {"name": "rod", "mesh": {"generator": "rod", "n_segments": 3, "length_m": 0.2},
             "transform": {"translate_m": [0, 0, 0.2]}, "limited": False,
             "material": {"springs_N_per_m": 100, "line_density_kg_per_m": 0.1}},
        ],
        "obstacles": [{"name": "ball", "kind": "sphere", "point_m": [0, 0, 0], "radius_m": 0.1}],
    },
    "formulation": {"name": "log", "d_hat_m": 0.005},
    "strain_limit": {"limit": 0.05},
    "time": {"dt_s": 0.01, "steps": 5},
    "passes": {"time": False},
}

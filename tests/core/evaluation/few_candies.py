"""Settings with which an object is judged in a second or two, by either measure."""

FEW_CANDIES = {
    "seed": 3,
    "particle.shape": "ellipsoid",
    "particle.diameter_m": 0.0132,
    "particle.height_m": 0.007,
    "particle.mass_kg": 0.0009,
    "solver.substeps": 4,
    "solver.iterations": 20,
    "containability.n_max": 40,
    "containability.n_min": 10,
    "containability.rotation_s": 1.0,
    "containability.rotation_rad": 0.05,
    "containability.counted": "centre",
    "containability.contact.lateral_friction": 0.3,
    "capacity.n_fillings": 1,
    "capacity.n_aimed": 30,
    "capacity.lattice_points": 100_000,
}

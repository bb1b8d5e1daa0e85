"""Elastic constants of other programs as those of this one: models whose response at rest is the same."""


def lame(youngs: float, poisson: float) -> tuple[float, float]:
    """The Lame parameters mu and lambda of a solid."""
    shear = youngs / (2 * (1 + poisson))
    return shear, youngs * poisson / ((1 + poisson) * (1 - 2 * poisson))


def youngs_of(shear: float, bulk: float) -> tuple[float, float]:
    """Young's modulus and Poisson's ratio of a solid with the Lame parameters mu and lambda."""
    poisson = bulk / (2 * (bulk + shear))
    return 2 * shear * (1 + poisson), poisson


def solid(model: str, shear: float, bulk: float, density: float) -> dict:
    """The keys of a solid whose moduli at rest are mu and lambda (Pa). The stable neo-Hookean model of this
    program has mu and lambda - mu at rest, so it is given lambda + mu. ARAP has no lambda.
    """
    if model == "stable_neo_hookean":
        bulk += shear
    youngs, poisson = (2.6 * shear, 0.3) if model == "arap" else youngs_of(shear, bulk)
    return {
        "solid_model": model,
        "solid_youngs_Pa": youngs,
        "solid_poisson": poisson,
        "solid_density_kg_per_m3": density,
    }


def shell(model: str, shear: float, bulk: float, density: float, bending: float = 0.0) -> dict:
    """The keys of a membrane with the plane moduli mu and lambda (N/m). With plane stress lambda is
    E nu/(1 - nu^2). The model of Baraff and Witkin has mu along its directions and lambda in shear.
    """
    poisson = bulk / (bulk + 2 * shear)
    return {
        "model": model,
        "youngs_N_per_m": 2 * shear * (1 + poisson),
        "poisson": poisson,
        "density_kg_per_m2": density,
        "bending_J": bending,
    }


def weighted(values, weights) -> tuple[float, bool]:
    """The mean of the values of a body, and whether they differ."""
    total = float(sum(weights))
    mean = float(sum(v * w for v, w in zip(values, weights)) / total) if total else 0.0
    low, high = float(min(values)), float(max(values))
    return (mean if high > low else low), high > low

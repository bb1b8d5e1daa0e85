"""Claims whose answer follows from the definition of the method, or of the formula. They stand apart from the
others on the page: their runs look for a defect of the program, or depend on what we chose.
"""

# Claim -> why no run could have decided otherwise, or what of it runs do decide.
TRIVIAL = {
    "K5": "the step bound lets no iterate past the limit, so runs look for a defect of the program",
    "K6": "the step bound is conservative, so every accepted step is free of crossings; the compared methods"
    " have no such bound, and how often they cross depends on speeds and penalties that we chose",
    "H6": "kappa has the dimension kg/s^2, without a length, and m/d^2 has 1/length^2",
    "H8": "the second derivative of a quadratic is constant; those of log and cubic vanish with the force",
    "H9": "the derivative of (d_hat^2 - d^2)^3 in d has the factor d, so the force vanishes at contact;"
    " runs decide only which loads of ours exceed its peak",
}

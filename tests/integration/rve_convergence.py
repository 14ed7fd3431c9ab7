"""Checks what examples/rve_convergence found: explicit steps settle on the static solution, sooner over a ramp.

    rve_convergence.py results.csv
"""

import csv
import math
import sys

with open(sys.argv[1], newline="", encoding="utf-8") as file:
    rows = {row["quantity"]: row for row in csv.DictReader(file)}

faults = []


def value(quantity):
    return float(rows[quantity]["value"])


def error(quantity):
    """Relative difference from the row's reference."""
    return float(rows[quantity]["relative_difference"])


def expect(holds, what):
    if not holds:
        faults.append(what)


def expect_small(quantity, largest):
    expect(abs(error(quantity)) < largest, f"{quantity}: {error(quantity):g} from its reference, below {largest:g} is expected")


for material in ("alumina", "silica"):
    for loading in ("sudden", "ramped"):
        which = f"loading={loading}"
        for modulus, largest in (("youngs_modulus", 2e-3), ("poissons_ratio", 4e-3)):
            name = f"{material}.{modulus}"
            expect_small(f"{name}[{which},average=steady]", largest)
            # the mean over all steps still carries those before the wave arrived, in which nothing held against the pull
            expect(error(f"{name}[{which},average=all]") < -2 * abs(error(f"{name}[{which},average=steady]")),
                   f"{name}, {loading}: the mean from step 0 does not lag behind")
        # work done is energy kept or lost; what pulls one face holds the other
        expect_small(f"{material}.energy.accounted[{which}]", 1e-5)
        expect_small(f"{material}.reaction[face=loaded,{which}]", 5e-3)
    # a ramp over several periods leaves little to swing, so that no average is needed
    swing = value(f"{material}.vibration[loading=ramped]") / value(f"{material}.vibration[loading=sudden]")
    expect(swing < 0.1, f"{material}: over the ramp {swing:g} of the sudden start's vibration is left")
    for modulus in ("youngs_modulus", "poissons_ratio"):
        expect_small(f"{material}.{modulus}[loading=ramped,average=none]", 1e-3)
        sudden, ramped = (value(f"{material}.{modulus}.steps[loading={loading},average=none]")
                          for loading in ("sudden", "ramped"))
        expect(ramped < (math.inf if math.isnan(sudden) else sudden), f"{material}.{modulus}: the ramp saves no steps")
print("\n".join(faults) or "explicit steps settle on the static solution, sooner over a ramp")
sys.exit(1 if faults else 0)

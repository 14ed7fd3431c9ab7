"""Checks what examples/custom_bond_law found: closed forms of one bond, and that the integrators agree on the cube.

    custom_bond_law.py results.csv
"""

import csv
import sys

with open(sys.argv[1], newline="", encoding="utf-8") as file:
    value = {row["quantity"]: float(row["value"]) for row in csv.DictReader(file)}
    file.seek(0)
    reference = {row["quantity"]: float(row["reference"]) for row in csv.DictReader(file) if row["reference"]}

faults = []


def expect_near(name, got, wanted, tolerance):
    if not abs(got - wanted) <= tolerance * abs(wanted):
        faults.append(f"{name}: {got:g}, {wanted:g} within {tolerance:g} of itself is expected")


expect_near("bond.peak_load", value["bond.peak_load"], reference["bond.peak_load"], 1e-2)
expect_near("bond.dissipated_energy", value["bond.dissipated_energy"], reference["bond.dissipated_energy"], 1e-4)
for figure in ("secant_modulus", "elastic_energy", "dissipated_energy", "softened_bonds"):
    static = value[f"cube.{figure}[method=static]"]
    expect_near(f"{figure} of relaxation", value[f"cube.{figure}[method=relaxation]"], static, 1e-4)
    dynamic = 0.02 if figure in ("secant_modulus", "elastic_energy") else 0.2  # waves make bonds pass their onset
    expect_near(f"{figure} of verlet", value[f"cube.{figure}[method=verlet]"], static, dynamic)
if not 0 < value["cube.softened_bonds[method=static]"] < 1:
    faults.append("no bond has softened, or all have: the test sees nothing")
if not value["cube.secant_modulus[method=static]"] < value["cube.youngs_modulus[strain=0]"]:
    faults.append("the cube has not softened")
print("\n".join(faults) or "closed forms are met and the integrators agree")
sys.exit(1 if faults else 0)

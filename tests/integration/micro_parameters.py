"""Checks the table of examples/micro_parameters --quick by what mechanics asks of it.

    micro_parameters.py coordinations.csv
"""

import csv
import sys

with open(sys.argv[1], newline="", encoding="utf-8") as file:
    rows = list(csv.DictReader(file))
faults = []


def series(rows, *keys):
    found = {}
    for row in rows:
        found.setdefault(tuple(row[k] for k in keys), []).append(row)
    return found


# More bonds never soften a body: E rises with Z, in every kind, measure, material and law.
same = ("cov", "boundary", "state", "law", "measure", "material")
for key, line in series(rows, *same).items():
    line.sort(key=lambda row: float(row["coordination"]))
    E = [float(row["relative_modulus"]) for row in line]
    if len(E) < 2 or any(b <= a for a, b in zip(E, E[1:])):
        faults.append(f"{key}: E_a does not rise with Z: {E}")

# Nor does a softer shear stiffness stiffen it, by no more than the stiffness itself is less; nu rises. Timoshenko's beam is
# nearly the paper's where it is thin.
same = ("cov", "boundary", "state", "coordination", "measure", "material")
for key, three in series(rows, *same).items():
    by_law = {row["law"]: row for row in three}
    stiff = by_law["beam"]
    for law, least in (("two_thirds", 2 / 3), ("timoshenko", {"aluminium": 0.9, "alumina": 0.5, "silica": 0.35}[key[5]])):
        soft = by_law[law]
        ratio = float(soft["relative_modulus"]) / float(stiff["relative_modulus"])
        if not least < ratio < 1:
            faults.append(f"{key}: {law} changes E by {ratio:g}, a factor between {least:g} and 1 is expected")
        if key[4] != "nominal" and float(soft["poissons_ratio"]) <= float(stiff["poissons_ratio"]):
            faults.append(f"{key}: nu does not rise when K_t falls by {law}")

# Thicker beams: relatively stiffer, less contraction, [L17] figure 7.
same = ("cov", "boundary", "state", "coordination", "measure", "law")
for key, three in series(rows, *same).items():
    three.sort(key=lambda row: float(row["radius_ratio"]))
    E = [float(row["relative_modulus"]) for row in three]
    nu = [float(row["poissons_ratio"]) for row in three]
    if not E[0] < E[1] < E[2] < 1 or (key[4] != "nominal" and not 0.5 > nu[0] > nu[1] > nu[2] > 0):
        faults.append(f"{key}: E_a {E} and nu {nu} against the radius ratio")

if not rows or {row["measure"] for row in rows} != {"faces", "nominal", "interior", "periodic"}:
    faults.append("a measure is missing")
print("\n".join(faults) or f"{len(rows)} rows are as mechanics asks")
sys.exit(1 if faults else 0)

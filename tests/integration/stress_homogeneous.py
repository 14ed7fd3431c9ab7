"""Checks what examples/stress_homogeneous found against what equilibrium and statistics ask of any packing.

    stress_homogeneous.py FOLDER
"""

import csv
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])


def read(name):
    with open(folder / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


results = read("results.csv")
value = {row["quantity"]: float(row["value"]) for row in results}
reference = {row["quantity"]: float(row["reference"]) for row in results if row["reference"]}
faults = []


def expect(holds, what):
    if not holds:
        faults.append(what)


def expect_near(name, got, wanted, tolerance):
    expect(abs(got - wanted) <= tolerance * abs(wanted), f"{name}: {got:.12g}, {wanted:.12g} within {tolerance:g} of itself is expected")


# Equilibrium: every tessellation, whatever its cells, holds the moment of the reactions; all have one mean.
moments = [name for name in value if name.startswith("silica.stress.moment[")]
expect(len(moments) >= 8, f"{len(moments)} tessellations, 8 or more are expected")
for name in moments:
    expect_near(name, value[name], reference[name], 1e-9)
rows = [row for row in read("variability.csv") if row["body"] == "all"]
for row in rows:
    name = f"mean of {row['specimens']} {row['cells']}"
    expect_near(name, float(row["mean_pa"]), value["silica.stress.mean"], 1e-9)
    expect(float(row["minimum_pa"]) < float(row["mean_pa"]) < float(row["maximum_pa"]), f"{name}: not between the extremes")
    low, high = float(row["prediction_low_pa"]), float(row["prediction_high_pa"])
    spread = float(row["cov"]) * float(row["mean_pa"])
    expect(1.95 < (high - low) / (2 * spread) < 2.7, f"{name}: the prediction interval is not 2 to 2.5 deviations to each side")

# F/S is E times strain; the mean is lower by the distance of the faces' centres, weighted by force, over the side of 1 cm.
expect_near("F/S", value["silica.stress.of_faces"], reference["silica.stress.of_faces"], 1e-9)
expect_near("distance of the faces, by force and by number", value["silica.faces.distance[weight=force]"],
            value["silica.faces.distance"], 0.03)
expect_near("mean over F/S", float(rows[0]["mean_pa"]) / value["silica.stress.of_faces"],
            value["silica.faces.distance[weight=force]"] / 1e-2, 1e-8)
expect(value["silica.stress.mean"] < value["silica.stress.of_faces"], "the mean is not below F/S")

# Layers across the load carry one force wherever no face is in them, the outermost less; their mean is the body's.
layers = [float(row["mean_across_x"]) for row in read("layers.csv")]
expect_near("mean of the layers", sum(layers) / len(layers), 1, 1e-9)
for inner in layers[1:-1]:
    expect_near("inner layer", inner, value["silica.stress.of_faces"] / value["silica.stress.mean"], 1e-6)
expect(len(layers) > 2 and max(layers[0], layers[-1]) < min(layers[1:-1]), "the outermost layers do not carry less")

# The scatter falls as the specimens grow, for each kind of them; classes by touched faces explain a part, not more than all.
for cells in dict.fromkeys(row["cells"] for row in rows):
    curve = sorted((float(row["particles"]), float(row["cov"])) for row in rows if row["cells"] == cells)
    expect(all(b[1] < a[1] for a, b in zip(curve, curve[1:])), f"CoV of {cells} does not fall: {curve}")
for row in rows:
    expect(0 <= float(row["cov_between_faces"]) <= float(row["cov"]), f"classes of {row['specimens']} {row['cells']} explain too much")

# Every estimator was there, over volumes of one size, and they scatter alike within a factor.
covs = {row["estimator"]: float(row["cov"]) for row in read("estimators.csv")}
expect(sorted(covs) == ["gaussian", "halo", "hexahedra", "hexahedra_by_contact", "lucy", "tetrahedra", "wedges"],
       f"estimators: {sorted(covs)}")
expect(covs and max(covs.values()) < 2 * min(covs.values()), f"CoVs of the estimators: {covs}")

print("\n".join(faults) or f"{len(moments)} tessellations are in balance, and the scatter falls with their size")
sys.exit(1 if faults else 0)

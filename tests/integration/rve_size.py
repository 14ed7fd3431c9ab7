"""Runs examples/rve_size small: physics of its table, the same samples for any number of threads, and a run that goes on
where an earlier one stopped.

    rve_size.py PROGRAM FOLDER
"""

import csv
import pathlib
import shutil
import statistics
import subprocess
import sys

program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
shutil.rmtree(folder, ignore_errors=True)
faults = []


def run(name, *options):
    command = [program, "--no-plot", "--sizes", "600,1500", "--packings-periodic", "1", "--out", str(folder / name),
               "--cache", str(folder / f"packings_{name}"), *options]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: {done.stderr}")
    with open(folder / name / "samples.csv", newline="", encoding="utf-8") as file:
        return [{k: v for k, v in row.items() if k != "solve_seconds"} for row in csv.DictReader(file)], done.stdout


def expect(truth, what):
    if not truth:
        faults.append(what)


whole, _ = run("whole", "--packings", "3", "--threads", "1")
expect(len(whole) == 12, f"{len(whole)} samples, 2 sizes x 3 packings x 2 materials are expected")
run("parts", "--packings", "2", "--threads", "3")
parts, said = run("parts", "--packings", "3", "--threads", "2")
expect("8 rows of an earlier run are kept" in said, f"the second run does not say what it keeps: {said!r}")
expect(parts == whole, "packings made side by side and a run in two parts give other samples than one run on one thread")

refused = subprocess.run([program, "--sizes", "600", "--cov", "0.1", "--out", str(folder / "whole")],
                         capture_output=True, text=True)
expect(refused.returncode == 2 and "cov = 0.1" in refused.stderr, f"a table of another CoV is mixed: {refused.stderr!r}")

value = {}
for row in whole:
    for name, text in row.items():
        if name.startswith(("youngs", "poissons")):
            value.setdefault((row["material"], name), []).append(float(text))
E_mu = {"alumina": 2536e9, "silica": 220.2e9}
mean = {key: statistics.fmean(v for v in values if v == v) for key, values in value.items()
        if any(v == v for v in values)}
for material in E_mu:
    E = {m: mean[material, f"youngs_modulus_{m}_pa"] for m in ("faces", "nominal", "interior", "periodic")}
    expect(0 < E["faces"] < E_mu[material], f"E of {material} is {E['faces']:g}")
    expect(E["nominal"] > E["faces"], f"centres lie inside the faces, but E nominal of {material} is not above E")
    expect(abs(E["periodic"] / E["faces"] - 1) < 0.1,
           f"tension and periodic strain of {material} differ: {E['faces']:g}, {E['periodic']:g} Pa")
relative = {m: mean[m, "youngs_modulus_periodic_pa"] / E_mu[m] for m in E_mu}
expect(relative["silica"] > relative["alumina"], "thicker beams are not relatively stiffer, [L17] figure 7")
expect(mean["silica", "poissons_ratio_periodic"] < mean["alumina", "poissons_ratio_periodic"],
       "thicker beams do not contract less, [L17] figure 7")
print("\n".join(faults) or "the table is sound, and does not depend on threads and interruptions")
sys.exit(1 if faults else 0)

"""Draws what plot.cpp wrote with scripts/plot; checks its reader, its slices and its refusals.

    plot.py FOLDER
"""

import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys
import tempfile

PLOT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "plot"


def run(*arguments):
    return subprocess.run([sys.executable, str(PLOT), *map(str, arguments)], capture_output=True, text=True)


def plot_module():
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader("plot", str(PLOT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot", loader))
    loader.exec_module(module)
    return module


def area(polygon):
    """Area of a polygon, its corners in order."""
    following = polygon[1:] + polygon[:1]
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(polygon, following))) / 2


def check_slices(path):
    plot = plot_module()
    grid = plot.Grid(path)
    assert len(grid.cells) == 4 * 5 * 6
    assert list(grid.cell_data["stress [Pa]"][7]) == [2.07e8, 0, 0, 0, 1e6, 0, 0, 0, -1e6]
    for axis, cells in enumerate([5 * 6, 4 * 6, 4 * 5]):
        for at in (0.0051, 0.005, 0.00001):  # through cells; between them along x and z; near a face
            sections = plot.cut(grid, axis, at)
            assert len(sections) == cells, (axis, at, len(sections))
            total = sum(area([tuple(p) for p in polygon]) for _, polygon in sections)
            assert abs(total - 1e-4) < 1e-15, (axis, at, total)
        assert plot.cut(grid, axis, 0.011) == []


def check_refusals():
    missing = run("no/such/folder")
    assert missing.returncode == 1 and missing.stderr == "plot: no/such/folder is not a folder\n", missing
    assert run().returncode == 2
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        empty = run(folder)
        assert empty.returncode == 1 and "holds nothing to draw" in empty.stderr, empty
        damaged = [
            ("a_convergence.csv", "step,x\n1,2\n", "column 'youngs_modulus_average_pa' is missing"),
            ("a_specimens.vtu", "<VTKFile/>", "its data are not raw and appended"),
            ("angles.csv", "", "it holds no rows"),
            ("b.csv", "x,y\n1\n", "its rows differ in length"),
        ]
        for file, content, _ in damaged:
            (folder / file).write_text(content)
        refused = run(folder)
        assert refused.returncode == 1, refused
        assert refused.stderr == "".join(f"plot: {folder / file}: {why}\n" for file, _, why in damaged), refused.stderr


def main():
    folder = pathlib.Path(sys.argv[1])
    check_slices(folder / "alumina_specimens.vtu")
    drawn = run(folder)
    if "no python3 with Matplotlib" in drawn.stderr:
        print("SKIPPED: no python3 with Matplotlib (Debian and Ubuntu: python3-matplotlib)")
        return
    assert drawn.returncode == 0, drawn.stderr
    expected = ["alumina_convergence.png", "alumina_energy.png", "alumina_specimens_stress.png", "angles.png",
                "calibration.png", "estimators.png", "isotropy_anisotropy.png", "isotropy_eps.png", "layers.png",
                "silica_convergence.png", "silica_energy.png", "silica_loadings.png", "variability_cov.png", "variability_extremes.png"]
    assert sorted(pathlib.Path(line).name for line in drawn.stdout.split()) == expected, drawn.stdout
    assert sorted(path.name for path in folder.glob("*.png*")) == expected
    for name in expected:
        picture = (folder / name).read_bytes()
        assert picture[:8] == b"\x89PNG\r\n\x1a\n" and picture[-8:-4] == b"IEND", name
    check_refusals()
    print("scripts/plot drew", len(expected), "figures")


if __name__ == "__main__":
    main()

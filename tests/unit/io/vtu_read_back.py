"""Reads what vtu_read_back.cpp wrote with VTK and compares every array, type, point and cell.

    vtu_read_back.py FOLDER
"""

import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkStringOutputWindow, vtkOutputWindow
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

VERTEX, LINE, TETRAHEDRON, HEXAHEDRON, WEDGE = 1, 3, 10, 12, 13


class Grid:
    def __init__(self, path):
        log = vtkStringOutputWindow()
        vtkOutputWindow.SetInstance(log)
        reader = vtkXMLUnstructuredGridReader()
        assert reader.CanReadFile(str(path)), f"VTK cannot read {path}"
        reader.SetFileName(str(path))
        reader.Update()
        assert not log.GetOutput(), log.GetOutput()
        self.vtk = reader.GetOutput()
        self.points = vtk_to_numpy(self.vtk.GetPoints().GetData())
        self.point = self.arrays(self.vtk.GetPointData())
        self.cell = self.arrays(self.vtk.GetCellData())

    @staticmethod
    def arrays(data):
        found = [data.GetArray(k) for k in range(data.GetNumberOfArrays())]
        return {array.GetName(): vtk_to_numpy(array) for array in found}

    def field(self, name):
        array = self.vtk.GetFieldData().GetAbstractArray(name)
        assert array is not None and array.GetNumberOfTuples() == 1, name
        return array.GetValue(0)

    def cells(self):
        """[(type, corners)] of every cell."""
        found = []
        for c in range(self.vtk.GetNumberOfCells()):
            ids = self.vtk.GetCell(c).GetPointIds()  # VTK uses one object for all cells of a type
            found.append((self.vtk.GetCellType(c), [ids.GetId(k) for k in range(ids.GetNumberOfIds())]))
        return found

    def volumes(self):
        """Signed volumes: the corners' order counts."""
        size = vtkCellSizeFilter()
        size.SetInputData(self.vtk)
        size.Update()
        return vtk_to_numpy(size.GetOutput().GetCellData().GetArray("Volume"))


def same(actual, expected, what):
    np.testing.assert_array_equal(actual, expected, err_msg=what)


def check_everything(grid):
    count = 20000
    i = np.arange(count)
    assert grid.points.dtype == np.float64
    same(grid.points, np.stack([0.5 * i, -i, np.full(count, 3)], axis=1), "points")
    cells = grid.cells()
    expected = [
        (TETRAHEDRON, [0, 1, 2, 3]),
        (HEXAHEDRON, list(range(8))),
        (HEXAHEDRON, list(range(8, 16))),
        (WEDGE, [5, 4, 3, 2, 1, 0]),
        (LINE, [100, 101]),
        (LINE, [102, 103]),
    ]
    assert cells[:6] == expected, cells[:6]
    assert cells[6:] == [(VERTEX, [k]) for k in range(count)]
    for name, dtype in [("float", np.float32), ("double", np.float64)] + [
        (f"{sign}int{bits}", np.dtype(f"{sign}int{bits}")) for sign in ("", "u") for bits in (8, 16, 32, 64)
    ]:
        array = grid.point[name]
        assert array.dtype == dtype, (name, array.dtype)
        same(array, i.astype(dtype), name)
    same(grid.point["vector"], np.stack([i, 2 * i, -i], axis=1), "vector")
    assert grid.point["float vector"].dtype == np.float32
    same(grid.point["float vector"], np.stack([i, i, i], axis=1), "float vector")
    tensor = np.array([11, 12, 13, 21, 22, 23, 31, 32, 33])
    same(grid.point["tensor"], tensor + 100 * i[:, None], "tensor")
    same(grid.point["pair"], np.stack([i, i + 1], axis=1), "pair")
    odd = grid.point["not finite"]
    assert np.isnan(odd[0::3]).all() and np.isposinf(odd[1::3]).all() and np.isneginf(odd[2::3]).all()
    same(grid.point['a < b & "c" µ [m²]'], i, "escaped name")
    assert len(grid.point) == 16, sorted(grid.point)
    same(grid.cell["cell"], np.arange(count + 6), "cell")
    assert grid.field("TimeValue") == 0.1
    assert grid.field("count") == -7
    assert grid.field("title") == 'α & <b> "c"\nsecond line', grid.field("title")
    assert grid.field("empty") == ""


POSITIONS = np.array([[0.1, 0.5, 0.5], [0.4, 0.5, 0.5], [0.7, 0.5, 0.5], [0.9, 0.5, 0.5]])
DISPLACEMENT = np.array([[k, 0.1 * k, -k] for k in range(4)])
ROTATION = np.array([[0, 0, 10 * k] for k in range(4)])


def check_particles(grid):
    same(grid.points, POSITIONS, "positions")
    assert grid.cells() == [(VERTEX, [k]) for k in range(4)]
    same(grid.point["radius [m]"], [0.1, 0.11, 0.12, 0.13], "radius")
    same(grid.point["phase"], [0, 1, 0, 2], "phase")
    same(grid.point["displacement [m]"], DISPLACEMENT, "displacement")
    same(grid.point["rotation [rad]"], ROTATION, "rotation")


def check_bonds(grid):
    same(grid.points[:4], POSITIONS, "positions")
    assert len(grid.points) == 5
    np.testing.assert_allclose(grid.points[4], [-0.1, 0.5, 0.5], atol=1e-15)
    assert grid.cells() == [(LINE, [0, 1]), (LINE, [1, 2]), (LINE, [0, 4])]
    np.testing.assert_allclose(grid.cell["length [m]"], [0.3, 0.3, 0.2], rtol=1e-15)
    same(grid.cell["phases"], [[0, 1], [1, 0], [0, 2]], "phases")
    same(grid.cell["force [N]"], [[5, 1, 0], [-5, 0, 2], [-3, 0, 0]], "force")
    np.testing.assert_allclose(grid.cell["normal force [N]"], [5, -5, 3], rtol=1e-15)
    same(grid.point["displacement [m]"], DISPLACEMENT[[0, 1, 2, 3, 3]], "displacement")
    assert grid.field("title") == "three bonds"


def check_specimens(grid):
    cells = 3 * 2 * 4
    assert grid.vtk.GetNumberOfCells() == cells
    assert {kind for kind, _ in grid.cells()} == {HEXAHEDRON}
    np.testing.assert_allclose(grid.volumes(), np.ones(cells), rtol=1e-12)
    same(grid.cell["volume [m^3]"], np.ones(cells), "volume")
    same(grid.cell["particles"], 80 + np.arange(cells), "particles")
    s = np.arange(cells)
    zero = np.zeros(cells)
    expected = np.stack([s, zero + 2, zero + 3, zero, s, zero, zero, zero + 5, s], axis=1)
    same(grid.cell["stress [Pa]"], expected, "stress")
    same(grid.cell["couple stress [N/m]"], 2 * expected, "couple stress")
    # pure shear of 1, 1.5 and 2.5 in the three planes, whatever the pressure
    mises = np.sqrt(3 * (1**2 + 1.5**2 + 2.5**2))
    np.testing.assert_allclose(grid.cell["von Mises stress [Pa]"], np.full(cells, mises), rtol=1e-12)


def main():
    folder = pathlib.Path(sys.argv[1])
    check_everything(Grid(folder / "everything.vtu"))
    particles = Grid(folder / "particles.vtu")
    check_particles(particles)
    same(particles.point["temperature [K]"], [1, 2, 3, 4], "temperature")
    assert particles.field("TimeValue") == 1.5 and particles.field("title") == "four particles"
    motion = Grid(folder / "motion.vtu")
    check_particles(motion)
    same(motion.point["velocity [m/s]"], np.tile([7, 8, 9], (4, 1)), "velocity")
    assert motion.field("TimeValue") == 2.5
    check_bonds(Grid(folder / "bonds.vtu"))
    check_specimens(Grid(folder / "specimens.vtu"))
    wedge = Grid(folder / "wedge.vtu")
    assert wedge.cells() == [(WEDGE, [0, 1, 2, 3, 4, 5])]
    np.testing.assert_allclose(wedge.volumes(), [0.5], rtol=1e-12)
    for name, kind, parts in (("wedges", WEDGE, 2), ("tetrahedra", TETRAHEDRON, 6)):
        grid = Grid(folder / f"{name}.vtu")
        assert {cell for cell, _ in grid.cells()} == {kind}
        np.testing.assert_allclose(grid.volumes(), np.full(24 * parts, 1 / parts), rtol=1e-12)
        same(grid.cell["number"], np.arange(24 * parts), "number")
    mesh = Grid(folder / "mesh.vtu")
    assert mesh.cells() == [(WEDGE, [1, 2, 8, 5, 6, 9]), (HEXAHEDRON, [0, 1, 2, 3, 4, 5, 6, 7])]
    np.testing.assert_allclose(mesh.volumes(), [0.5, 1], rtol=1e-12)
    points = Grid(folder / "points.vtu")
    assert points.cells() == [(VERTEX, [k]) for k in range(10)]
    same(points.cell["number"], np.arange(10), "number")
    print("VTK read 10 files and every value in them")


if __name__ == "__main__":
    main()

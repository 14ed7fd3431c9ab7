// Meshes that Gmsh 4.8.4 wrote (meshes/), and what becomes of damaged ones.

#include <cdem/io/gmsh.hpp>
#include <cdem/stress/tessellation/polyhedra.hpp>

#include <Eigen/Geometry> // cross product
#include <doctest/doctest.h>

#include <cmath>

#include "temporary_folder.hpp"

using namespace cdem;

namespace {

const std::filesystem::path meshes = std::filesystem::path(__FILE__).parent_path() / "meshes";

double volume_of(const geometry::Mesh& mesh) {
  const stress::tessellation::Polyhedra polyhedra(mesh); // refuses what is flat or tangled
  double volume = 0;
  for (std::size_t cell = 0; cell < polyhedra.cell_count(); ++cell)
    volume += polyhedra.volume(cell);
  return volume;
}

/// Lower and upper corner of the nodes' bounding box.
std::pair<Vec3, Vec3> bounds_of(const geometry::Mesh& mesh) {
  std::pair<Vec3, Vec3> bounds{mesh.nodes[0], mesh.nodes[0]};
  for (const Vec3& node : mesh.nodes)
    bounds = {bounds.first.cwiseMin(node), bounds.second.cwiseMax(node)};
  return bounds;
}

TEST_CASE("tetrahedra of a box of 2 x 1 x 1, version 2.2") {
  const geometry::Mesh mesh = io::read_gmsh(meshes / "tetrahedra.msh");
  CHECK(mesh.nodes.size() == 23);
  CHECK(mesh.tetrahedra.size() == 48);
  CHECK(mesh.cell_count() == 48);
  CHECK(volume_of(mesh) == doctest::Approx(2).epsilon(1e-12));
  CHECK(bounds_of(mesh).second == Vec3(2, 1, 1));
  for (const auto& c : mesh.tetrahedra) { // VTK_TETRA
    const Vec3 a = mesh.nodes[c[0]];
    CHECK((mesh.nodes[c[1]] - a).cross(mesh.nodes[c[2]] - a).dot(mesh.nodes[c[3]] - a) > 0);
  }
}

TEST_CASE("wedges of an extruded cube, version 4.1; the scale") {
  const geometry::Mesh mesh = io::read_gmsh(meshes / "wedges.msh", 1e-3);
  CHECK(mesh.nodes.size() == 36);
  CHECK(mesh.wedges.size() == 28);
  CHECK(mesh.cell_count() == 28);
  CHECK(volume_of(mesh) == doctest::Approx(1e-9).epsilon(1e-12));
  CHECK((bounds_of(mesh).second - Vec3::Constant(1e-3)).norm() < 1e-18);
  for (const auto& c : mesh.wedges) { // VTK_WEDGE: the first triangle is turned outwards
    const Vec3 a = mesh.nodes[c[0]];
    CHECK((mesh.nodes[c[1]] - a).cross(mesh.nodes[c[2]] - a).dot(mesh.nodes[c[3]] - a) < 0);
  }
}

TEST_CASE("hexahedra of a leaning prism, version 4.1 binary") {
  const geometry::Mesh mesh = io::read_gmsh(meshes / "hexahedra_binary.msh");
  CHECK(mesh.nodes.size() == 27);
  CHECK(mesh.hexahedra.size() == 8);
  CHECK(volume_of(mesh) == doctest::Approx(1).epsilon(1e-12));
  CHECK((bounds_of(mesh).second - Vec3(1.2, 1.1, 1)).norm() < 1e-12);
}

const std::string small_4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$Comments\nfree text $Nodes\n$EndComments\n"
    "$Nodes\n2 5 1 90\n2 1 1 3\n1\n2\n3\n0 0 0 0.1 0.2\n1 0 0 0.1 0.2\n0 1 0 0.1 0.2\n"
    "3 1 0 2\n70\n90\n0 0 1\n5 5 5\n$EndNodes\n"
    "$Elements\n2 2 1 2\n2 1 2 1\n1 1 2 3\n3 1 4 1\n2 1 2 3 70\n$EndElements\n";
const std::string small_2 =
    "$MeshFormat\r\n2.2 0 8\r\n$EndMeshFormat\r\n$Nodes\r\n4\r\n1 0 0 0\r\n2 1 0 0\r\n"
    "3 0 1 0\r\n9 0 0 1e0\r\n$EndNodes\r\n$Elements\r\n2\r\n1 15 2 0 1 1\r\n"
    "2 4 2 0 1 1 2 3 9\r\n$EndElements\r\n";

TEST_CASE("small files: parametric nodes, gaps in the tags, nodes of no element, line ends of Windows") {
  const TemporaryFolder folder;
  put(folder / "4.msh", small_4);
  put(folder / "2.msh", small_2);
  for (const char* name : {"4.msh", "2.msh"}) {
    const geometry::Mesh mesh = io::read_gmsh(folder / name);
    CHECK(mesh.nodes == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    CHECK(mesh.tetrahedra == std::vector<std::array<std::uint32_t, 4>>{{0, 1, 2, 3}});
  }
}

/// Writes to a file that is new each time: some file systems wait for the disk where an old one is cut and written again.
void put_anew(const std::filesystem::path& path, const std::string& content) {
  std::filesystem::remove(path);
  put(path, content);
}

TEST_CASE("a file cut anywhere is refused, text and binary") {
  const TemporaryFolder folder;
  const auto path = folder / "cut.msh";
  const auto check = [&](const std::string& whole, std::size_t step) {
    const std::size_t enough = whole.rfind("$EndElements") + std::string("$EndElements").size();
    for (std::size_t length = 0; length < enough; length += step) {
      put_anew(path, whole.substr(0, length));
      const std::string message = message_of<core::FileError>([&] { (void)io::read_gmsh(path); });
      CHECK_MESSAGE(contains(message, "cannot read " + path.string() + ": "), length);
      CHECK_MESSAGE(contains(message, "expected") + contains(message, "truncated") > 0, message);
    }
  };
  check(small_4, 1);
  check(small_2, 1);
  check(content_of(meshes / "hexahedra_binary.msh"), 31);
}

TEST_CASE("a byte altered anywhere gives a mesh or one message, nothing worse") {
  const TemporaryFolder folder;
  const auto path = folder / "altered.msh";
  for (const std::string& whole : {small_4, content_of(meshes / "hexahedra_binary.msh")})
    for (std::size_t place = 0; place<whole.size(); place += whole.size()> 2000 ? 5U : 1U) {
      std::string altered = whole;
      altered[place] = static_cast<char>(altered[place] ^ 0x15);
      put_anew(path, altered);
      try {
        io::read_gmsh(path).validate();
      } catch (const core::FileError& error) {
        CHECK(contains(error.what(), "cannot read " + path.string()));
      }
    }
}

TEST_CASE("each fault is named, with its line and what is expected") {
  const TemporaryFolder folder;
  const auto path = folder / "bad.msh";
  const auto message = [&](const std::string& content, const std::string& from, const std::string& to) {
    std::string changed = content;
    const std::size_t at = changed.find(from);
    REQUIRE(at != std::string::npos);
    changed.replace(at, from.size(), to);
    put(path, changed);
    return message_of<core::FileError>([&] { (void)io::read_gmsh(path); });
  };
  const auto of_4 = [&](const std::string& from, const std::string& to) {
    return message(small_4, from, to);
  };
  const auto of_2 = [&](const std::string& from, const std::string& to) {
    return message(small_2, from, to);
  };
  CHECK(of_4("4.1", "4.1").empty());
  CHECK(contains(of_4("$MeshFormat", "$Meshformat"),
                 "line 1: '$Meshformat' stands here, '$MeshFormat' is expected"));
  CHECK(contains(of_4("4.1 0 8", "4.0 0 8"), "line 2: version is 4, 4.1 or 2.2 is expected"));
  CHECK(contains(of_4("4.1 0 8", "4.1 2 8"), "line 2: file type is 2, text (0) or binary (1) is expected"));
  CHECK(contains(of_2("2.2 0 8", "2.2 1 8"), "line 2: file type is 1, text (0) is expected of version 2.2"));
  CHECK(contains(of_4("4.1 0 8", "4.1 0 4"), "line 2: data size is 4, 8 is expected"));
  CHECK(contains(of_4("4.1 0 8", "4.1 0"), "line 2: the line ends here, data size of"));
  CHECK(contains(of_4("4.1 0 8", "4.1 0 8 9"), "line 2: '9' follows"));
  CHECK(contains(of_4("1 0 0 0.1", "1 x 0 0.1"), "y of a node's position is 'x', a number is expected"));
  CHECK(contains(of_4("1 0 0 0.1", "1 nan 0 0.1"),
                 "y of a node's position is nan, a finite number is expected"));
  CHECK(contains(of_4("5 5 5\n", "5 5\n"), "the line ends here, z of a node's position is expected"));
  CHECK(contains(of_4("5 5 5\n", "5 5 5 5\n"), "'5' follows a node's position, 3 numbers are expected"));
  CHECK(contains(of_4("70\n90", "70\n2"), "node 2 stands here a second time"));
  CHECK(contains(of_4("2 5 1 90", "2 6 1 90"), "the blocks hold 5 nodes, the head of $Nodes says 6"));
  CHECK(contains(of_4("2 5 1 90", "2 99999 1 90"), "number of nodes is 99999, more than the file can hold"));
  CHECK(contains(of_4("2 2 1 2", "2 3 1 2"), "the blocks hold 2 elements, the head of $Elements says 3"));
  CHECK(contains(of_4("3 1 0 2", "4 1 0 2"), "dimension is 4, 0 to 3 is expected"));
  CHECK(contains(of_4("3 70\n", "3 71\n"), "a corner is the node 71"));
  CHECK(contains(of_4("3 70\n", "3\n"), "line 27: the line ends here, corner of an element is expected"));
  CHECK(contains(of_4("3 1 4 1", "3 1 7 1"), "element type 7 (pyramid) is not read"));
  CHECK(contains(of_4("3 1 4 1", "3 1 11 1"), "element type 11 (of second order) is not read"));
  CHECK(contains(of_4("3 1 4 1", "3 1 99 1"), "element type 99 is not read"));
  CHECK(contains(of_4("3 1 4 1\n2 1 2 3 70", "2 1 2 1\n2 1 2 3"),
                 "without any tetrahedron, wedge or hexahedron"));
  CHECK(contains(of_4("$EndNodes", "$EndNode"), "'$EndNode' stands here, '$EndNodes' is expected"));
  CHECK(contains(of_4("$EndComments", "$EndComment"), "the section $Comments has no '$EndComments'"));
  CHECK(contains(of_4("$Elements", "Elements"), "a section such as $Nodes is expected"));
  CHECK(contains(of_4("$Comments", "$PartitionedEntities"), "the mesh is partitioned"));
  CHECK(contains(of_2("9 0 0 1e0", "9 0 0"), "line 9: the line ends here, z of a node is expected"));
  CHECK(contains(of_2("9 0 0 1e0", "9.5 0 0 1e0"), "tag of a node is '9.5', a whole number is expected"));
  CHECK(contains(of_2("2 3 9\r\n", "2 3 8\r\n"), "line 14: a corner is the node 8"));
  CHECK(contains(message(content_of(meshes / "hexahedra_binary.msh"), std::string("\1\0\0\0", 4),
                         std::string("\0\0\0\1", 4)),
                 "after byte 24: the mark of the byte order is not 1"));
  CHECK(contains(message_of<core::FileError>([&] { (void)io::read_gmsh(folder / "none.msh"); }),
                 "No such file or directory"));
  CHECK(contains(message_of<core::FileError>([&] { (void)io::read_gmsh(folder.path()); }), "it is a folder"));
  CHECK(contains(message_of<core::InvalidInput>([&] { (void)io::read_gmsh(meshes / "wedges.msh", 0); }),
                 "scale of the mesh = 0"));
}

} // namespace

#include <cdem/io/from_file.hpp>
#include <cdem/io/particles_vtu.hpp>

#include <doctest/doctest.h>

#include <limits>

#include "temporary_folder.hpp"

using namespace cdem;
using io::FromFile;
using io::SphereFormat;

namespace {

// The four spheres that every sample holds: x y z radius phase
const std::vector<std::array<double, 5>> spheres{
    {0.25, 0.5, 0.75, 0.1, 0}, {1, 2, 3, 0.2, 1}, {-1.5, 0.125, 1e-3, 0.3, 2}, {4, 5, 6, 0.4, 255}};

/// Which sphere differs, and in what; empty if none does.
std::string difference(const particles::ParticleSet& read, double scale, bool with_phase) {
  if (read.size() != spheres.size())
    return std::to_string(read.size()) + " spheres";
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      if (read.position[i][static_cast<Eigen::Index>(k)] != scale * spheres[i][k])
        return "position of " + std::to_string(i);
    if (std::abs(read.radius[i] - scale * spheres[i][3]) > 1e-15)
      return "radius of " + std::to_string(i);
    if (read.phase[i] != (with_phase ? spheres[i][4] : 0))
      return "phase of " + std::to_string(i);
  }
  return "";
}

struct Sample {
  std::string name, content;
  SphereFormat format;
  bool phases = true;
};

// A file as VTK 9.1 writes it with zlib, base64 and appended data (YADE's VTKRecorder), and another with data in place.
const std::string appended_data = "_AQAAAAAAAAAAgAAAAAAAAGAAAAAAAAAADAAAAAAAAAA="
                                  "eF5jYKAtAAAAYAABAQAAAAAAAAAAgAAAAAAAACAAAAAAAAAAGgAAAAAAAAA=eF6bNRME"
                                  "dtrPAtMn7Y3B4DKUf9MeABLVECI=AQAAAAAAAAAAgAAAAAAAABAAAAAAAAAAEwAAAAAAAAA="
                                  "eF5jYGBgYARiJiD+D8QABCgBAw==AQAAAAAAAAAA"
                                  "gAAAAAAAAGAAAAAAAAAANQAAAAAAAAA=eF5jYACBC/ZgiuEBlH4BpT9AaQYHCMUBpX/"
                                  "sh9AH7P+s/HjJNykAqk4AKi8CpSUcAHTwDWU=";

std::string vtu(const std::string& format, const std::string& velocity, const std::string& radii,
                const std::string& material, const std::string& points, const std::string& appended,
                bool zlib, bool wide) {
  const auto array = [&](const std::string& head, const std::string& data) {
    return "        <DataArray " + head + " format=\"" + format + "\" RangeMin=\"0\" " +
           (format == "appended" ? "offset=\"" + data + "\"" : "") + ">\n" +
           (format == "appended" ? "" : data) +
           "\n          <InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"1\">\n"
           "            <Value index=\"0\">\n              0\n            </Value>\n          "
           "</InformationKey>\n"
           "        </DataArray>\n";
  };
  return std::string("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                     "byte_order=\"LittleEndian\"") +
         (wide ? " header_type=\"UInt64\"" : " header_type=\"UInt32\"") +
         (zlib ? " compressor=\"vtkZLibDataCompressor\"" : "") +
         ">\n  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"4\" NumberOfCells=\"0\">\n      "
         "<PointData>\n" +
         array("type=\"Float64\" Name=\"linVelVec\" NumberOfComponents=\"3\"", velocity) +
         array("type=\"Float64\" Name=\"radii\"", radii) +
         array("type=\"Int32\" Name=\"materialId\"", material) + "      </PointData>\n      <CellData>\n" +
         array("type=\"Float64\" Name=\"radius\"", velocity) + "      </CellData>\n      <Points>\n" +
         array("type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"", points) +
         "      </Points>\n    </Piece>\n  </UnstructuredGrid>\n" +
         (appended.empty()
              ? ""
              : "  <AppendedData encoding=\"base64\">\n   " + appended + "\n  </AppendedData>\n") +
         "</VTKFile>\n";
}

/// Eight bytes, the most significant first, as VTK's legacy files hold a double.
std::string big_endian(double value) {
  std::array<char, 8> bytes;
  std::memcpy(bytes.data(), &value, 8);
  if (std::endian::native == std::endian::little)
    std::reverse(bytes.begin(), bytes.end());
  return {bytes.data(), 8};
}

std::string legacy_binary() {
  std::string text = "# vtk DataFile Version 4.2\nspheres\nBINARY\nDATASET POLYDATA\nPOINTS 4 double\n";
  for (const auto& s : spheres)
    text += big_endian(s[0]) + big_endian(s[1]) + big_endian(s[2]);
  text += "\nVERTICES 1 2\n" + std::string({0, 0, 0, 1, 0, 0, 0, 0}) +
          "\nPOINT_DATA 4\nSCALARS radius double\n"
          "LOOKUP_TABLE default\n";
  for (const auto& s : spheres)
    text += big_endian(s[3]);
  return text + "\nFIELD FieldData 1\nphase 1 4 unsigned_char\n" +
         std::string({0, 1, 2, static_cast<char>(-1)}) + "\n";
}

std::vector<Sample> samples() {
  const std::string xml_radii =
      "AQAAAAAAAAAAgAAAAAAAACAAAAAAAAAAGgAAAAAAAAA=eF6bNRMEdtrPAtMn7Y3B4DKUf9MeABLVECI=";
  return {
      {"a.csv",
       "id,\"x [m]\",y_m,Points:2,Radius "
       "[m],phase\n1,0.25,0.5,0.75,0.1,0\n2,1,2,3,+0.2,1\r\n\n3,-1.5,.125,1e-3,0.3,2\n"
       "4,4,5,6,4e-1,255\n",
       SphereFormat::table},
      {"semicolons.txt", "x;y;z;diameter\n0.25;0.5;0.75;0.2\n1;2;3;0.4\n-1.5;0.125;0.001;0.6\n4;5;6;0.8\n",
       SphereFormat::table, false},
      {"yade.txt",
       "#format x_y_z_r\n# made by "
       "export.text\n0.25\t0.5\t0.75\t0.1\n1\t2\t3\t0.2\n-1.5\t0.125\t0.001\t0.3\n4\t5\t6\t0.4\n",
       SphereFormat::table, false},
      {"yade_id.txt",
       "#format id_x_y_z_r_matId\n7 0.25 0.5 0.75 0.1 0\n8 1 2 3 0.2 1\n9 -1.5 0.125 0.001 0.3 2\n10 4 5 6 "
       "0.4 255\n",
       SphereFormat::table},
      {"yade_attrs.txt",
       "#format x_y_z_r_attrs\n# dist\n0.25 0.5 0.75 0.1 9\n1 2 3 0.2 9\n-1.5 0.125 0.001 0.3 9\n4 5 6 0.4 "
       "9\n",
       SphereFormat::table, false},
      {"pack.txt", "0.25 0.5 0.75 0.1 -1\n1 2 3 0.2 -1\n-1.5 0.125 0.001 0.3 -1\n4 5 6 0.4 -1\n",
       SphereFormat::table, false},
      {"write_data.lmp",
       "LAMMPS data file via write_data, version 23 Jun 2022, timestep = 0\n\n4 atoms\n256 atom types\n\n-2 "
       "5 xlo xhi\n0 6 ylo yhi\n"
       "-1 8 zlo zhi\n\nAtoms # sphere\n\n4 256 0.8 2500 4 5 6 0 0 0\n1 1 0.2 2500 0.25 0.5 0.75 0 0 0\n"
       "3 3 0.6 2500 -1.5 0.125 0.001 0 0 0\n2 2 0.4 2500 1 2 3 0 0 0\n\nVelocities\n\n1 0 0 0 0 0 0\n",
       SphereFormat::lammps_data},
      {"dump.lammpstrj",
       "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ATOMS "
       "id type x y z radius\n"
       "1 1 0 0 0 9\nITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n4\nITEM: BOX BOUNDS pp pp fs\n-2 6\n-1 7\n0 "
       "8\n"
       "ITEM: ATOMS id type xs ys z diameter\n2 2 0.375 0.375 3 0.4\n1 1 0.28125 0.1875 0.75 0.2\n"
       "4 256 0.75 0.75 6 0.8\n3 3 0.0625 0.140625 0.001 0.6\n",
       SphereFormat::lammps_dump},
      {"legacy.vtk",
       "# vtk DataFile Version 5.1\nvtk output\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0.25 0.5 "
       "0.75 1 2 3 -1.5 0.125 "
       "0.001 \n4 5 6 \nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0.935414 "
       "8.77496 \n\n"
       "CELLS 5 4\nOFFSETS vtktypeint64\n0 1 2 3 4 \nCONNECTIVITY vtktypeint64\n0 1 2 3 \nCELL_TYPES "
       "4\n1\n1\n1\n1\n\nPOINT_DATA 4\n"
       "FIELD FieldData 3\nlinVelVec 3 4 double\n0 0 0 0 0 0 0 0 0 \n0 0 0 \nMETADATA\nINFORMATION "
       "0\n\nradii 1 4 double\n"
       "0.1 0.2 0.3 0.4 \nMETADATA\nINFORMATION 0\n\nmaterialId 1 4 int\n0 1 2 255 \n",
       SphereFormat::vtk},
      {"text2vtk.vtk",
       "# vtk DataFile Version 3.0.\ncomment\nASCII\n\nDATASET POLYDATA\nPOINTS 4 double\n0.25 0.5 0.75\n1 2 "
       "3\n-1.5 0.125 0.001\n"
       "4 5 6\n\nPOINT_DATA 4\nSCALARS radius double 1\nLOOKUP_TABLE default\n0.1\n0.2\n0.3\n0.4\n",
       SphereFormat::vtk, false},
      {"binary.vtk", legacy_binary(), SphereFormat::vtk},
      {"recorder.vtu", vtu("appended", "0", "60", "140", "212", appended_data, true, true),
       SphereFormat::vtu},
      {"in_place.vtu",
       vtu("binary", "AQAAAAAAAAAAgAAAAAAAAGAAAAAAAAAADAAAAAAAAAA=eF5jYKAtAAAAYAAB", xml_radii,
           "AQAAAAAAAAAAgAAAAAAAABAAAAAAAAAAEwAAAAAAAAA=eF5jYGBgYARiJiD+D8QABCgBAw==",
           "AQAAAAAAAAAAgAAAAAAAAGAAAAAAAAAANQAAAAAAAAA=eF5jYACBC/ZgiuEBlH4BpT9AaQYHCMUBpX/sh9AH7P+s/"
           "HjJNykAqk4AKi8CpSUcAHTw"
           "DWU=",
           "", true, true),
       SphereFormat::vtu},
      {"plain.vtu",
       vtu("appended", "0", "136", "184", "212",
           "_YAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"
           "AAA"
           "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA==IAAAAJqZmZmZmbk/mpmZmZmZyT8zMzMzMzPTP5qZmZmZmdk/"
           "EAAAAAAAAAABAAA"
           "AAgAAAP8AAAA=YAAAAAAAAAAAANA/AAAAAAAA4D8AAAAAAADoPwAAAAAAAPA/AAAAAAAAAEAAAAAAAAAIQAAAAAAAAPi/"
           "AAAAAAA"
           "AwD/8qfHSTWJQPwAAAAAAABBAAAAAAAAAFEAAAAAAAAAYQA==",
           false, false),
       SphereFormat::vtu},
      {"ascii.vtu",
       vtu("ascii", "0 0 0 0 0 0 0 0 0 0 0 0", "0.1 0.2 0.3 0.4", "0 1 2 255",
           "0.25 0.5 0.75 1 2 3\n -1.5 0.125 0.001 4 5 6", "", false, false),
       SphereFormat::vtu},
  };
}

std::string refusal(const std::filesystem::path& file) {
  return message_of<core::FileError>([&] { FromFile({.file = file}).pack(); });
}

} // namespace

TEST_CASE("every format gives the same spheres") {
  const TemporaryFolder folder;
  for (const Sample& sample : samples()) {
    CAPTURE(sample.name);
    put(folder / sample.name, sample.content);
    const auto packing = FromFile({.file = folder / sample.name}).pack();
    CHECK(packing.report.format == sample.format);
    CHECK(difference(packing.particles, 1, sample.phases) == "");
    CHECK(packing.report.density == packing.particles.solid_volume() / packing.box.volume());
    const auto scaled =
        FromFile({.file = folder / sample.name, .format = sample.format, .scale = 0.5}).pack();
    CHECK(difference(scaled.particles, 0.5, sample.phases) == "");
  }
}

TEST_CASE("boxes are the file's, the given one, or the smallest") {
  const TemporaryFolder folder;
  for (const Sample& sample : samples())
    put(folder / sample.name, sample.content);
  const auto dump = FromFile({.file = folder / "dump.lammpstrj", .scale = 2}).pack();
  CHECK(dump.box.lower == Vec3(-4, -2, 0));
  CHECK(dump.box.upper == Vec3(12, 14, 16));
  CHECK(dump.box.periodic == std::array<bool, 3>{true, true, false});
  const auto data = FromFile({.file = folder / "write_data.lmp"}).pack();
  CHECK(data.box.upper == Vec3(5, 6, 8));
  CHECK(data.box.periodic == std::array<bool, 3>{true, true, true});
  CHECK_FALSE(data.report.box_from_spheres);
  const auto table = FromFile({.file = folder / "a.csv"}).pack();
  CHECK(table.report.box_from_spheres);
  CHECK((table.box.lower - Vec3(-1.8, -0.175, -0.299)).norm() < 1e-15);
  CHECK((table.box.upper - Vec3(4.4, 5.4, 6.4)).norm() < 1e-15);
  CHECK(table.box.periodic == std::array<bool, 3>{false, false, false});
  const geometry::Box tight{Vec3::Zero(), Vec3(5, 6, 7), {true, false, false}};
  const auto given = FromFile({.file = folder / "a.csv", .box = tight}).pack();
  CHECK(given.particles.position[2].x() == 3.5); // -1.5 brought inside
  put(folder / "periodic.txt", "##PERIODIC:: 2 3 4\n-0.5 1 1 0.5\n");
  const auto cell = FromFile({.file = folder / "periodic.txt"}).pack();
  CHECK(cell.box.upper == Vec3(2, 3, 4));
  CHECK(cell.box.periodic == std::array<bool, 3>{true, true, true});
  CHECK(cell.particles.position[0] == Vec3(1.5, 1, 1));
  const geometry::Box walled{Vec3::Zero(), Vec3::Ones(), {}};
  CHECK(contains(
      message_of<core::FileError>([&] { FromFile({.file = folder / "a.csv", .box = walled}).pack(); }),
      "y of sphere 1 is 2 m, outside the box"));
}

TEST_CASE("what this project writes is read back to the same bits") {
  const TemporaryFolder folder;
  put(folder / "a.csv", samples()[0].content);
  auto packing = FromFile({.file = folder / "a.csv"}).pack();
  packing.particles.position[0] *= 1 / 3.0;
  packing.particles.radius[0] *= 1 / 3.0;
  io::write_particles_vtu(folder / "a.vtu", packing.particles);
  io::save_packing(folder / "a.cdem", packing.particles, packing.box,
                   {.parameters = "by hand", .report = "good"});
  for (const char* name : {"a.vtu", "a.cdem"}) {
    const auto back = FromFile({.file = folder / name}).pack();
    CHECK(back.particles.position == packing.particles.position);
    CHECK(back.particles.radius == packing.particles.radius);
    CHECK(back.particles.phase == packing.particles.phase);
    CHECK((back.box.upper - packing.box.upper).norm() < 1e-15);
  }
  const auto own = FromFile({.file = folder / "a.cdem"}).pack();
  CHECK(own.report.format == SphereFormat::packing);
  CHECK(own.report.parameters == "by hand");
  CHECK(own.report.made == "good");
}

TEST_CASE("points without radii need one") {
  const TemporaryFolder folder;
  put(folder / "points.csv", "x,y,z\n0,0,0\n1,1,1\n");
  CHECK(contains(refusal(folder / "points.csv"), "points.csv: it gives no radii"));
  const auto packing = FromFile({.file = folder / "points.csv", .scale = 2, .radius = 0.25}).pack();
  CHECK(packing.particles.radius == std::vector<double>{0.25, 0.25});
  CHECK(packing.particles.position[1] == Vec3(2, 2, 2));
}

TEST_CASE("a file that was cut anywhere is refused, or a damaged one at least does no harm") {
  const TemporaryFolder folder;
  const auto file = folder / "cut";
  for (const Sample& sample : samples()) {
    CAPTURE(sample.name);
    const bool lines_alone = sample.format == SphereFormat::table; // nothing says how many there should be
    const std::size_t whole = sample.content.find_last_not_of("\n") + 1;
    const std::size_t step = sample.content.size() > 1000 ? 7 : 1;
    for (std::size_t length = 0; length < whole; length += step) {
      if (lines_alone && length > 0 && sample.content[length - 1] == '\n')
        continue;
      if (sample.name == "write_data.lmp" && length > sample.content.find("\n\nVelocities"))
        break; // not read
      if (sample.name == "dump.lammpstrj" &&
          sample.content.substr(length - std::min<std::size_t>(length, 2), 2) == "9\n")
        continue; // the first snapshot is whole, and so is the file
      if (sample.name == "dump.lammpstrj" && length > 0 && sample.content[length - 1] == '\n' &&
          sample.content.substr(0, length).find("diameter") == std::string::npos)
        continue; // the second has not begun
      if (sample.format == SphereFormat::vtk &&
          sample.content.substr(0, length).find("radi") == std::string::npos)
        continue; // no radii yet: refused for that, or for what is cut
      put(file, sample.content.substr(0, length));
      const std::string complaint = message_of<std::exception>([&] {
        const auto packing = FromFile({.file = file, .format = sample.format}).pack();
        if (difference(packing.particles, 1, sample.phases) == "" ||
            difference(packing.particles, 1, false) == "")
          throw std::runtime_error("cannot read: nothing that counts was cut");
      });
      INFO("cut at ", length, " of ", sample.content.size(), ": ", complaint);
      REQUIRE(contains(complaint, "cannot read"));
    }
  }
  std::mt19937 random(5);
  for (const Sample& sample : samples())
    for (int trial = 0; trial < 60; ++trial) {
      std::string damaged = sample.content;
      for (int k = 0; k < 3; ++k)
        damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
      put(file, damaged);
      try {
        FromFile({.file = file, .format = sample.format}).pack();
      } catch (const core::FileError&) { // the only complaint there is
      }
    }
}

TEST_CASE("one clear error names file and line") {
  const TemporaryFolder folder;
  const auto refuse = [&](const char* name, const std::string& content, const char* what) {
    put(folder / name, content);
    const std::string complaint = refusal(folder / name);
    INFO(complaint);
    CHECK(contains(complaint, "cannot read " + (folder / name).string() + ": "));
    CHECK(contains(complaint, what));
    CHECK(complaint.find('\n') == std::string::npos);
  };
  refuse("a.csv", "x,y,z,radius\n0,0,0,1\n1,nan,0,1\n", "line 3: y is 'nan', a finite number is expected");
  refuse("a.csv", "x,y,z,radius\n0,0,0,0\n", "line 2: radius is 0, a finite number above 0 is expected");
  refuse("a.csv", "x,y,z,radius\n0,0,0,-1\n", "line 2: radius is -1");
  refuse("a.csv", "x,y,z,radius\n0,0,0,1\n0,0,1\n", "line 3: it has 3 columns, 4 are expected");
  refuse("a.csv", "x,y,z,radius\n0,0,0,1\n0,0,0,1,2\n", "line 3: it has 5 columns, 4 are expected");
  refuse("a.csv", "x,y,z,radius\n0,0,0,1\n0,0,0,1.2", "line 3: it has no line end: is the file truncated?");
  refuse("a.csv", "x,y,z,radius,phase\n0,0,0,1,256\n",
         "line 2: phase is '256', a whole number from 0 to 255");
  refuse("a.csv", "a,b,c,d\n0,0,0,1\n", "line 1: columns called x, y and z are expected in 'a,b,c,d'");
  refuse("a.csv", "0 0 0\n", "line 1: it has 3 columns; x y z radius");
  refuse("a.csv", "", "line 0: the file ends without a sphere");
  refuse("a.csv", "x,y,z,r\n", "line 1: the file ends without a sphere");
  refuse("y.txt", "#format x_y_z\n0 0 0\n", "line 1: the format 'x_y_z' does not name x, y, z and r");
  refuse("y.txt", "##PERIODIC:: 1 1\n", "line 1: it has 2 columns, 3 are expected");
  refuse("y.txt", "##PERIODIC:: 1 0 1\n0 0 0 1\n", "edge of the box along y = 0");
  const std::string head = "title\n\n2 atoms\n\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n\n";
  refuse("d", head + "Atoms # sphere\n\n1 1 1 1 0 0 0\n",
         "line 11: the file ends here, atom 2 of 2 is expected");
  refuse("d", head + "Atoms # sphere\n\n1 1 0 1 0 0 0\n", "line 11: radius is 0");
  refuse("d", head + "Atoms # sphere\n\n1 1 1 1 0 0\n", "line 11: it has 6 columns, 7 are expected");
  refuse("d", head + "Atoms # full\n\n1 1 1 1 0 0 0\n", "line 11: atom style 'full' is not read");
  refuse("d", head + "Atoms\n\n1 1 1 0 0 0\n",
         "line 11: the section Atoms does not name its style, and 6 columns");
  refuse("d", head + "Atoms # sphere\n\n1 1 1 1 0 0 0\n1 1 1 1 0 0 0\n", "the id 1 twice");
  refuse("d", head + "Atoms # sphere\n\n1 0 1 1 0 0 0\n", "line 11: atom type is 0");
  refuse("d", head + "0.1 0 0 xy xz yz\n\nAtoms # sphere\n", "line 9: the box is tilted");
  refuse("d", "title\n\n2 atoms\n\nAtoms # sphere\n", "line 5: lines with xlo xhi");
  refuse("d", "title\n\n2 atoms\n", "line 3: the file ends here, the section Atoms is expected");
  refuse("e", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS xy xz yz pp pp pp\n",
         "line 5: the box is tilted");
  const std::string dump =
      "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n";
  refuse("e", dump + "ITEM: ATOMS id x y radius\n", "line 9: columns x, y and z");
  refuse("e", dump + "ITEM: ATOMS x y z radius\n0 0 0 1\n",
         "line 10: the file ends here, atom 2 of 2 is expected");
  refuse("e", dump, "line 8: the file ends without an atom");
  const std::string vtk =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0\n0 0 ";
  refuse("f", vtk + "nan\nPOINT_DATA 2\nSCALARS radius float\nLOOKUP_TABLE default\n1\n1\n",
         "point 1: z is nan");
  refuse("f", vtk + "0\nPOINT_DATA 2\nSCALARS radius float\nLOOKUP_TABLE default\n1\n0\n",
         "point 1: radius is 0");
  refuse("f", vtk + "zero\n", "line 7: 'zero' stands for number 6 of 6");
  refuse("f", vtk + "0\nBANANAS 3\n", "line 8: 'BANANAS' is not known here");
  refuse("f", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\n",
         "line 4: DATASET POLYDATA or UNSTRUCTURED_GRID");
  refuse("g", "<VTKFile type=\"ImageData\">\n</VTKFile>\n",
         "the type UnstructuredGrid or PolyData is expected, not 'ImageData'");
  refuse("g", "<VTKFile type=\"PolyData\" compressor=\"vtkLZ4DataCompressor\">\n</VTKFile>\n",
         "packed by vtkLZ4DataCompressor");
  CHECK(contains(refusal(folder / "missing.csv"), "missing.csv: No such file"));
  CHECK(contains(refusal(folder.path()), "it is a folder"));
}

TEST_CASE("bad parameters of a file are refused by name") {
  const auto refuse = [](FromFile::Parameters parameters, const char* what) {
    CHECK_THROWS_WITH_AS(FromFile{parameters}, doctest::Contains(what), core::InvalidInput);
  };
  refuse({}, "file of the packing = ''");
  refuse({.file = "a", .scale = 0}, "scale of the file's lengths = 0");
  refuse({.file = "a", .radius = -1}, "radius of the spheres = -1");
  refuse({.file = "a", .box = geometry::Box{Vec3::Zero(), Vec3::Zero(), {}}}, "edge of the box along x");
}

TEST_CASE("zlib streams of every kind of block, made by zlib") {
  const auto decode = [](const char* base64, std::size_t length) {
    return io::detail::Inflater(io::detail::decode_base64(base64).value()).decode(length);
  };
  std::string squares, letters;
  for (int i = 0; i < 150; ++i)
    squares += std::to_string(i * i % 97) + " " + std::to_string(i) + "\n";
  for (int i = 0; i < 20; ++i)
    letters += "abcabcabcabc";
  const char* dynamic =
      "eNolkskBxDAIA/9UQQnmhv4bWyn7cRwSLmmePjE1SXU5DbHWFC8tidaWPB3p1JU1PQm1J55qSBg1l3G1EBwpgTIljXvLldpI4PeV"
      "eWon5upPKtRNrtVdEi1DztRTEvGSQ6SlnvrIqq90qZ/4aDzZ1TCp1HBx1whZzJvSpoFhS6PFcEdqayAX50mu5pNwTRPD3QX7oWto"
      "pmxplsxptgzuI4P4fucxUo9fy/hnObMqUKCStapYt5o9ativlr3rOEc/ztTG+do5awfn7uQOXdynm7v1cM9GrvZx+3lUYoyqjFOh"
      "Cao1SeWmqOI0FZ2hurNUeo6q76MDa3RjIZRu0KNN+rVF77Zh4w4N3f28Pdp8j46f0fxzcnDQSQ+ZegVGruXpDW/LGPqBhsc/7X1p"
      "9pw17AUL2ktWt1dsZa8/eubD5+3Hz7sPIDKF8xvaABUZAlWEiFwhDWARI/u2NqBVDC71MMAFcQx0QSnzTzYDX8dgUFADYYuzKLT5"
      "p7qRMQaXfhgxI8qPTll8thlIg4cG1IxvSXcNsDUfn+8G3IJ5SyIMwOETgAMplh82BuTAkAG64VuSLiN2fPQ/OP9f9p9w8gM2aJZn";
  CHECK(decode(dynamic, squares.size()) == squares);
  CHECK_FALSE(decode(dynamic, squares.size() - 1));
  CHECK_FALSE(decode(dynamic, squares.size() + 1));
  CHECK(decode("eNpLTEpOHEmoorIKAFhLXUw=", 243) == letters + "xyz");
  CHECK(decode("eAEBDADz/3N0b3JlZCBieXRlcx/PBNk=", 12) == "stored bytes");
  CHECK_FALSE(decode("eAEBDADz/3N0b3JlZCBieXRlcx/PBNg=", 12)); // another checksum
  CHECK_FALSE(io::detail::decode_base64("?"));
}

#pragma once

/// @file
/// Spheres from LAMMPS: data files (read_data, write_data) and text dumps (dump atom, dump custom).

#include <cdem/io/detail/line_reader.hpp>

#include <algorithm>
#include <numeric>

namespace cdem::io::detail {

/// The spheres in the order of their ids, which neither kind of file keeps; each id comes once.
inline void sort_by_id(SphereFile& file, const std::vector<std::uint64_t>& ids, const LineReader& reader) {
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });
  for (std::size_t k = 1; k < order.size(); ++k)
    if (ids[order[k]] == ids[order[k - 1]])
      reader.fail("the atoms that end here have the id " + std::to_string(ids[order[k]]) + " twice");
  particles::ParticleSet sorted;
  for (const std::size_t old : order) {
    sorted.position.push_back(file.particles.position[old]);
    sorted.radius.push_back(file.particles.radius[old]);
    sorted.phase.push_back(file.particles.phase[old]);
  }
  file.particles = std::move(sorted);
}

/// Type t of LAMMPS, from 1, is phase t - 1.
inline PhaseIndex phase_of_type(const LineReader& reader, std::string_view text) {
  const auto type = reader.whole(text, "atom type", 256);
  if (type == 0)
    reader.fail("atom type is 0, types from 1 are expected");
  return static_cast<PhaseIndex>(type - 1);
}

/// Where the columns of an atom style are; image flags may follow.
struct AtomStyle {
  std::size_t columns, type, diameter, x; ///< diameter 0: points
};

inline AtomStyle atom_style(const LineReader& reader, std::string_view name, std::size_t columns) {
  if (name == "sphere" || (name.empty() && (columns == 7 || columns == 10)))
    return {7, 1, 2, 4}; // id type diameter density x y z
  if (name == "bpm/sphere")
    return {8, 2, 3, 5}; // id molecule type diameter density x y z
  if (name == "atomic" || (name.empty() && columns == 5))
    return {5, 1, 0, 2}; // id type x y z
  if (name == "bond" || name == "molecular" || name == "angle")
    return {6, 2, 0, 3}; // id molecule type x y z
  reader.fail(name.empty()
                  ? "the section Atoms does not name its style, and " + std::to_string(columns) +
                        " columns do not tell it: 'Atoms # sphere' is expected"
                  : "atom style '" + std::string(name) +
                        "' is not read; sphere, bpm/sphere, atomic, bond, angle or molecular is expected");
}

/// Reads a data file: header, box, section Atoms. Other sections are skipped. The box is periodic, LAMMPS's default, since the
/// file does not say.
inline SphereFile read_lammps_data(const std::filesystem::path& path) {
  LineReader reader(path);
  SphereFile file;
  geometry::Box box{Vec3::Zero(), Vec3::Zero(), {true, true, true}};
  std::array<bool, 3> bounded{};
  std::optional<std::uint64_t> atoms;
  std::vector<std::string_view> fields;
  reader.need("a line of title");
  for (;;) { // the header, up to the atoms
    reader.need("the section Atoms");
    const std::string_view line = reader.line();
    split(line.substr(0, line.find('#')), ' ', fields);
    if (fields.size() == 2 && fields[1] == "atoms")
      atoms = reader.whole(fields[0], "number of atoms");
    for (std::size_t k = 0; k < 3; ++k)
      if (fields.size() == 4 && fields[2] == std::string{"xyz"[k], 'l', 'o'}) {
        box.lower[static_cast<Eigen::Index>(k)] = reader.finite(fields[0], fields[2]);
        box.upper[static_cast<Eigen::Index>(k)] = reader.finite(fields[1], fields[3]);
        bounded[k] = true;
      }
    if (fields.size() == 6 && fields[3] == "xy" &&
        std::any_of(fields.begin(), fields.begin() + 3,
                    [&](auto tilt) { return reader.finite(tilt, "tilt") != 0; }))
      reader.fail("the box is tilted, a rectangular one is expected");
    if (fields.size() == 1 && fields[0] == "Atoms")
      break;
  }
  if (!atoms)
    reader.fail("a line '<number> atoms' is expected before the section Atoms");
  if (!(bounded[0] && bounded[1] && bounded[2]))
    reader.fail("lines with xlo xhi, ylo yhi and zlo zhi are expected before the section Atoms");
  file.box = box;

  const std::string_view heading = reader.line();
  const std::size_t mark = heading.find('#');
  const std::string name(mark == heading.npos ? "" : trimmed(heading.substr(mark + 1)));
  std::vector<std::uint64_t> ids;
  while (ids.size() < *atoms) {
    reader.need("atom " + std::to_string(ids.size() + 1) + " of " + std::to_string(*atoms));
    split(reader.line().substr(0, reader.line().find('#')), ' ', fields);
    if (fields.empty())
      continue;
    const AtomStyle style = atom_style(reader, name, fields.size());
    if (fields.size() != style.columns + 3) // image flags
      reader.expect_fields(fields.size(), style.columns);
    Vec3 centre;
    for (std::size_t k = 0; k < 3; ++k)
      centre[static_cast<Eigen::Index>(k)] = reader.finite(fields[style.x + k], std::string(1, "xyz"[k]));
    std::optional<double> radius;
    if (style.diameter > 0)
      radius = reader.finite(fields[style.diameter], "diameter") / 2;
    ids.push_back(reader.whole(fields[0], "atom id", ~std::uint64_t{0}));
    file.add(reader, centre, radius, phase_of_type(reader, fields[style.type]));
  }
  sort_by_id(file, ids, reader);
  return file;
}

/// Columns of a dump's atoms.
struct DumpColumns {
  std::array<int, 3> centre{-1, -1, -1};
  std::array<bool, 3> scaled{};
  int id = -1, type = -1, radius = -1, diameter = -1;
  std::size_t count = 0;

  DumpColumns(const LineReader& reader, const std::vector<std::string_view>& names) : count(names.size()) {
    for (std::size_t c = 0; c < count; ++c) {
      const std::string_view name = names[c];
      const int at = static_cast<int>(c);
      for (std::size_t k = 0; k < 3; ++k)
        if (!name.empty() && name.front() == "xyz"[k]) {
          const std::string_view kind = name.substr(1); // unwrapped, scaled, both
          if (kind.empty() || kind == "u" || kind == "s" || kind == "su") {
            centre[k] = at;
            scaled[k] = kind.starts_with("s");
          }
        }
      (name == "id"         ? id
       : name == "type"     ? type
       : name == "radius"   ? radius
       : name == "diameter" ? diameter
                            : unused_) = at;
    }
    if (*std::min_element(centre.begin(), centre.end()) < 0)
      reader.fail("columns x, y and z (or xs, xu, xsu and so on) are expected among the atoms'");
  }

private:
  int unused_ = -1;
};

/// Reads a text dump; of several snapshots the last. Directions marked pp are periodic.
inline SphereFile read_lammps_dump(const std::filesystem::path& path) {
  LineReader reader(path);
  SphereFile file;
  std::vector<std::string_view> fields;
  std::optional<std::uint64_t> atoms;
  std::optional<geometry::Box> box;
  while (reader.next()) {
    const std::string heading(trimmed(reader.line()));
    if (heading == "ITEM: NUMBER OF ATOMS") {
      reader.need("the number of atoms");
      atoms = reader.whole(trimmed(reader.line()), "number of atoms");
    } else if (heading.starts_with("ITEM: BOX BOUNDS")) {
      const std::string marks = heading.substr(16);
      split(marks, ' ', fields);
      if (!fields.empty() && (fields[0] == "xy" || fields[0] == "abc"))
        reader.fail("the box is tilted, a rectangular one is expected");
      box.emplace();
      for (std::size_t k = 0; k < 3; ++k)
        box->periodic[k] = k < fields.size() && fields[k] == "pp";
      for (int k = 0; k < 3; ++k) {
        reader.need("the bounds of the box");
        split(reader.line(), ' ', fields);
        reader.expect_fields(fields.size(), 2);
        box->lower[k] = reader.finite(fields[0], "lower bound");
        box->upper[k] = reader.finite(fields[1], "upper bound");
      }
    } else if (heading.starts_with("ITEM: ATOMS")) {
      if (!atoms || !box)
        reader.fail("the number of atoms and the bounds of the box are expected before");
      split(std::string_view(heading).substr(11), ' ', fields);
      const DumpColumns columns(reader, fields);
      file = SphereFile();
      file.box = box;
      std::vector<std::uint64_t> ids;
      for (std::uint64_t a = 0; a < *atoms; ++a) {
        reader.need("atom " + std::to_string(a + 1) + " of " + std::to_string(*atoms));
        split(reader.line(), ' ', fields);
        reader.expect_fields(fields.size(), columns.count);
        const auto at = [&](int column) { return fields[static_cast<std::size_t>(column)]; };
        Vec3 centre;
        for (std::size_t k = 0; k < 3; ++k) {
          const auto axis = static_cast<Eigen::Index>(k);
          const double value = reader.finite(at(columns.centre[k]), std::string(1, "xyz"[k]));
          centre[axis] = columns.scaled[k] ? box->lower[axis] + value * box->size()[axis] : value;
        }
        std::optional<double> radius;
        if (columns.radius >= 0)
          radius = reader.finite(at(columns.radius), "radius");
        else if (columns.diameter >= 0)
          radius = reader.finite(at(columns.diameter), "diameter") / 2;
        ids.push_back(columns.id >= 0 ? reader.whole(at(columns.id), "atom id", ~std::uint64_t{0}) : a);
        file.add(reader, centre, radius,
                 columns.type >= 0 ? phase_of_type(reader, at(columns.type)) : PhaseIndex{0});
      }
      sort_by_id(file, ids, reader);
    }
    // ITEM: TIMESTEP, UNITS, TIME and their values are passed over
  }
  if (file.particles.size() == 0)
    reader.fail("the file ends without an atom");
  return file;
}

} // namespace cdem::io::detail

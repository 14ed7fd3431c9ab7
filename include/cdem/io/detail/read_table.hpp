#pragma once

/// @file
/// Spheres from tables: CSV, and what YADE's export.text, export.textExt and SpherePack.save write.

#include <cdem/io/detail/line_reader.hpp>

#include <algorithm>
#include <array>

namespace cdem::io::detail {

/// Which column holds what; -1: none does.
struct TableColumns {
  std::array<int, 3> centre{-1, -1, -1};
  int radius = -1, diameter = -1, phase = -1;
  std::size_t count = 0; ///< of columns in every row

  bool complete() const { return *std::min_element(centre.begin(), centre.end()) >= 0; }

  /// Columns with these names; what is not known is ignored.
  static TableColumns named(const std::vector<std::string_view>& names) {
    TableColumns columns;
    columns.count = names.size();
    for (std::size_t c = 0; c < names.size(); ++c) {
      const std::string name = plain_name(names[c]);
      const int at = static_cast<int>(c);
      for (std::size_t k = 0; k < 3; ++k) { // "Points:0" is ParaView's
        const std::string letter(1, "xyz"[k]), digit = std::to_string(k);
        if (name == letter || name == "points:" + digit || name == "points_" + digit)
          columns.centre[k] = at;
      }
      if (names_radius(name))
        columns.radius = at;
      else if (names_diameter(name))
        columns.diameter = at;
      else if (names_phase(name))
        columns.phase = at;
    }
    return columns;
  }
};

/// Reads a table of spheres, one a line, separated by commas, semicolons or blanks.
///
/// Columns are those of the first line, where it holds names, or of a comment "#format x_y_z_r_matId" as YADE writes it;
/// else x y z radius, and where there is a fifth the phase (between blanks: YADE's number of a clump, which is ignored). Lines that begin with # and empty ones are skipped, but for
/// "##PERIODIC:: a b c", YADE's periodic box from the origin.
inline SphereFile read_table(const std::filesystem::path& path) {
  LineReader reader(path);
  SphereFile file;
  TableColumns columns;
  char separator = 0;
  bool ends_open = false; // further columns may follow
  std::vector<std::string_view> fields;
  while (reader.next()) {
    std::string_view line = trimmed(reader.line());
    if (line.starts_with("\xef\xbb\xbf")) // what some spreadsheets begin with
      line.remove_prefix(3);
    if (line.starts_with("##PERIODIC::")) {
      split(line.substr(12), ' ', fields);
      reader.expect_fields(fields.size(), 3);
      geometry::Box box{Vec3::Zero(), Vec3::Zero(), {true, true, true}};
      for (std::size_t k = 0; k < 3; ++k)
        box.upper[static_cast<Eigen::Index>(k)] = reader.finite(fields[k], "edge of the periodic cell");
      file.box = box;
      continue;
    }
    if (line.starts_with("#format ")) {
      split(line.substr(8), '_', fields);
      ends_open = !fields.empty() && fields.back() == "attrs";
      if (ends_open)
        fields.pop_back();
      columns = TableColumns::named(fields);
      if (!columns.complete() || columns.radius < 0)
        reader.fail("the format '" + std::string(line.substr(8)) + "' does not name x, y, z and r");
      separator = ' ';
    }
    if (line.empty() || line.front() == '#')
      continue;
    if (separator == 0)
      separator = line.find(',') != line.npos ? ',' : line.find(';') != line.npos ? ';' : ' ';
    split(line, separator, fields);
    if (columns.count == 0) { // the first line that is no comment
      if (!number_in<double>(fields.front())) {
        columns = TableColumns::named(fields);
        if (!columns.complete())
          reader.fail("columns called x, y and z are expected in '" + std::string(line) + "'");
        continue;
      }
      if (fields.size() != 4 && fields.size() != 5)
        reader.fail("it has " + std::to_string(fields.size()) +
                    " columns; x y z radius, or x y z radius phase, or a first line of names is expected");
      columns = {{0, 1, 2}, 3, -1, fields.size() == 5 && separator != ' ' ? 4 : -1, fields.size()};
    }
    if (!(ends_open && fields.size() > columns.count))
      reader.expect_fields(fields.size(), columns.count);
    const auto at = [&](int column) { return fields[static_cast<std::size_t>(column)]; };
    Vec3 centre;
    for (std::size_t k = 0; k < 3; ++k)
      centre[static_cast<Eigen::Index>(k)] = reader.finite(at(columns.centre[k]), std::string(1, "xyz"[k]));
    std::optional<double> radius;
    if (columns.radius >= 0)
      radius = reader.finite(at(columns.radius), "radius");
    else if (columns.diameter >= 0)
      radius = reader.finite(at(columns.diameter), "diameter") / 2;
    const auto phase = columns.phase >= 0 ? reader.whole(at(columns.phase), "phase", 255) : 0;
    file.add(reader, centre, radius, static_cast<PhaseIndex>(phase));
  }
  if (file.particles.size() == 0)
    reader.fail("the file ends without a sphere");
  return file;
}

} // namespace cdem::io::detail

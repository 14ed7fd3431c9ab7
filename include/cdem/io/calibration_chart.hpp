#pragma once

/// @file
/// Charts kept in files, so that a kind of packing is measured once.

#include <cdem/homogenize/calibration_chart.hpp>
#include <cdem/io/atomic_file.hpp>
#include <cdem/io/csv.hpp>

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace cdem::io {

namespace detail {

inline constexpr std::string_view chart_heading = "cdem calibration chart 1";

/// The numbers of a chart by name, in the order of the file.
template <class Chart, class Visit>
void visit_chart(Chart& chart, Visit&& visit) {
  visit("coordination", chart.coordination);
  visit("micro_poissons_ratio", chart.micro_poissons_ratio);
  visit("particles", chart.particles);
  visit("packings", chart.packings);
  visit("smallest_ratio", chart.smallest_ratio);
  visit("largest_ratio", chart.largest_ratio);
  visit("modulus", chart.modulus.coefficients);
  visit("poissons_ratio", chart.poissons_ratio.coefficients);
  visit("modulus_residual", chart.modulus_residual);
  visit("poissons_residual", chart.poissons_residual);
  visit("modulus_scatter", chart.modulus_scatter);
  visit("poissons_scatter", chart.poissons_scatter);
  visit("scatter_correlation", chart.scatter_correlation);
}

/// The lines of a file, taken one after the other.
class ChartReader {
public:
  ChartReader(std::string text, std::string source) : text_(std::move(text)), source_(std::move(source)) {}

  [[noreturn]] void fail(const std::string& why) const {
    throw core::FileError("cannot read " + source_ + ": " + why);
  }
  bool at_end() const { return at_ == text_.size(); }
  std::string line() {
    const std::size_t end = text_.find('\n', at_);
    if (end == text_.npos)
      fail("it ends in the middle of a line");
    const std::size_t begin = std::exchange(at_, end + 1);
    return text_.substr(begin, end - begin);
  }
  /// The value of the line `name = value` that must come next.
  std::string value(std::string_view name) {
    const std::string text = line(), start = std::string(name) + " = ";
    if (text.rfind(start, 0) != 0)
      fail("'" + start + "...' is expected where it has '" + text + "'");
    return text.substr(start.size());
  }
  template <class Number>
  Number number(std::string_view name, const std::string& text) const {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      fail(std::string(name) + " is '" + text + "', a number is expected");
    return value;
  }
  template <class Number>
  void operator()(std::string_view name, Number& number) {
    number = this->number<Number>(name, value(name));
  }
  void operator()(std::string_view name, std::vector<double>& numbers) {
    std::istringstream words(value(name));
    for (std::string word; words >> word;)
      numbers.push_back(number<double>(name, word));
  }

private:
  std::string text_, source_;
  std::size_t at_ = 0;
};

} // namespace detail

/// Writes a chart as text, a line a value; the file appears whole.
/// @throws core::InvalidInput for a chart that is not valid or whose name is of more than one line
/// @throws core::FileError    if the file cannot be written
inline void save_chart(const std::filesystem::path& path, const homogenize::CalibrationChart& chart) {
  chart.validate();
  core::expect(chart.name.find('\n') == chart.name.npos, "name of the chart", chart.name,
               "one line is expected");
  std::string text = std::string(detail::chart_heading) + "\nname = " + chart.name + "\n";
  detail::visit_chart(chart, [&](std::string_view name, const auto& value) {
    text += std::string(name) + " =";
    if constexpr (requires { value.size(); })
      for (const double number : value)
        text += " " + number_to_text(number);
    else
      text += " " + number_to_text(value);
    text += '\n';
  });
  std::istringstream lines(chart.ecd);
  for (std::string line; std::getline(lines, line);)
    text += "ecd " + line + "\n";
  AtomicFile file(path);
  file.write(text + "end\n");
  file.commit();
}

/// Reads a chart.
/// @throws core::FileError if the file cannot be read, is not of this version, is cut short, or holds no valid chart
inline homogenize::CalibrationChart load_chart(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  detail::ChartReader reader(std::string(std::istreambuf_iterator<char>(in), {}), path.string());
  if (!in.is_open())
    reader.fail("there is no such file, or it may not be read");
  if (const std::string heading = reader.at_end() ? "" : reader.line(); heading != detail::chart_heading)
    reader.fail("it begins with '" + heading + "', '" + std::string(detail::chart_heading) + "' is expected");
  homogenize::CalibrationChart chart;
  chart.name = reader.value("name");
  detail::visit_chart(chart, reader);
  for (std::string line = reader.line(); line != "end"; line = reader.line()) {
    if (line.rfind("ecd ", 0) != 0)
      reader.fail("'ecd ...' or 'end' is expected where it has '" + line + "'");
    chart.ecd += line.substr(4) + "\n";
  }
  if (!reader.at_end())
    reader.fail("it goes on after its end");
  try {
    chart.validate();
  } catch (const core::InvalidInput& error) {
    reader.fail(error.what());
  }
  return chart;
}

/// The chart in `path` if it is of this ecd, else what `measure()` gives, which is kept there.
///
///     const auto chart = io::kept_chart("mine.chart", ecd, [&] { return homogenize::measure_chart<...>(...).chart; });
///
/// A file that is damaged is named on stderr and made anew; one of another ecd is not overwritten.
/// @param ecd      everything that the chart depends on, one `name = value` a line
/// @param measure  returns the chart
/// @throws core::FileError if the file holds the chart of another ecd, or cannot be written; what measure throws
template <class Measure>
homogenize::CalibrationChart kept_chart(const std::filesystem::path& path, const std::string& ecd,
                                        Measure&& measure) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) {
    std::string damage;
    try {
      homogenize::CalibrationChart chart = load_chart(path);
      if (chart.ecd == ecd)
        return chart;
    } catch (const core::FileError& error) {
      damage = error.what();
    }
    if (damage.empty())
      throw core::FileError("cannot use " + path.string() + ": it is the chart of another kind of packing");
    std::fprintf(stderr, "%s; it is measured anew\n", damage.c_str());
  }
  homogenize::CalibrationChart chart = measure();
  chart.ecd = ecd;
  save_chart(path, chart);
  return chart;
}

} // namespace cdem::io

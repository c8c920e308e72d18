#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "vbond/case/value.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/setup/csv_table.hpp"
#include "vbond/setup/specimens/specimen.hpp"
#include "vbond/setup/text_file.hpp"

namespace vbond {
namespace {

using Columns = std::array<std::vector<double>, csv_columns.size()>;

std::size_t column_number(std::string_view name) {
  const auto is_it = [name](const CsvColumn& c) { return c.name == name; };
  return static_cast<std::size_t>(std::find_if(csv_columns.begin(), csv_columns.end(), is_it) -
                                  csv_columns.begin());
}

/// What the numbers of a column are multiplied by.
double factor_of(const CsvSpecimen& spec, std::size_t column) {
  if (spec.units[column]) return spec.units[column]->factor;
  double factor = 1.0;
  for (int k = 0; k < csv_columns[column].dimension.length; ++k) factor *= spec.scale;
  return factor;
}

/// Reads the columns of one file, those that are not there as empty.
class CsvReader {
 public:
  explicit CsvReader(const CsvSpecimen& spec) : spec_(spec), file_(spec.file.value) {
    std::vector<WantedColumn> wanted;
    for (std::size_t k = 0; k < csv_columns.size(); ++k) {
      const bool required = k < 3;  // x, y, z
      if (!spec.names_columns())
        wanted.push_back({csv_columns[k].name, required});
      else if (spec.columns[k])
        wanted.push_back({*spec.columns[k], true});
      else
        continue;
      column_.push_back(k);
    }
    table_ = read_csv(file_, spec.file.place, wanted,
                      {spec.names_columns(),
                       "remove it, or name in the case the columns that are read, so that others are not: "
                       "columns = { x = \"...\", y = \"...\", z = \"...\" }"});
    for (std::size_t n = 0; n < column_.size(); ++n)
      if (table_.found[n]) read(n);
    check_units();
    if (table_.rows() == 0)
      problems_.add({file_.string(), 0, 0}, "the file holds no particles",
                    "one line per particle follows the header", "add particles");
  }

  SpecimenPoints points() {
    SpecimenPoints points;
    points.radius = of("radius"), points.mass = of("mass"), points.inertia = of("inertia");
    points.moments = vectors({"inertia_x", "inertia_y", "inertia_z"},
                             "the moments of inertia about three axes belong together",
                             "add the missing ones, or use inertia");
    points.v = vectors({"vx", "vy", "vz"}, "three components make a velocity", "add the missing ones");
    points.omega =
        vectors({"wx", "wy", "wz"}, "three components make an angular velocity", "add the missing ones");
    read_orientations(points);
    points.r = vectors({"x", "y", "z"}, "three coordinates make a place", "add the missing ones");
    note(points);
    problems_.throw_if_any();
    if (!points.v.empty()) points.omega.resize(points.v.size());
    if (!points.omega.empty()) points.v.resize(points.omega.size());
    return points;
  }

 private:
  const std::vector<double>& of(const char* name) const { return values_[column_number(name)]; }
  bool is_there(const char* name) const { return there_[column_number(name)]; }

  void read(std::size_t n) {
    const std::size_t k = column_[n];
    const double factor = factor_of(spec_, k);
    there_[k] = true;
    values_[k].reserve(table_.rows());
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      const std::string& text = table_.fields[n][row];
      const double value = factor * to_number(text).value_or(std::numeric_limits<double>::infinity());
      if (!(std::abs(value) <= keys::largest_number)) refuse_number(csv_columns[k].name, text, row);
      values_[k].push_back(value);
    }
  }

  void refuse_number(const char* name, const std::string& text, std::size_t row) {
    const bool comma = text.find(',') != std::string::npos;
    problems_.add({file_.string(), table_.lines[row], 1}, fmt::format("{} = {}", name, shown_field(text)),
                  comma ? "numbers have a decimal point" : "must be a finite number, at most 1e60 in size",
                  comma ? "save the file with points in place of commas" : "correct the field");
  }

  /// A unit of a column that is not there is a slip of the pen.
  void check_units() {
    for (std::size_t k = 0; k < csv_columns.size(); ++k)
      if (spec_.units[k] && !there_[k])
        problems_.add(spec_.file.place,
                      fmt::format("units.{} = \"{}\"", csv_columns[k].name, spec_.units[k]->text),
                      "no column of the file is read as that", "remove it, or name the column in columns");
  }

  /// Nothing where none of the columns is there.
  std::vector<Vec3d> vectors(const std::array<const char*, 3>& names, const char* rule, const char* way_out) {
    std::vector<Vec3d> v;
    if (!all_or_none(names, rule, way_out)) return v;
    const std::vector<double>&x = of(names[0]), &y = of(names[1]), &z = of(names[2]);
    v.reserve(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) v.push_back({x[i], y[i], z[i]});
    return v;
  }

  /// True if all are there.
  template <std::size_t N>
  bool all_or_none(const std::array<const char*, N>& names, const char* rule, const char* way_out) {
    const auto there = static_cast<std::size_t>(
        std::count_if(names.begin(), names.end(), [this](const char* name) { return is_there(name); }));
    if (there > 0 && there < N)
      problems_.add({file_.string(), table_.header_line, 1},
                    fmt::format("columns {} are not all there", fmt::join(names, ", ")), rule, way_out);
    return there == N;
  }

  /// Numbers that were rounded when they were written are made a rotation again.
  void read_orientations(SpecimenPoints& points) {
    constexpr double most = 1e-3;  // four numbers of three digits each are off by less
    if (!all_or_none(std::array{"qw", "qx", "qy", "qz"}, "four numbers make a quaternion",
                     "add the missing ones"))
      return;
    const std::vector<double>&w = of("qw"), &x = of("qx"), &y = of("qy"), &z = of("qz");
    points.orientations.reserve(w.size());
    for (std::size_t i = 0; i < w.size(); ++i) {
      const double length = std::sqrt(w[i] * w[i] + x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
      if (std::isinf(length)) continue;  // of a field that is no number, which is told
      if (!(std::abs(length - 1.0) <= most))
        problems_.add({file_.string(), table_.lines[i], 1},
                      fmt::format("the quaternion {}, {}, {}, {} has the length {:.6g}", w[i], x[i], y[i],
                                  z[i], length),
                      "an orientation is a quaternion of length 1, to 1e-3",
                      "correct the row; qw is the real part, cos(angle/2)");
      else
        points.orientations.push_back(normalised(Quatd{w[i], x[i], y[i], z[i]}));
    }
  }

  void note(SpecimenPoints& points) const {
    const std::string name = file_.string();
    if (!table_.passed_over.empty()) {
      std::vector<std::string> titles;
      for (const std::string& title : table_.passed_over)
        if (titles.size() < 10) titles.push_back(shown_field(title));
      const std::size_t more = table_.passed_over.size() - titles.size();
      points.notes.push_back(fmt::format("{}: not read are the columns {}{}", name, fmt::join(titles, ", "),
                                         more > 0 ? fmt::format(" and {} more", more) : ""));
    }
    if (!points.v.empty() || !points.omega.empty())
      points.notes.push_back(fmt::format("{}: its velocities are where the run begins", name));
  }

  const CsvSpecimen& spec_;
  const std::filesystem::path& file_;
  Problems problems_;
  std::vector<std::size_t> column_;  ///< of csv_columns, for each wanted one
  CsvTable table_;
  Columns values_;
  std::array<bool, csv_columns.size()> there_{};
};

/// Of one type no pair is there twice. lines: of the bonds.
void refuse_doubled(const std::vector<FileBond>& bonds, const std::vector<std::uint32_t>& lines,
                    const std::filesystem::path& file, Problems& problems) {
  std::vector<std::tuple<std::int64_t, std::int64_t, std::int64_t, std::uint32_t>> in_order;
  for (std::size_t n = 0; n < bonds.size(); ++n) {
    const auto [low, high] = std::minmax(bonds[n].pair[0], bonds[n].pair[1]);
    in_order.emplace_back(low, high, bonds[n].type, lines[n]);
  }
  std::sort(in_order.begin(), in_order.end());
  for (std::size_t n = 1; n < in_order.size(); ++n) {
    const auto& [i, j, type, line] = in_order[n];
    const auto& [other_i, other_j, other_type, other_line] = in_order[n - 1];
    if (std::tie(i, j, type) == std::tie(other_i, other_j, other_type))
      problems.add({file.string(), line, 1}, fmt::format("pair {}, {}", i, j),
                   fmt::format("the pair is there already, in line {}", other_line), "remove one of them");
  }
}

std::vector<FileBond> read_bonds(const std::filesystem::path& file, const SourcePlace& place,
                                 std::int64_t particles) {
  const CsvTable table =
      read_csv(file, place, {{"i", true}, {"j", true}, {"type", false}}, {false, "remove it"});
  Problems problems;
  std::vector<FileBond> bonds;
  PairNumbers numbers(particles);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const SourcePlace at{file.string(), table.lines[row], 1};
    const auto i = to_integer(table.fields[0][row]), j = to_integer(table.fields[1][row]);
    const auto type = table.found[2] ? to_integer(table.fields[2][row]) : 1;
    if (!i || !j || !type || *type < 1) {
      problems.add(at, "the row is not understood", "i and j are whole numbers from 0, a type is one from 1",
                   "correct the row");
      continue;
    }
    numbers.see(*i), numbers.see(*j);
    bonds.push_back({{*i, *j}, *type});
  }
  for (std::size_t n = 0, rows = problems.none() ? bonds.size() : 0; n < rows; ++n) {
    const auto [i, j] = bonds[n].pair;
    const SourcePlace at{file.string(), table.lines[n], 1};
    for (const std::int64_t end : {i, j})
      if (end < 0 || end >= particles)
        problems.add(at, fmt::format("there is no particle {}", end),
                     fmt::format("the specimen's file has particles 0 to {}", particles - 1),
                     numbers.way_out());
    if (i == j)
      problems.add(at, fmt::format("pair {}, {}", i, j), "a bond joins two different particles",
                   "correct the pair");
  }
  refuse_doubled(bonds, table.lines, file, problems);
  problems.throw_if_any();
  return bonds;
}

}  // namespace

SpecimenPoints read_csv_specimen(const CsvSpecimen& spec) {
  SpecimenPoints points = CsvReader(spec).points();
  if (spec.bonds_file)
    points.bonds = read_bonds(spec.bonds_file->value, spec.bonds_file->place,
                              static_cast<std::int64_t>(points.r.size()));
  return points;
}

}  // namespace vbond

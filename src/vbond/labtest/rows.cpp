#include "vbond/labtest/rows.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/labtest/table.hpp"

namespace vbond::labtest {
namespace {

/// The extension of a fibre that has this Green strain.
double engineering(double green) {
  return 2.0 * green / (std::sqrt(1.0 + 2.0 * green) + 1.0);
}

/// Strain and work count from where the body is settled, of a triaxial test from where the pressure is on.
/// What it has done before is no part of the curve.
void count_from_begin(const MadeTest& test, std::vector<Row>& rows) {
  // the ends of a triaxial test bear the pressure on the area of the skin, beside their force
  const double offset = test.confinement ? test.confinement->axial - test.request.pressure : 0.0;
  const std::size_t begin = begin_of(test, rows);
  const double strain = rows[begin].at.strain, work = rows[begin].work;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].at.strain -= strain, rows[k].work -= work;
    if (k < begin)
      rows[k].at = {0, 0, 0};
    else
      rows[k].at.stress += offset;
  }
}

}  // namespace

std::size_t begin_of(const MadeTest& test, const std::vector<Row>& rows) {
  std::size_t k = 0;
  if (!test.request.at_rest && !test.confinement) return k;
  while (k + 1 < rows.size() && rows[k + 1].stage == 0) ++k;
  return k;
}

double share_broken(const std::vector<Row>& rows, const Row& row, std::size_t peak) {
  const auto broken = [&rows](const Row& r) { return static_cast<double>(r.broken - rows.front().broken); };
  return broken(row) / std::max(1.0, broken(rows[peak]));
}

std::vector<Row> read_rows(const MadeTest& test, const std::filesystem::path& file) {
  Table table(file);
  const std::string k(1, "xyz"[test.direction]);
  std::vector<Row> rows;
  double last_factor = 0;
  int stage = test.confinement ? -1 : 0;
  while (table.next()) {
    Row row;
    row.step = static_cast<std::int64_t>(table.number("step"));
    if (const auto factor = table.find("load_factor")) {
      if (*factor < last_factor) ++stage;
      row.stage = std::max(stage, 0);
      last_factor = *factor;
    } else if (test.confining > 0.0) {
      row.stage = table.number("time") > (test.confining + test.settling) * (1.0 + 1e-9) ? 1 : 0;
    }
    const double on_upper = test.sign * table.number("reaction." + test.upper + ".f" + k),
                 on_lower = test.sign * table.number("reaction." + test.lower + ".f" + k);
    const double force =
        0.5 * (on_upper - on_lower);  // in motion they differ, and the middle bears their mean
    const double way = test.sign * (table.number("displacement." + test.way + "." + k) -
                                    table.number("displacement." + test.lower + "." + k));
    row.at = {force * test.stress_per_force, way * test.strain_per_way, force};
    row.off_balance = on_upper + on_lower;
    if (test.gauge)
      for (const std::string& component : test.gauge->columns)
        if (const auto green = table.find("strain." + test.gauge->group + "." + component))
          row.gauge.push_back(test.sign *
                              (test.request.kind == Kind::shear ? 2.0 * *green : engineering(*green)));
    row.kinetic = table.number("kinetic_translation") + table.number("kinetic_rotation");
    row.work = table.number("work_supports");
    row.broken = static_cast<std::int64_t>(table.find("broken").value_or(0.0));
    row.fragments = table.find("fragments"), row.largest_fragment = table.find("largest_fragment");
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw IoError(file.string() + ": it has no rows");
  count_from_begin(test, rows);
  return rows;
}

}  // namespace vbond::labtest

#include <fmt/format.h>

#include "vbond/build/problems.hpp"
#include "vbond/build/specimens/specimen.hpp"
#include "vbond/build/text_file.hpp"

namespace vbond {

SpecimenPoints read_csv_specimen(const std::filesystem::path& file, const SourcePlace& place) {
  const CsvTable table = read_csv(
      file, place, {"x", "y", "z", "radius", "mass", "inertia", "inertia_x", "inertia_y", "inertia_z"},
      {"x", "y", "z"});
  Problems problems;
  const auto column = [&](const char* name) {
    std::vector<double> values;
    const auto k = table.find(name);
    if (!k) return values;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      const std::string& text = table.rows[row][*k];
      const auto value = to_number(text);
      if (!value)
        problems.add({file.string(), table.lines[row], 1}, fmt::format("{} = \"{}\"", name, text),
                     "must be a finite number", "correct the field");
      values.push_back(value.value_or(0.0));
    }
    return values;
  };
  const std::vector<double> x = column("x"), y = column("y"), z = column("z");
  SpecimenPoints points;
  points.radius = column("radius");
  points.mass = column("mass");
  points.inertia = column("inertia");
  const std::vector<double> I_x = column("inertia_x"), I_y = column("inertia_y"), I_z = column("inertia_z");
  if (I_x.size() != I_y.size() || I_y.size() != I_z.size())
    problems.add({file.string(), 1, 1}, "columns inertia_x, inertia_y and inertia_z are not all there",
                 "the moments of inertia about three axes belong together",
                 "add the missing ones, or use inertia");
  if (table.rows.empty())
    problems.add({file.string(), 0, 0}, "the file holds no particles",
                 "one line per particle follows the header", "add particles");
  problems.throw_if_any();
  for (std::size_t i = 0; i < x.size(); ++i) points.r.push_back({x[i], y[i], z[i]});
  for (std::size_t i = 0; i < I_x.size(); ++i) points.moments.push_back({I_x[i], I_y[i], I_z[i]});
  return points;
}

}  // namespace vbond

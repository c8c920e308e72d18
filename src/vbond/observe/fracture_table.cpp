#include "vbond/observe/fracture_table.hpp"

#include <fmt/format.h>

#include <iterator>
#include <optional>

namespace vbond {
namespace {

std::string cell(const std::optional<double>& x) {
  return x ? fmt::format("{:.17g}", *x) : "";
}

/// A name as a cell: in quotes if it has a comma, a quote or a line end.
std::string cell(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::string fracture_table(const RunSummary& summary) {
  fmt::memory_buffer text;
  for (const StageSummary& stage : summary.stages) {
    if (!stage.statics || stage.statics->kind != StageKind::fracture) continue;
    const auto to = std::back_inserter(text);
    if (text.size() == 0)
      fmt::format_to(to,
                     "stage,break,point,avalanche,bond,i,j,x,y,z,direction.x,direction.y,direction.z,"
                     "load_factor,load_factor_after,load,load_after,utilisation,N,V,M_b,M_t,share.tension,"
                     "share.shear,share.bending,share.torsion,share.compression,released,work,stored\n");
    int number = 0;
    for (const BrokenBond& b : stage.statics->result.fracture.breaks) {
      fmt::format_to(to, "{},{},{},{},{},{},{}", cell(stage.name), ++number, b.point, b.avalanche,
                     b.use.bond.value, b.use.i.value, b.use.j.value);
      for (const std::optional<double>& x : std::initializer_list<std::optional<double>>{
               b.middle.x,     b.middle.y,       b.middle.z,        b.direction.x,
               b.direction.y,  b.direction.z,    b.use.load_factor, b.load_factor_after,
               b.load,         b.load_after,     b.use.utilisation, b.section.N,
               b.section.V,    b.section.M_b,    b.section.M_t,     b.shares.tension,
               b.shares.shear, b.shares.bending, b.shares.torsion,  b.shares.compression,
               b.released,     b.work,           b.stored})
        fmt::format_to(to, ",{}", cell(x));
      fmt::format_to(to, "\n");
    }
  }
  return fmt::to_string(text);
}

}  // namespace vbond

#include <fmt/format.h>

#include <stdexcept>

#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

std::string row(const std::string& name, const Unit& unit, const std::string& meaning) {
  if (*unit.si == '\0') return fmt::format("| `{}` | | {} |\n", name, meaning);
  return fmt::format("| `{}` | {}; {} | {} |\n", name, unit.si, unit.reduced, meaning);
}

constexpr fmt::string_view head = "| {} | unit: SI; reduced | meaning |\n|---|---|---|\n";

std::string columns_of_history() {
  std::string text;
  for (const HistoryQuantity& q : history_quantities())
    text += row(q.name, q.unit, std::string(q.meaning) + in_words(q.cases));
  for (const GroupQuantity& q : group_quantities())
    for (const GroupQuantity::Component& c : q.components)
      text += row(fmt::format("{}.{}{}{}", q.name, q.of, *c.name == '\0' ? "" : ".", c.name), c.unit,
                  c.meaning != nullptr ? c.meaning : "the same");
  return text;
}

/// In which cases there is such a quantity.
template <class Quantity>
std::string words(const Quantity& q) {
  if constexpr (requires { q.cases; })
    return in_words(q.cases);
  else
    return "";
}

template <class Quantities>
std::string rows_of(const Quantities& quantities) {
  std::string text;
  for (const auto& q : quantities) text += row(q.name, q.unit, q.meaning + words(q));
  return text;
}

std::string data_sets() {
  std::string text;
  for (const CheckpointQuantity& q : checkpoint_quantities()) text += row(q.path, q.unit, q.meaning);
  return text;
}

}  // namespace

const char* in_words(Only cases) {
  switch (cases) {
    case Only::everywhere: return "";
    case Only::statics: return ". Only in cases with static stages";
    case Only::breaks: return ". Only where bonds may break";
    case Only::stress: return ". Only with `frames.stress`";
    case Only::capsules: return ". Only where bonds touch as capsules";
    case Only::flow: return ". Only where bonds yield, creep or soften";
    case Only::cell: return ". Only of periodic bodies";
    case Only::wrap: return ". Only with `frames.wrap`";
    case Only::passage: return ". Only in cases with a source or a sink";
  }
  return "";
}

std::string quantity_table(std::string_view where) {
  if (where == "history") return fmt::format(fmt::runtime(head), "column") + columns_of_history();
  if (where == "breaks") return fmt::format(fmt::runtime(head), "column") + rows_of(break_quantities());
  if (where == "fragments") return fmt::format(fmt::runtime(head), "column") + rows_of(fragment_quantities());
  if (where == "particles") return fmt::format(fmt::runtime(head), "array") + rows_of(particle_quantities());
  if (where == "bonds") return fmt::format(fmt::runtime(head), "array") + rows_of(bond_quantities());
  if (where == "walls") return fmt::format(fmt::runtime(head), "array") + rows_of(wall_quantities());
  if (where == "contacts") return fmt::format(fmt::runtime(head), "array") + rows_of(contact_quantities());
  if (where == "checkpoint") return fmt::format(fmt::runtime(head), "data set") + data_sets();
  throw std::invalid_argument("no table of quantities for " + std::string(where));
}

}  // namespace vbond

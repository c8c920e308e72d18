#include "vbond/observe/breaks.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "vbond/observe/fragments.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

template <class Quantities>
std::vector<std::string> names_of(const Quantities& quantities) {
  std::vector<std::string> names;
  for (const auto& q : quantities) names.emplace_back(q.name);
  return names;
}

template <class Quantities>
FactsOfColumn facts_in(const Quantities& quantities) {
  return [quantities](std::string_view name) -> std::optional<ColumnFacts> {
    for (const auto& q : quantities)
      if (name == q.name) return ColumnFacts{q.unit, q.meaning};
    return std::nullopt;
  };
}

template <class View>
std::vector<Cell> cells_of(std::span<const RowQuantity<View>> quantities, const View& view) {
  std::vector<Cell> cells;
  for (const RowQuantity<View>& q : quantities) cells.push_back(q.value(view));
  return cells;
}

void take_up(BreakRecord& record, double time, std::optional<double> load) {
  if (!record.first_time) record.first_time = time, record.first_load = load;
  if (load) record.largest_load = std::max(record.largest_load.value_or(0.0), *load);
}

}  // namespace

BreaksWriter::BreaksWriter(const OutputPlan& plan, std::optional<std::int64_t> resume_step)
    : file_(plan.folder / "breaks.csv",
            {.what = "a list of breaks",
             .columns = names_of(break_quantities()),
             .ordered_by = "step",
             .necessary = {"step", "time", "bond", "load"},
             .facts = facts_in(break_quantities()),
             .looker = [this](const std::vector<std::string>& columns) { return looker(record_, columns); }},
            plan.units, resume_step) {}

CsvWriter::Look BreaksWriter::looker(BreakRecord& record, const std::vector<std::string>& columns) {
  const std::size_t time_at = index_of(columns, "time").value(), load_at = index_of(columns, "load").value();
  return [&record, time_at, load_at](const std::vector<std::string>& cells) {
    const auto time = csv_number<double>(cells[time_at]), load = csv_number<double>(cells[load_at]);
    if (time) take_up(record, *time, load);
    return time.has_value();
  };
}

void BreaksWriter::write(const Clock& clock, const BondEvent& event, std::optional<double> load) {
  file_.write(cells_of(break_quantities(), BreakView{clock, event, load}));
  take_up(record_, clock.time(), load);
}

FragmentsWriter::FragmentsWriter(const OutputPlan& plan, std::optional<std::int64_t> stage)
    : file_(plan.folder / "fragments.csv",
            {.what = "a list of fragments",
             .columns = names_of(fragment_quantities()),
             .ordered_by = "stage",
             .necessary = {"stage", "fragment"},
             .facts = facts_in(fragment_quantities()),
             .looker = [](const auto&) { return [](const auto&) { return true; }; }},
            plan.units, stage ? std::optional(*stage - 1) : std::nullopt) {}

void FragmentsWriter::write(const Clock& clock, std::int64_t stage, const Fragments& fragments,
                            const FragmentMotion& motion) {
  for (std::size_t k = 0; k < fragments.all.size(); ++k)
    file_.write(cells_of(fragment_quantities(),
                         FragmentView{clock, stage, static_cast<std::int64_t>(k), fragments.all[k],
                                      motion.centre[k], motion.velocity[k]}));
}

void cut_breaks(const OutputPlan& plan, const Clock& resumed) {
  std::error_code e;
  if (std::filesystem::exists(plan.folder / "breaks.csv", e)) BreaksWriter(plan, resumed.step);
  if (std::filesystem::exists(plan.folder / "fragments.csv", e)) FragmentsWriter(plan, resumed.stage);
}

}  // namespace vbond

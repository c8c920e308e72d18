#include "vbond/fit/case_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/nearest.hpp"
#include "vbond/fit/bond_slopes.hpp"
#include "vbond/observe/history.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/run/memory_needed.hpp"
#include "vbond/run/plan_output.hpp"
#include "vbond/run/run.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::fit {
namespace {

double number_in(const Cell& cell) {
  if (const auto* x = std::get_if<double>(&cell)) return *x;
  if (const auto* n = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*n);
  return std::numeric_limits<double>::quiet_NaN();
}

/// Keeps the rows that HistoryObserver would write, and one at the beginning of each stage.
class RowsObserver final : public Observer {
 public:
  RowsObserver(const OutputPlan& plan, std::vector<std::size_t> places)
      : plan_(plan), places_(std::move(places)), due_(plan.history_every) {
    rows.columns.resize(places_.size());
  }
  void observe(const Simulation& run) override {
    if (due_.now(run.clock()))
      keep(run, false);
    else if (run.clock().stage_step == 0 && !rows.stage.empty())
      keep(run, true);
  }
  std::int64_t steps_to_next_look(const Clock& now) const override { return due_.steps_to_next(now); }
  void finish(const Simulation& run, StopReason why) override {
    if (stage_done(why) && due_.at_stage_end(run.clock())) keep(run, false);
  }
  void observe_balance(const BodyView& body, const BalancePoint& balance) override {
    keep(body, false);
    if (slopes != nullptr) slopes->at(body, balance, [this](const BodyView& b) { return numbers_of(b); });
  }

  Rows rows;
  BondSlopes* slopes = nullptr;  ///< followed too

 private:
  std::vector<double> numbers_of(const BodyView& body) const {
    const std::vector<Cell> row = history_row(plan_, history_values(plan_, body));
    std::vector<double> numbers;
    for (const std::size_t place : places_) numbers.push_back(number_in(row[place]));
    return numbers;
  }
  void keep(const BodyView& body, bool only_of_stage) {
    const std::vector<double> numbers = numbers_of(body);
    for (std::size_t k = 0; k < numbers.size(); ++k) rows.columns[k].push_back(numbers[k]);
    rows.stage.push_back(static_cast<std::size_t>(body.clock().stage));
    rows.only_of_stage.push_back(only_of_stage ? 1 : 0);
    due_.written(body.clock().step);
  }
  const OutputPlan& plan_;
  std::vector<std::size_t> places_;
  Due due_;
};

std::vector<std::size_t> places_of(const std::vector<std::string>& wanted, const OutputPlan& plan,
                                   const std::string& file) {
  const std::vector<std::string> columns = history_columns(plan);
  std::vector<std::size_t> places;
  std::string known;
  for (const std::string& name : columns) known += (known.empty() ? "" : ", ") + name;
  for (const std::string& name : wanted) {
    const auto place = index_of(columns, name);
    const auto near = nearest_name(name, columns);
    if (!place)
      throw CaseError(Problem{{file, 0, 0},
                              "column " + name,
                              "history.csv of this case has " + known,
                              near ? "did you mean " + *near + "?"
                                   : "name one of these, or ask for more in output.history of the case"});
    places.push_back(*place);
  }
  return places;
}

/// Forces on walls are those of the last run of forces: a balance beside, made anew, has none.
bool is_of_wall(const std::string& column) {
  return column.starts_with("wall.");
}

}  // namespace

Rows run_case(const CaseText& text, const std::vector<std::string>& changes,
              const std::vector<std::string>& columns, int threads, const std::function<bool()>& interrupted,
              const std::vector<Nudge>& nudges) {
  const Case c = parse_case(text.text, text.file, changes);
  require_statics(c);
  require_memory(c);
  Built built = build(c, threads);
  require_memory(c, built.model, built.state);
  Run run(std::move(built.model), std::move(built.state), stages_of(c, threads), threads);
  run.check();
  const OutputPlan plan = plan_output(c, run.model(), {});
  const auto rows = std::make_shared<RowsObserver>(plan, places_of(columns, plan, c.file));
  run.add_observer(std::make_shared<WatchObserver>(plan, [](const std::string&) {}));
  run.add_observer(rows);
  RunHooks hooks;
  hooks.interrupted = interrupted;
  run.set_hooks(std::move(hooks));
  std::optional<BondSlopes> slopes;
  const auto of_wall = std::find_if(columns.begin(), columns.end(), is_of_wall);
  if (of_wall != columns.end())
    rows->rows.slopes.assign(
        nudges.size(), {{}, fmt::format("{} is a number of a wall, which balances do not give", *of_wall)});
  else if (!nudges.empty())
    rows->slopes = &slopes.emplace(text, nudges, run, run.state());
  run.run();
  if (slopes) rows->rows.slopes = std::move(*slopes).take();
  rows->rows.interrupted = !run.complete();
  return std::move(rows->rows);
}

}  // namespace vbond::fit

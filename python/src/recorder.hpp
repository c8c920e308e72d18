#pragma once
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "vbond/observe/due.hpp"
#include "vbond/observe/history.hpp"

namespace vbond::python {

/// The rows of history.csv, in memory.
class Recorder : public Observer {
 public:
  explicit Recorder(OutputPlan plan) : plan_(std::move(plan)), due_(plan_.history_every) {}

  void observe(const Simulation& run) override {
    if (due_.now(run.clock())) add(run);
  }
  std::int64_t steps_to_next_look(const Clock& now) const override { return due_.steps_to_next(now); }
  void finish(const Simulation& run, StopReason why) override {
    const bool ended = why != StopReason::interrupted && why != StopReason::diverged;
    if (ended && due_.at_stage_end(run.clock())) add(run);
  }
  void observe_balance(const BodyView& body, const BalancePoint&) override { add(body); }
  py::dict columns() const { return columns_of(history_columns(plan_), rows_); }

 private:
  void add(const BodyView& body) {
    rows_.push_back(history_row(plan_, history_values(plan_, body)));
    for (Cell& cell : rows_.back())  // words belong to the values
      if (std::holds_alternative<std::string_view>(cell)) cell = std::monostate{};
    due_.written(body.clock().step);
  }

  OutputPlan plan_;
  Due due_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace vbond::python

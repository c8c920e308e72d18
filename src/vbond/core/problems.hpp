#pragma once
#include <cstddef>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond {

/// Gathers mistakes so that a user sees all of them at once: of each kind the first few, with the number of
/// the others. A kind is what breaks the same rule in the same file, whatever numbers stand in the rule.
class Problems {
 public:
  static constexpr std::size_t most_shown = 20;

  explicit Problems(std::size_t most_of_a_kind = most_shown) : most_(most_of_a_kind) {}

  void add(Problem p);
  void add(SourcePlace place, std::string what, std::string rule, std::string way_out) {
    add(Problem{std::move(place), std::move(what), std::move(rule), std::move(way_out)});
  }
  void add(const std::vector<Problem>& problems) {
    for (const Problem& p : problems) add(p);
  }
  void add(const CaseError& e) { add(e.problems()); }

  bool none() const { return count_ == 0; }
  std::size_t count() const { return count_; }  ///< also those that are not shown
  const std::vector<Problem>& shown() const { return shown_; }
  void throw_if_any() const {
    if (!none()) throw CaseError(shown_);
  }

 private:
  struct Kind {
    std::size_t shown = 0, last = 0;  ///< place in shown_ of the last one
  };

  std::size_t most_, count_ = 0;
  std::vector<Problem> shown_;
  std::unordered_map<std::string, Kind> kinds_;  ///< by file and rule
};

}  // namespace vbond

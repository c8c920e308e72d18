#pragma once
#include <string>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond {

/// Gathers mistakes so that a user sees all of them at once.
class Problems {
 public:
  void add(SourcePlace place, std::string what, std::string rule, std::string way_out) {
    list_.push_back({std::move(place), std::move(what), std::move(rule), std::move(way_out)});
  }
  void add(const CaseError& e) { list_.insert(list_.end(), e.problems().begin(), e.problems().end()); }
  bool none() const { return list_.empty(); }
  std::size_t count() const { return list_.size(); }
  void throw_if_any() const {
    if (!list_.empty()) throw CaseError(list_);
  }

 private:
  std::vector<Problem> list_;
};

}  // namespace vbond

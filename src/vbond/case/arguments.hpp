#pragma once
#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/case/dimension.hpp"
#include "vbond/core/error.hpp"

namespace vbond {

/// Quantities of a command line, with or without units. Collects mistakes, so that all are told at once.
class Arguments {
 public:
  double positive(const std::string& text, const char* option, keys::Dimension dimension) {
    const double value = number(text, option, dimension);
    if (value <= 0.0) problem(option, text, "must be > 0", "give a positive value");
    return value;
  }

  /// NaN after a mistake, so that it is told once.
  double number(const std::string& text, const char* option, keys::Dimension dimension) {
    const auto parsed = keys::parse_quantity(text);
    if (const auto* mistake = std::get_if<keys::UnitMistake>(&parsed)) {
      problem(option, text, mistake->rule, mistake->way_out);
      return NAN;
    }
    const auto& quantity = std::get<keys::Quantity>(parsed);
    if (!quantity.has_unit || keys::fits(quantity.dimension, dimension)) return quantity.value;
    problem(option, text, std::string("must be a ") + dimension.name,
            std::string("e.g. ") + dimension.example);
    return NAN;
  }

  void problem(const std::string& option, const std::string& text, const std::string& rule,
               const std::string& way_out) {
    problems_.push_back({{}, text.empty() ? option : option + " " + text, rule, way_out});
  }
  void throw_if_any() const {
    if (!problems_.empty()) throw CaseError(problems_);
  }

 private:
  std::vector<Problem> problems_;
};

}  // namespace vbond

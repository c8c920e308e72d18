#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "vbond/model/contact.hpp"

namespace vbond {

/// Who says a number of a pair of materials.
enum class SaidBy : std::uint8_t {
  pair,       ///< an exception of ContactModel::between
  materials,  ///< one of the two or both: the geometric mean
  model,      ///< ContactModel::surface
  nobody,     ///< it is what holds if nobody says it
};
struct PairNumber {
  double value;
  SaidBy said_by;
};

/// A number of the pair of two materials by the rule of touch_numbers(); otherwise: what holds if nobody says
/// it.
PairNumber number_of_pair(const ContactModel& contact, const std::vector<ContactMaterial>& materials,
                          std::uint32_t first, std::uint32_t second, std::optional<double> Surface::*number,
                          double otherwise);

}  // namespace vbond

#pragma once
#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"

namespace vbond::app {

/// Prints the law of contacts and, per pair of materials, its numbers and who says them.
void print_contact_law(const Model& model);
/// Which bonds touch as capsules.
void print_capsules(const Case& c, const Model& model);

/// Prints each wall, and what moves it in which stage.
void print_walls(const Case& c, const Model& model);

}  // namespace vbond::app

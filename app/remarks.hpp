#pragma once
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond::app {

/// What is right by all rules and yet is often a slip: a line for each, empty without any. They compare the
/// body with itself as it stands at the start: bonds with the usual one, meshes with the body, masses with
/// those of the bars that particles stand for, free ends and edges with those of bars and plates. And what a
/// restitution does not hold for.
std::vector<std::string> remarks(const Case& c, const Model& model, const State& state);

/// Into how many bodies bonds join the particles, where they are more than one; empty if not.
std::string bodies_in_words(const Model& model, const State& state);

}  // namespace vbond::app

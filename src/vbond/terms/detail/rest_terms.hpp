#pragma once
#include <initializer_list>
#include <vector>

#include "vbond/terms/heat/detail/rest_heat.hpp"
#include "vbond/terms/pressure/detail/rest_pressure.hpp"
#include "vbond/terms/walls/detail/rest_walls.hpp"

namespace vbond {

/// The list of the terms of a body at rest, in the order in which they are called.
class RestTerms {
 public:
  /// Keeps references; state: that of the body, whose model and stage are known.
  RestTerms(const StaticBody& body, State& state)
      : heat(body, state), pressure(body, state), walls(body, state) {
    for (RestTerm* t : std::initializer_list<RestTerm*>{&heat, &pressure, &walls})
      if (t->is_there()) all_.push_back(t), seen_.push_back(t);
  }
  RestTerms(const RestTerms&) = delete;
  RestTerms& operator=(const RestTerms&) = delete;

  const std::vector<RestTerm*>& all() { return all_; }
  const std::vector<const RestTerm*>& all() const { return seen_; }

  RestHeat heat;
  RestPressure pressure;
  RestWalls walls;

 private:
  std::vector<RestTerm*> all_;
  std::vector<const RestTerm*> seen_;
};

}  // namespace vbond

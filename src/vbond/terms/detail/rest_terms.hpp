#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vbond/statics/detail/rest_term.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {

/// The terms of a body at rest, which goes over those that its stage has, in the order of the list.
class RestTerms {
 public:
  /// Keeps references; state: that of the body, whose model and stage are known.
  RestTerms(const StaticBody& body, State& state);

  const std::vector<RestTerm*>& all() { return all_; }
  const std::vector<const RestTerm*>& all() const { return seen_; }
  /// Where they hold particles; to come: also where they may in the stage.
  std::vector<TermHold> holds(bool to_come) const;
  /// The first particle at which one of them has no energy, in words; nothing if all have.
  std::optional<std::string> without_energy() const;
  /// The one that is T::Of at rest, also if the stage does not have it.
  template <class T>
  T& of() {
    return static_cast<T&>(*list_[Terms::place_of<typename T::Of>()]);
  }
  template <class T>
  const T& of() const {
    return static_cast<const T&>(*list_[Terms::place_of<typename T::Of>()]);
  }

 private:
  std::array<std::unique_ptr<RestTerm>, Terms::size> list_;
  std::vector<RestTerm*> all_;
  std::vector<const RestTerm*> seen_;
};

}  // namespace vbond

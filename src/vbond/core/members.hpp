#pragma once
#include <cstddef>
#include <utility>

namespace vbond {

/// Stands for a member of any type, in places that are not evaluated.
struct AnyMember {
  template <class T>
  constexpr operator T() const;
};

/// How many members an aggregate has: as many as it can be initialised with. So a list of them that has
/// forgotten one does not compile.
template <class Aggregate, class... Members>
constexpr std::size_t member_count() {
  if constexpr (requires { Aggregate{std::declval<Members>()..., AnyMember{}}; })
    return member_count<Aggregate, Members..., AnyMember>();
  else
    return sizeof...(Members);
}

}  // namespace vbond

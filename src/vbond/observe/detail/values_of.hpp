#pragma once
#include <cstddef>
#include <vector>

namespace vbond {

/// A quantity of each of n things.
template <class View, class Value>
auto values_of(std::size_t n, const View& view, const Value value) {
  std::vector<decltype(value(view(0)))> values;
  values.reserve(n);
  for (std::size_t k = 0; k < n; ++k) values.push_back(value(view(k)));
  return values;
}

}  // namespace vbond

#pragma once

namespace vbond::testing {

/// Derivative of a smooth function f of one number at 0, by the central difference of eighth order with step
/// h. Error: h^8/630 of the ninth derivative, and rounding, some 2 eps |f|/h.
template <typename Function>
double derivative(const Function& f, double h) {
  const auto odd = [&](double x) { return f(x) - f(-x); };
  return (odd(h) * 4.0 / 5.0 - odd(2 * h) / 5.0 + odd(3 * h) * 4.0 / 105.0 - odd(4 * h) / 280.0) / h;
}

}  // namespace vbond::testing

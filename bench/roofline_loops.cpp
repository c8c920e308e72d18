// The two loops of roofline.cpp. This file is compiled once per instruction set, with registers of
// VBOND_WIDTH doubles, and must define nothing but the functions of its own namespace VBOND_SET.
#include <cstddef>

namespace vbond_bench::VBOND_SET {

using Register [[gnu::vector_size(8 * VBOND_WIDTH)]] = double;

/// a = a x + y in 14 independent chains, `rounds` times: 28 VBOND_WIDTH rounds operations. So many chains
/// hide the latency, and with x and y they fill the 16 registers that all sets have. The sum that is returned
/// keeps the compiler from leaving the work out.
double multiply_add(std::size_t rounds, double x, double y) {
  constexpr std::size_t chains = 14;
  const Register factor = Register{} + x, term = Register{} + y;
  Register a[chains];
  for (std::size_t k = 0; k < chains; ++k) a[k] = Register{} + static_cast<double>(k);
  for (std::size_t n = 0; n < rounds; ++n) {
#pragma GCC unroll 14
    for (std::size_t k = 0; k < chains; ++k) a[k] = a[k] * factor + term;
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < chains; ++k)
    for (std::size_t l = 0; l < VBOND_WIDTH; ++l) sum += a[k][l];
  return sum;
}

/// to[n] = b[n] + s c[n]: 24 bytes are read and written per element.
void triad(double* __restrict to, const double* __restrict b, const double* __restrict c, double s,
           std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) to[n] = b[n] + s * c[n];
}

}  // namespace vbond_bench::VBOND_SET

#pragma once
#include <cstddef>
#include <vector>

#include "vbond/case/size_spec.hpp"
#include "vbond/core/random.hpp"

namespace vbond {

/// A distribution as numbers are drawn from it: nothing below `least` > 0.  [length]
class SizeDraw {
 public:
  SizeDraw(const SizeSpec& spec, double least);

  /// The size that the part u of all, 0 <= u <= 1, is smaller than.
  double quantile(double u) const;
  /// To a millionth of itself.
  double mean() const;
  /// Whether anything is left when it is cut off.
  bool is_empty() const;
  /// One in each n-th part of the distribution, so that n sizes have its shape, in an order by chance.
  std::vector<double> draw(std::size_t n, Random& random) const;

 private:
  SizeSpec spec_;
  double least_;
};

}  // namespace vbond

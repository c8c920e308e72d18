#pragma once
#include <cstddef>
#include <utility>
#include <variant>
#include <vector>

/// How the sizes of grains are distributed: shares by number and by volume in closed form.
namespace vbond::packing {

struct EqualSizes {
  double radius = 0;  ///< > 0  [length]
};
struct UniformSizes {  ///< every radius between the two is as frequent
  double from = 0, to = 0;
};
struct NormalSizes {  ///< the bell curve of the radius, cut off at both ends
  double mean = 0, deviation = 0, from = 0, to = 0;
};
struct LognormalSizes {              ///< ln R is distributed normally; cut off at both ends
  double median = 0, deviation = 0;  ///< the median by number; the standard deviation of ln R
  double from = 0, to = 0;
};
/// Points of a curve: the share of grains that are smaller than this radius; it begins with 0 and ends with
/// 1. Between two points it is straight over the radius.
struct TableSizes {
  std::vector<std::pair<double, double>> points;  ///< radius, share; both grow
  bool by_mass = false;                           ///< the share of the mass, as of a sieve curve
};
using SizeLaw = std::variant<EqualSizes, UniformSizes, NormalSizes, LognormalSizes, TableSizes>;

/// Radii of one kind of grains.
class Sizes {
 public:
  /// Throws std::invalid_argument with what is wrong.
  explicit Sizes(SizeLaw law);

  double least() const { return least_; }
  double largest() const { return largest_; }
  /// Share of the number, and of the volume, of all grains that are smaller.
  double number_below(double radius) const;
  double volume_below(double radius) const;
  /// The radius that this share of the number, 0 to 1, is smaller than.
  double quantile(double share) const;
  /// Of a grain: 4/3 pi <R^3>.  [length^3]
  double mean_volume() const;

  /// Radii of n grains, growing. Each stands for the n-th part of the number and has the mean volume of it,
  /// so that sums of volumes lie on the curve, too. Nothing is drawn: the curve comes out as it went in, to
  /// 1/n by number and to the share of single grains by volume.
  std::vector<double> radii(std::size_t n) const;
  /// The largest distance of a curve of radii, growing, from this one (Kolmogorov, Smirnov): by mass for
  /// tables by mass, else by number.
  double distance(const std::vector<double>& radii) const;
  bool is_by_mass() const;

 private:
  double number(double radius) const;  // without factor, from a place of its own
  double cubes(double radius) const;   // the integral of R^3 over number(); likewise

  SizeLaw law_;
  double least_ = 0, largest_ = 0;
  double number_0_ = 0, number_1_ = 1, cubes_0_ = 0, cubes_1_ = 1;  // at both ends
};

}  // namespace vbond::packing

#include "vbond/setup/fibres/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vbond/physics/top.hpp"

namespace vbond {
namespace {

constexpr double no_part = 1e-9;  // of a tensor: a principal value that counts as zero

/// Carlson's integral 3/2 int_0^oo dt / (sqrt(t + x) sqrt(t + y) (t + z)^(3/2)), by duplication (Carlson,
/// Numer. Algorithms 10 (1995) 13), to rounding.
double carlson_R_D(double x, double y, double z) {
  double sum = 0.0, factor = 1.0;
  for (int k = 0; k < 100; ++k) {
    const double mean = 0.2 * (x + y + 3.0 * z);
    const double X = (mean - x) / mean, Y = (mean - y) / mean, Z = (mean - z) / mean;
    if (std::max({std::abs(X), std::abs(Y), std::abs(Z)}) < 2e-3) {
      const double XY = X * Y, Z2 = Z * Z;
      const double E_2 = XY - 6.0 * Z2, E_3 = (3.0 * XY - 8.0 * Z2) * Z, E_4 = 3.0 * (XY - Z2) * Z2,
                   E_5 = XY * Z2 * Z;
      const double series = 1.0 - 3.0 * E_2 / 14.0 + E_3 / 6.0 + 9.0 * E_2 * E_2 / 88.0 - 3.0 * E_4 / 22.0 -
                            9.0 * E_2 * E_3 / 52.0 + 3.0 * E_5 / 26.0;
      return 3.0 * sum + factor * series / (mean * std::sqrt(mean));
    }
    const double rx = std::sqrt(x), ry = std::sqrt(y), rz = std::sqrt(z);
    const double shift = rx * (ry + rz) + ry * rz;
    sum += factor / (rz * (z + shift));
    factor *= 0.25;
    x = 0.25 * (x + shift), y = 0.25 * (y + shift), z = 0.25 * (z + shift);
  }
  return NAN;
}

/// T^power of a symmetric tensor whose principal values are > 0.
InertiaTensor raised(const OrientationTensor& T, double power) {
  const PrincipalInertia p = principal_inertia({T[0], T[1], T[2], T[3], T[4], T[5]}).value();
  const Axes<double> e = axes(p.axes);
  InertiaTensor sum{0, 0, 0, 0, 0, 0};
  int k = 0;
  for (const Vec3d& n : {e.x, e.y, e.z}) {
    const double f = std::pow(component(p.moments, k++), power);
    sum.xx += f * n.x * n.x, sum.yy += f * n.y * n.y, sum.zz += f * n.z * n.z;
    sum.xy += f * n.x * n.y, sum.xz += f * n.x * n.z, sum.yz += f * n.y * n.z;
  }
  return sum;
}

Vec3d times(const InertiaTensor& T, const Vec3d& p) {
  return {T.xx * p.x + T.xy * p.y + T.xz * p.z, T.xy * p.x + T.yy * p.y + T.yz * p.z,
          T.xz * p.x + T.yz * p.y + T.zz * p.z};
}

/// Linear maps of directions, which turn one angular central Gaussian distribution into another, until the
/// tensor in principal axes is `a`.
void match(const Vec3d& a, std::vector<Vec3d>& p) {
  constexpr int most = 100;
  for (int k = 0; k < most; ++k) {
    OrientationTensor is = mean_dyad(p);
    const double off = std::max({std::abs(is[0] - a.x), std::abs(is[1] - a.y), std::abs(is[2] - a.z),
                                 std::abs(is[3]), std::abs(is[4]), std::abs(is[5])});
    if (off < 1e-14) return;
    Vec3d wanted = a;
    if (a.z == 0.0) is[2] = wanted.z = 1.0;  // of directions in a plane, which stay there
    const InertiaTensor before = raised(is, -0.5);
    const Vec3d root{std::sqrt(wanted.x), std::sqrt(wanted.y), std::sqrt(wanted.z)};
    for (Vec3d& e : p) e = normalised(each_times(root, times(before, e)));
  }
}

}  // namespace

Vec3d orientation_of_variances(const Vec3d& lambda) {
  std::array<double, 3> l{lambda.x, lambda.y, lambda.z}, a{};
  const auto zeros = std::count(l.begin(), l.end(), 0.0);
  if (zeros == 0) {
    const double largest = std::max({l[0], l[1], l[2]});
    std::array<double, 3> b{largest / l[0], largest / l[1], largest / l[2]};
    const double root = std::sqrt(b[0]) * std::sqrt(b[1]) * std::sqrt(b[2]);
    for (std::size_t k = 0; k < 3; ++k) a[k] = root * carlson_R_D(b[(k + 1) % 3], b[(k + 2) % 3], b[k]) / 3.0;
  } else {
    const double sum = std::sqrt(l[0]) + std::sqrt(l[1]) + std::sqrt(l[2]);
    for (std::size_t k = 0; k < 3; ++k) a[k] = std::sqrt(l[k]) / sum;
  }
  return {a[0], a[1], a[2]};
}

Vec3d variances_of_orientation(const Vec3d& a) {
  const auto kept = [](double x) { return x < no_part ? 0.0 : x; };
  const Vec3d wanted{kept(a.x), kept(a.y), kept(a.z)};
  const bool all = least_of(wanted) > 0.0;
  Vec3d lambda = all ? wanted : each_times(wanted, wanted);
  constexpr int most = 10000;
  for (int k = 0; all && k < most; ++k) {  // lambda_k grows with a_k: each is moved by what it is off
    const Vec3d is = orientation_of_variances(lambda), ratio = each_over(wanted, is);
    const auto off = [](double x) { return std::abs(x - 1.0); };
    if (std::max({off(ratio.x), off(ratio.y), off(ratio.z)}) < 1e-13) break;
    constexpr double power = 1.25;  // at isotropic ones a goes as lambda^0.4 to lambda^0.6 of each
    lambda = {lambda.x * std::pow(ratio.x, power), lambda.y * std::pow(ratio.y, power),
              lambda.z * std::pow(ratio.z, power)};
    lambda = lambda / (lambda.x + lambda.y + lambda.z);
  }
  return lambda / (lambda.x + lambda.y + lambda.z);
}

OrientationTensor mean_dyad(const std::vector<Vec3d>& directions) {
  OrientationTensor sum{};
  for (const Vec3d& p : directions) {
    const std::array<double, 6> of{p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.x * p.z, p.y * p.z};
    for (std::size_t k = 0; k < 6; ++k) sum[k] += of[k];
  }
  for (double& x : sum) x /= static_cast<double>(std::max<std::size_t>(1, directions.size()));
  return sum;
}

DirectionDraw::DirectionDraw(const FibresSpecimen& spec) {
  OrientationTensor wanted{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0, 0, 0};
  if (spec.orientation == FibreOrientation::planar) {
    const Vec3d n = normalised(spec.normal);
    wanted = {0.5 * (1 - n.x * n.x), 0.5 * (1 - n.y * n.y), 0.5 * (1 - n.z * n.z),
              -0.5 * n.x * n.y,      -0.5 * n.x * n.z,      -0.5 * n.y * n.z};
  }
  if (spec.orientation == FibreOrientation::tensor) wanted = spec.tensor;
  const PrincipalInertia p =
      principal_inertia({wanted[0], wanted[1], wanted[2], wanted[3], wanted[4], wanted[5]}).value();
  const Axes<double> e = axes(p.axes);
  struct Principal {
    double value;
    Vec3d axis;
  };
  std::array<Principal, 3> of{Principal{p.moments.x, e.x}, {p.moments.y, e.y}, {p.moments.z, e.z}};
  std::stable_sort(of.begin(), of.end(),
                   [](const Principal& s, const Principal& t) { return s.value > t.value; });
  axes_ = {of[0].axis, of[1].axis, of[2].axis};
  const auto kept = [](double x) { return x < no_part ? 0.0 : x; };
  a_ = {kept(of[0].value), kept(of[1].value), kept(of[2].value)};
  a_ = a_ / (a_.x + a_.y + a_.z);
  lambda_ = variances_of_orientation(a_);
}

int DirectionDraw::dimensions() const {
  return 1 + (a_.y > 0.0) + (a_.z > 0.0);
}

namespace {

/// In principal axes.
Vec3d direction(const Vec3d& lambda, Random& random) {
  for (;;) {
    const double x = random.gaussian(), y = random.gaussian(), z = random.gaussian();
    const Vec3d p{std::sqrt(lambda.x) * x, std::sqrt(lambda.y) * y, std::sqrt(lambda.z) * z};
    if (norm2(p) > 0.0) return normalised(p);
  }
}

}  // namespace

Vec3d DirectionDraw::draw(Random& random) const {
  const Vec3d p = direction(lambda_, random);
  return p.x * axes_.x + p.y * axes_.y + p.z * axes_.z;
}

std::vector<Vec3d> DirectionDraw::draw(std::size_t n, Random& random) const {
  constexpr std::size_t enough = 10;  // of fewer the tensor may have no inverse
  std::vector<Vec3d> directions;
  for (std::size_t k = 0; k < n; ++k) directions.push_back(direction(lambda_, random));
  if (n >= enough && dimensions() > 1) match(a_, directions);
  for (Vec3d& p : directions) p = p.x * axes_.x + p.y * axes_.y + p.z * axes_.z;
  return directions;
}

}  // namespace vbond

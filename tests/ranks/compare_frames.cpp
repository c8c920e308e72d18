// compare_frames DIR DIR: whether two runs of one case have the same frames, and how far they differ.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "vbond/observe/quantities.hpp"
#include "vbond/report/frame_read.hpp"

namespace {

using namespace vbond;
using Per = FrameInput::Per;
namespace fs = std::filesystem;

/// Numbers of one unit have one scale, which is the largest of all frames; of angles, 1 at least.
class Comparison {
 public:
  void add(const std::string& unit, const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) throw std::runtime_error("other sizes");
    Scaled& s = of_unit_[unit];
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (!std::isfinite(a[k]) || !std::isfinite(b[k])) throw std::runtime_error("not a finite number");
      s.scale = std::max({s.scale, std::abs(a[k]), std::abs(b[k])});
      s.difference = std::max(s.difference, std::abs(a[k] - b[k]));
    }
  }
  void add(const std::string& unit, const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    const auto numbers = [](const std::vector<Vec3d>& vectors) {
      std::vector<double> x;
      for (const Vec3d& v : vectors) x.insert(x.end(), {v.x, v.y, v.z});
      return x;
    };
    add(unit, numbers(a), numbers(b));
  }
  void must_be_equal(const std::string& name, bool equal) const {
    if (!equal) throw std::runtime_error("\"" + name + "\" differs");
  }
  double worst() const {
    double worst = 0.0;
    for (const auto& [unit, s] : of_unit_)
      if (s.difference > 0.0) worst = std::max(worst, s.difference / s.scale);
    return worst;
  }
  void set_least_scale(const std::string& unit, double scale) { of_unit_[unit].scale = scale; }

 private:
  struct Scaled {
    double scale = 0, difference = 0;
  };
  std::map<std::string, Scaled> of_unit_;
};

template <class Quantity>
void compare(const FrameInput& a, const FrameInput& b, Per per, std::span<const Quantity> table,
             Comparison& to) {
  for (const Quantity& q : table) {
    to.must_be_equal(q.name, a.has(per, q.name) == b.has(per, q.name));
    if (!a.has(per, q.name)) continue;
    const auto of_type = [&](auto example) {
      using T = decltype(example);
      if constexpr (std::is_same_v<T, double>)
        to.add(q.unit.in(UnitSystem::si), a.scalars(per, q.name), b.scalars(per, q.name));
      else if constexpr (std::is_same_v<T, Vec3d>)
        to.add(q.unit.in(UnitSystem::si), a.vectors(per, q.name), b.vectors(per, q.name));
      else if constexpr (std::is_same_v<T, std::uint8_t>)
        to.must_be_equal(q.name, a.bytes(per, q.name) == b.bytes(per, q.name));
      else if constexpr (std::is_same_v<T, Image>)
        to.must_be_equal(q.name, a.images(per, q.name) == b.images(per, q.name));
      else
        to.must_be_equal(q.name, a.integers(per, q.name) == b.integers(per, q.name));
    };
    std::visit([&]<class T, class View>(T (*)(const View&)) { of_type(T{}); }, q.value);
  }
}

/// Of bonds those of their ends: points of particles that are not there may be left out of parts.
std::vector<Vec3d> places(const FrameInput& frame) {
  const std::vector<Vec3d> points = frame.vectors(Per::point, "Points");
  if (!frame.lines()) return points;
  std::vector<Vec3d> ends;
  for (const std::int64_t k : frame.integers(Per::end, "connectivity"))
    ends.push_back(points.at(static_cast<std::size_t>(k)));
  return ends;
}

void compare_folders(const fs::path& one, const fs::path& other, Comparison& to) {
  for (const char* kind : {"particles.pvd", "bonds.pvd", "walls.pvd", "cell.pvd"}) {
    if (!fs::exists(one / kind) && !fs::exists(other / kind)) continue;
    const std::vector<ListedFrame> a = read_pvd(one / kind), b = read_pvd(other / kind);
    to.must_be_equal(kind, a.size() == b.size() && !a.empty());
    for (std::size_t k = 0; k < a.size(); ++k) {
      const FrameInput of_a(a[k].file), of_b(b[k].file);
      to.must_be_equal("step", of_a.step() == of_b.step() && a[k].time == b[k].time);
      if (!of_a.lines()) to.must_be_equal("points", of_a.points() == of_b.points());
      to.add("m", places(of_a), places(of_b));
      to.must_be_equal("connectivity",
                       of_a.integers(Per::end, "connectivity") == of_b.integers(Per::end, "connectivity"));
      to.must_be_equal("kind", of_a.lines() == of_b.lines() && of_a.triangles() == of_b.triangles());
      compare(of_a, of_b, Per::point, particle_quantities(), to);
      if (of_a.lines()) compare(of_a, of_b, Per::cell, bond_quantities(), to);
      if (of_a.triangles()) compare(of_a, of_b, Per::cell, wall_quantities(), to);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    Comparison all;
    all.set_least_scale(unit::angle.in(UnitSystem::si), 1.0);
    all.set_least_scale(unit::degrees.in(UnitSystem::si), 1.0);
    compare_folders(argv[1], argv[2], all);
    std::puts(fmt::format("{:.2g}", all.worst()).c_str());
    return all.worst() < 1e-7 ? 0 : 1;  // angles near 0 are known to half the digits
  } catch (const std::exception& e) {
    std::puts(e.what());
    return 1;
  }
}

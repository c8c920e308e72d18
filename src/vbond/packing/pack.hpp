#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "vbond/packing/measure.hpp"
#include "vbond/packing/sizes.hpp"
#include "vbond/packing/vessel.hpp"

/// Packings of spheres: from sizes and a vessel to places. Knows nothing of case files and of bonds.
namespace vbond::packing {

/// Grains of one kind.
struct Kind {
  std::string name;
  Sizes sizes;
  double share = 1;    ///< of all grains, as ShareBy says; only their ratios count
  double density = 1;  ///< for shares by mass  [mass/length^3]
};
enum class ShareBy : std::uint8_t { number, volume, mass };

struct ToPorosity {
  double porosity = 0;  ///< 1 - volume of grains / volume of the vessel; grains are as many as that takes
};
struct ToNumber {
  std::size_t grains = 0;
};
/// Until grains lock: all grow together until they press on each other, and are let loose until they just
/// touch. Without a number they are as many as leaves their sizes as asked, to about a third of a percent.
struct UntilJammed {
  std::optional<std::size_t> grains{};
  /// The largest that may be left, over the smaller radius. None: they just touch, so that contacts can be
  /// counted, which takes many times as long.
  std::optional<double> overlap{};
};
enum class Floaters : std::uint8_t { keep, remove, grow };

struct Request {
  Vessel vessel;
  std::vector<Kind> kinds;
  ShareBy share_by = ShareBy::volume;
  std::variant<ToPorosity, ToNumber, UntilJammed> until;
  double overlap = 1e-3;  ///< the largest that may be left, over the smaller radius; but see UntilJammed
  /// What becomes of grains with fewer neighbours than `neighbours` within `gap`, a factor of the sum of
  /// radii.
  Floaters floaters = Floaters::keep;
  int neighbours = 3;
  double gap = 1.05;
  std::uint64_t seed = 1;
  int threads = 1;
};

struct Packing {
  std::vector<Vec3d> r;        ///< in the cell, if there is one  [length]
  std::vector<double> radius;  ///< [length]
  std::vector<std::size_t> kind;
  double size_factor = 1;  ///< all radii are those asked for, times this
  double sizes_off = 0;    ///< the largest distance of a kind's curve from that asked for, without the factor
  std::size_t removed = 0, grown = 0;  ///< floaters
  double largest_growth = 1;           ///< of their radii
  double pressure = 0;                 ///< left, times the mean diameter over the stiffness of contacts
  std::int64_t iterations = 0;         ///< of all searches for balance
  Measured is;
};

/// Such a packing cannot be made; what() says why, and way_out what can.
struct Refused : std::runtime_error {
  Refused(const std::string& what, std::string the_rule, std::string the_way_out)
      : std::runtime_error(what), rule(std::move(the_rule)), way_out(std::move(the_way_out)) {}
  std::string rule, way_out;
};

/// The density at which spheres of these radii lock in a large body: .634 + .0658 d + .0857 S d^2, d:
/// standard deviation over mean, S: skewness (Desmond and Weeks, Phys. Rev. E 90, 022204, 2014).
double expected_density(const std::vector<double>& radii);

/// Puts spheres in at random, smaller than they are, largest first (random sequential addition), lets them
/// grow to their sizes at once, and looks for the balance of their overlaps. Then what the request needs: see
/// docs/packings.md. Throws Refused.
Packing pack(const Request& request);

}  // namespace vbond::packing

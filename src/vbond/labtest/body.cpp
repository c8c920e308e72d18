#include "vbond/labtest/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "vbond/core/cell.hpp"
#include "vbond/core/disjoint_sets.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/bond.hpp"

namespace vbond::labtest {
namespace {

[[noreturn]] void refuse_case(SourcePlace place, const std::string& what, const std::string& rule,
                              const std::string& way_out) {
  throw CaseError(Problem{std::move(place), what, rule, way_out});
}

void refuse_what_no_test_takes(const Case& c, const Built& built) {
  const SourcePlace file{c.file, 0, 0};
  if (built.model.cell.any())
    refuse_case(file, "the body has a periodic cell", "a test needs a body with a surface",
                "leave [cell] out; of the material of a cell vbond homogenise tells the constants");
  if (!c.sources.empty() || !c.sinks.empty())
    refuse_case(file, "bodies come in, or particles are taken out",
                "the specimen of a test is there from the start", "leave [[source]] and [[sink]] out");
  for (const BondSpec& b : c.bonds)
    if (b.when == BondTime::stage || !b.stages.empty())
      refuse_case(b.place, "bonds \"" + b.name + "\" are made in a stage of the case",
                  "a test has stages of its own", "make them at the start: when = \"start\"");
  for (const GroupSpec& g : c.groups)
    if (g.name.starts_with("test_"))
      refuse_case(g.place, "group " + g.name, "names that begin with test_ are those of the test",
                  "give the group another name");
}

/// All particles hang together: what does not would float, and at rest there is no balance then.
void refuse_parts(const Case& c, const Built& built) {
  const SourcePlace file{c.file, 0, 0};
  DisjointSets<ParticleId> parts(built.model.particles());
  bool any = false;
  for (const Bond& b : built.state.bonds)
    if (!b.broken) parts.join(b.i, b.j), any = true;
  if (!any)
    refuse_case(file, "the body has no bonds at the start", "a test breaks or strains bonds",
                "give [[bonds]]");
  PerParticle<std::size_t> size(built.model.particles(), 0);
  for (const ParticleId p : built.model.mass.ids()) ++size[parts.smallest(p)];
  ParticleId largest{0};
  for (const ParticleId p : built.model.mass.ids())
    if (size[p] > size[largest]) largest = p;
  std::size_t floating = 0;
  ParticleId first{0};
  for (const ParticleId p : built.model.mass.ids())
    if (parts.smallest(p) != largest && floating++ == 0) first = p;
  if (floating > 0)
    refuse_case(
        file,
        fmt::format("{} of {} particles are bonded to no chain of bonds of the others, particle {} "
                    "first",
                    floating, built.model.particles(), first.value),
        "the body floats in parts: nothing would hold them in a test",
        "bond pairs that are farther apart, let the packing remove floaters, or leave them out by cut");
}

bool has_strength(const State& state) {
  return std::any_of(state.bonds.begin(), state.bonds.end(),
                     [](const Bond& b) { return !b.broken && can_break(b); });
}

}  // namespace

const char* to_text(Kind kind) {
  switch (kind) {
    case Kind::tension: return "tension";
    case Kind::compression: return "compression";
    case Kind::shear: return "shear";
    case Kind::bend3: return "bend3";
    case Kind::brazilian: return "brazilian";
    case Kind::triaxial: return "triaxial";
  }
  return "";
}

void refuse(const Body& body, const std::string& what, const std::string& rule, const std::string& way_out) {
  refuse_case({body.file, 0, 0}, what, rule, way_out);
}

Body body_of(const Case& c, const Built& built, const Request& request) {
  refuse_what_no_test_takes(c, built);
  refuse_parts(c, built);
  Body body{.model = built.model, .state = built.state, .file = c.file, .box = {}};
  body.axis = request.axis;
  body.across = request.across.value_or(body.axis == 2 ? 0 : 2);
  body.third = 3 - body.axis - body.across;
  for (const ParticleId p : body.model.mass.ids()) body.box.add(body.state.r[p], body.model.radius[p]);
  double sum = 0;
  for (const Bond& b : body.state.bonds) sum += norm(between(body.state.r, b.i, b.j));
  body.spacing = sum / static_cast<double>(body.state.bonds.size());
  body.wave_speed = body.spacing * 2.0 * std::numbers::pi / body.model.T_0;
  body.can_break = has_strength(body.state);
  return body;
}

// ---- the section ----------------------------------------------------------------------------------------

namespace {

/// Place of a particle in the section, from its middle.
std::array<double, 2> place_in_section(const Body& body, ParticleId p) {
  return {component(body.state.r[p], body.across) - body.middle(body.across),
          component(body.state.r[p], body.third) - body.middle(body.third)};
}

/// Of a body about an axis: twice the distance of its surface from the axis, by the farthest particle of each
/// of 36 sectors. A packing touches its vessel in each, and the steps of a lattice are averaged.
struct Roundness {
  double diameter = 0;  ///< mean over the sectors
  double largest = 0;
};
Roundness roundness_of(const Body& body, const std::vector<ParticleId>& particles) {
  constexpr std::size_t sectors = 36;
  std::array<double, sectors> most{};
  for (const ParticleId p : particles) {
    const auto [u, v] = place_in_section(body, p);
    const double turn = 0.5 + std::atan2(v, u) / (2.0 * std::numbers::pi);
    double& m = most[std::min(sectors - 1, static_cast<std::size_t>(turn * sectors))];
    m = std::max(m, 2.0 * (std::hypot(u, v) + body.model.radius[p]));
  }
  Roundness round{0, *std::max_element(most.begin(), most.end())};
  for (const double m : most) round.diameter += m / sectors;
  return round;
}

/// Whether one of these particles is near each of the four corners of the section.
bool fill_corners(const Body& body, const std::vector<ParticleId>& particles) {
  constexpr double near = 0.7;  // of the spacing: a disc of five particles across has .8
  for (const int s : {-1, 1})
    for (const int t : {-1, 1}) {
      double least = std::numeric_limits<double>::infinity();
      for (const ParticleId p : particles) {
        const double R = body.model.radius[p];
        const auto [u, v] = place_in_section(body, p);
        least = std::min(least, std::hypot(u - s * (0.5 * body.extent(body.across) - R),
                                           v - t * (0.5 * body.extent(body.third) - R)));
      }
      if (least > near * body.spacing) return false;
    }
  return true;
}

/// The thirds of the body along its axis.
std::array<std::vector<ParticleId>, 3> thirds_of(const Body& body) {
  std::array<std::vector<ParticleId>, 3> thirds;
  for (const ParticleId p : body.model.mass.ids()) {
    const double part =
        (component(body.state.r[p], body.axis) - body.low(body.axis)) / body.extent(body.axis);
    thirds[std::min<std::size_t>(2, static_cast<std::size_t>(3.0 * part))].push_back(p);
  }
  return thirds;
}

}  // namespace

std::string Section::text() const {
  switch (shape) {
    case SectionShape::box: return fmt::format("box {:.6g} x {:.6g}", extent[0], extent[1]);
    case SectionShape::circle: return fmt::format("circle of diameter {:.6g}", extent[0]);
    case SectionShape::given: return "as given";
  }
  return "";
}

Section section_of(const Body& body, const Request& request) {
  const double u = body.extent(body.across), v = body.extent(body.third);
  if (request.area) return {SectionShape::given, *request.area, {u, v}};
  if (std::any_of(body.model.radius.begin(), body.model.radius.end(), [](double R) { return R == 0.0; }))
    refuse(body, "particles have no radius", "the section is measured with the radii of particles",
           "give radius to the specimens, or the area with --area");
  std::vector<ParticleId> all;
  for (const ParticleId p : body.model.mass.ids()) all.push_back(p);
  const auto thirds = thirds_of(body);
  const auto changes = [&](const std::string& shape) {
    refuse(body,
           fmt::format("the section normal to {} is a {}, but not all along the body",
                       name_of_axis(body.axis), shape),
           "a specimen has one section between its ends",
           "choose the axis of the specimen with --axis, or give the area of its middle with --area");
  };
  if (const Section box{SectionShape::box, u * v, {u, v}}; fill_corners(body, all)) {
    for (const auto& third : thirds)
      if (!third.empty() && !fill_corners(body, third)) changes(box.text());
    return box;
  }
  constexpr double rounding = 1e-9;
  const Roundness round = roundness_of(body, all);
  if (round.largest <= std::max(u, v) + body.spacing && std::abs(u - v) <= 0.5 * body.spacing + rounding) {
    const Section circle{SectionShape::circle,
                         0.25 * std::numbers::pi * round.diameter * round.diameter,
                         {round.diameter, round.diameter}};
    for (const auto& third : thirds)
      if (!third.empty() && roundness_of(body, third).largest < round.diameter - body.spacing)
        changes(circle.text());
    return circle;
  }
  refuse(body,
         fmt::format("the section normal to {} is neither a box nor a circle: {:.6g} x {:.6g}, with corners "
                     "that are empty",
                     name_of_axis(body.axis), u, v),
         "stresses are forces over the area of the section",
         "choose the axis of the specimen with --axis, or give the area with --area");
}

// ---- groups -----------------------------------------------------------------------------------------------

Side side_of(const Body& body, const std::string& group, int direction, bool upper, const Request& request) {
  const double face = upper ? body.high(direction) : body.low(direction), sign = upper ? -1.0 : 1.0;
  // distance of a centre from the face, inwards
  const auto depth_of = [&](ParticleId p) { return sign * (component(body.state.r[p], direction) - face); };
  double depth = 0;
  if (request.depth) {
    depth = *request.depth;
  } else {
    const double near = 0.25 * body.spacing;
    for (const ParticleId p : body.model.mass.ids())
      if (depth_of(p) - body.model.radius[p] <= near) depth = std::max(depth, body.model.radius[p]);
    depth += near;
  }
  Side side{group, direction, upper, face + sign * depth, {}, 0};
  for (const ParticleId p : body.model.mass.ids())
    if (sign * (component(body.state.r[p], direction) - side.plane) <= 0.0) {
      side.particles.push_back(p);
      side.mean += component(body.state.r[p], direction);
    }
  if (side.particles.empty())
    refuse(body, fmt::format("no particle is within {:.6g} of the face", depth),
           "the ends of a specimen are particles", "give a larger --depth");
  side.mean /= static_cast<double>(side.particles.size());
  return side;
}

// ---- what bars rigid motions ------------------------------------------------------------------------------

namespace {

using Twist = std::array<double, 6>;

double dot6(const Twist& a, const Twist& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 6; ++k) sum += a[k] * b[k];
  return sum;
}

/// Rigid motions that a set of point holds bars, as an orthonormal basis of their rows.
class Barred {
 public:
  explicit Barred(const Body& body) : body_(body), size_(0.5 * body.box.diagonal()) {}

  /// What the hold adds to the basis.
  Twist remainder(const PointHold& h) const {
    Twist row{};
    Vec3d along{};
    component(along, h.direction) = 1.0;
    const Vec3d arm = (body_.state.r[h.particle] - 0.5 * (body_.box.low + body_.box.high)) / size_;
    const Vec3d moment = cross(arm, along);
    for (int k = 0; k < 3; ++k) {
      row[static_cast<std::size_t>(k)] = component(along, k);
      row[static_cast<std::size_t>(k + 3)] = component(moment, k);
    }
    for (const Twist& b : basis_) {
      const double part = dot6(row, b);
      for (std::size_t k = 0; k < 6; ++k) row[k] -= part * b[k];
    }
    return row;
  }
  /// False if it is barred already.
  bool add(const PointHold& h) {
    Twist row = remainder(h);
    const double size = std::sqrt(dot6(row, row));
    if (size < least) return false;
    for (double& x : row) x /= size;
    basis_.push_back(row);
    return true;
  }
  std::size_t rank() const { return basis_.size(); }

  static constexpr double least = 1e-3;  ///< of a hold at the end of the body

 private:
  const Body& body_;
  double size_;
  std::vector<Twist> basis_;
};

}  // namespace

std::optional<std::vector<PointHold>> bar_rigid_motions(const Body& body, const std::vector<PointHold>& held,
                                                        const std::vector<ParticleId>& candidates) {
  Barred barred(body);
  for (const PointHold& h : held)
    if (barred.rank() < 6) barred.add(h);
  std::vector<PointHold> chosen;
  while (barred.rank() < 6) {
    PointHold best;
    double most = 0;
    for (const ParticleId p : candidates)
      for (int d = 0; d < 3; ++d) {
        const Twist row = barred.remainder({p, d});
        if (dot6(row, row) > most * (1.0 + 1e-9)) most = dot6(row, row), best = {p, d};
      }
    if (!(most > 0.0) || !barred.add(best)) return std::nullopt;
    chosen.push_back(best);
  }
  return chosen;
}

}  // namespace vbond::labtest

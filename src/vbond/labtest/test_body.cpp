#include "vbond/labtest/test_body.hpp"

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
  const auto refuse_name = [](const SourcePlace& place, const char* what, const std::string& name) {
    if (name.starts_with("test_"))
      refuse_case(place, std::string(what) + " " + name, "names that begin with test_ are those of the test",
                  std::string("give the ") + what + " another name");
  };
  for (const GroupSpec& g : c.groups) refuse_name(g.place, "group", g.name);
  for (const SpecimenSpec& s : c.specimens) refuse_name(s.place, "specimen", s.name);
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

/// By how much more than by their radii particles reach, if their bonds are no sums of radii: half of the
/// least gap of a bond, if all have one, or less by half of the least overlap  [length].
double beyond_radius(const Body& body) {
  constexpr double shares = 0.05;  // of the spacing
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  for (const Bond& b : body.state.bonds) {
    if (b.broken) continue;
    const double gap =
        norm(between(body.state.r, b.i, b.j)) - body.model.radius[b.i] - body.model.radius[b.j];
    least = std::min(least, gap), largest = std::max(largest, gap);
  }
  if (least > shares * body.spacing) return 0.5 * least;
  if (largest < -shares * body.spacing) return 0.5 * largest;
  return 0.0;
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
  Body body{.c = c, .model = built.model, .state = built.state, .file = c.file, .box = {}};
  body.axis = request.axis;
  body.across = request.across.value_or(body.axis == 2 ? 0 : 2);
  body.third = 3 - body.axis - body.across;
  double sum = 0;
  for (const Bond& b : body.state.bonds) sum += norm(between(body.state.r, b.i, b.j));
  body.spacing = sum / static_cast<double>(body.state.bonds.size());
  body.beyond = beyond_radius(body);
  for (const ParticleId p : body.model.mass.ids()) body.box.add(body.state.r[p], body.reach(p));
  body.wave_speed = body.spacing * 2.0 * std::numbers::pi / body.model.T_0;
  body.can_break = has_strength(body.state);
  const auto any_bond = [&body](auto&& is) {
    return std::any_of(body.state.bonds.begin(), body.state.bonds.end(), is);
  };
  body.gives_way = any_bond([](const Bond& b) {
    return b.rules->softening.any() || b.rules->stretch.form != StretchForm::harmonic;
  });
  body.creeps = any_bond([](const Bond& b) { return creeps(b); });
  return body;
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
      if (depth_of(p) - body.reach(p) <= near) depth = std::max(depth, body.reach(p));
    depth += near;
  }
  Side side{group, direction, upper, face + sign * depth, {}, 0, 0};
  for (const ParticleId p : body.model.mass.ids())
    if (sign * (component(body.state.r[p], direction) - side.plane) <= 0.0) {
      side.particles.push_back(p);
      side.mean += component(body.state.r[p], direction);
    }
  if (side.particles.empty())
    refuse(body, fmt::format("no particle is within {:.6g} of the face", depth),
           "the ends of a specimen are particles", "give a larger --depth");
  side.mean /= static_cast<double>(side.particles.size());
  double deepest = 0;
  for (const ParticleId p : side.particles) deepest = std::max(deepest, depth_of(p));
  double layer = 0;
  for (const ParticleId p : side.particles)
    if (depth_of(p) >= deepest - 0.5 * body.spacing)
      side.inner += component(body.state.r[p], direction), layer += 1;
  side.inner /= layer;
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

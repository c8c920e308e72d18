#include "vbond/labtest/made_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/cell.hpp"
#include "vbond/labtest/test_text.hpp"
#include "vbond/packing/skin.hpp"

namespace vbond::labtest {
namespace {

/// In motion, platens move at this part of the strain times the speed of waves in the body.
constexpr double slowness = 0.004;

/// Strain at the end, and in motion its rate and how long it takes.
void set_progress(const Body& body, MadeTest& test) {
  const Request& r = test.request;
  test.breaks = body.can_break, test.gives_way = body.gives_way;
  test.middle = 0.5 * (body.box.low + body.box.high);
  test.across = body.across, test.third = body.third;
  test.end_strain = r.strain.value_or(body.can_break ? default_strain : elastic_strain);
  if (r.at_rest) return;
  if (body.creeps)
    test.notes.push_back(
        "bonds creep: E and strength are those of this rate of strain, and others of another --rate");
  if (!r.strain && !body.can_break) test.end_strain = 1e-4;
  const double speed = slowness * test.end_strain * body.wave_speed;
  test.rate = r.rate.value_or(speed * test.strain_per_way);
  if (r.pressure > 0.0) {
    test.confining = 20.0 * body.box.diagonal() / body.wave_speed;
    test.settling = 0.5 * test.confining;
  }
  test.duration = test.end_strain / test.rate / 0.99;  // a ramp over 2 % of it loses half of that
  if (const double least = 10.0 * body.model.T_0; test.duration < least)
    refuse(body,
           fmt::format("a strain of {:.4g} at a rate of {:.4g} takes {:.4g}", test.end_strain, test.rate,
                       test.duration),
           "that is no longer than waves in single bonds take, 10 T0: no test, a blow",
           fmt::format("give a --rate of {:.3g} or less", test.end_strain / least));
}

void require_spread(const Body& body, const Side& side) {
  // not on a line: the second moments of the places within the plane have two directions
  double uu = 0, vv = 0, uv = 0, mu = 0, mv = 0;
  const int u = (side.direction + 1) % 3, v = (side.direction + 2) % 3;
  const auto n = static_cast<double>(side.particles.size());
  for (const ParticleId p : side.particles)
    mu += component(body.state.r[p], u) / n, mv += component(body.state.r[p], v) / n;
  for (const ParticleId p : side.particles) {
    const double a = component(body.state.r[p], u) - mu, b = component(body.state.r[p], v) - mv;
    uu += a * a / n, vv += b * b / n, uv += a * b / n;
  }
  const double least = 0.5 * (uu + vv - std::hypot(uu - vv, 2.0 * uv));
  if (side.particles.size() < 3 || least < 0.01 * body.spacing * body.spacing)
    refuse(body,
           fmt::format("the {} end along {} has {} particle{}, in a row", side.upper ? "upper" : "lower",
                       name_of_axis(side.direction), side.particles.size(),
                       side.particles.size() == 1 ? "" : "s"),
           "an end is a face: three particles at least, not in one row",
           "take deeper ends with --depth, another --axis, or a wider body");
}

/// No particle of an end is in the gauge, and ends cover the section: else a note.
void look_at_end(const Body& body, const Side& side, double half, MadeTest& test) {
  const char* which = side.upper ? "upper" : "lower";
  BoundingBox box;
  for (const ParticleId p : side.particles) {
    box.add(body.state.r[p], body.reach(p));
    if (std::abs(component(body.state.r[p], body.axis) - body.middle(body.axis)) <= half)
      refuse(body, fmt::format("the {} end reaches into the middle half of the specimen", which),
             "strains are measured there, and what is held does not strain",
             "take a longer body, another --axis, or a smaller --depth");
  }
  const Vec3d size = box.high - box.low;
  const double u = component(size, body.across) / body.extent(body.across),
               v = component(size, body.third) / body.extent(body.third);
  if (std::min(u, v) < 0.8)
    test.notes.push_back(fmt::format(
        "the {} end covers {:.3g} x {:.3g} of the width of the body: strengths are those of that end, "
        "and E_by_ends is too small; cut the body flat, or take deeper ends with --depth",
        which, u, v));
}

std::vector<PointHold> held_along(const std::vector<ParticleId>& particles, int direction) {
  std::vector<PointHold> held;
  for (const ParticleId p : particles) held.push_back({p, direction});
  return held;
}

/// Bars rigid motions by single particles: of the first side if it can, else of both.
void hold_the_body(const Body& body, TestText& text, std::vector<PointHold> held,
                   const std::vector<ParticleId>& one, const std::vector<ParticleId>& other,
                   Confining confining = Confining::as_ever) {
  auto holds = bar_rigid_motions(body, held, one);
  if (!holds) {
    std::vector<ParticleId> both = one;
    both.insert(both.end(), other.begin(), other.end());
    holds = bar_rigid_motions(body, held, both);
  }
  if (!holds)
    refuse(body, "the particles that the test holds lie in a row",
           "they must keep the body from turning about each axis",
           "take a body with more particles across, or deeper ends with --depth");
  text.point_holds(*holds, confining);
}

/// The middle half of the specimen, whose strain is measured. Throws if its particles do not span space.
double gauge_half(const Body& body) {
  const double half = 0.25 * body.extent(body.axis) + 1e-3 * body.spacing;
  Vec3d mean{}, square{};
  std::size_t n = 0;
  for (const ParticleId p : body.model.mass.ids()) {
    const Vec3d& r = body.state.r[p];
    if (std::abs(component(r, body.axis) - body.middle(body.axis)) > half) continue;
    mean += r, square += Vec3d{r.x * r.x, r.y * r.y, r.z * r.z};
    ++n;
  }
  for (int k = 0; k < 3; ++k) {
    const double m = n > 0 ? component(mean, k) / static_cast<double>(n) : 0.0;
    const double variance = n > 0 ? component(square, k) / static_cast<double>(n) - m * m : 0.0;
    if (n < 4 || variance < 0.01 * body.spacing * body.spacing)
      refuse(body,
             fmt::format("the {} particles in the middle half of the specimen are in one plane, normal to {}",
                         n, name_of_axis(k)),
             "strains are measured there, in all directions",
             "take a body with at least two layers in each direction, and four along --axis");
  }
  return half;
}

/// Lateral: over the sides of a height of the skin, the forces are those of the pressure on the whole width
/// of the section. Throws CaseError if no skin is found.
Confinement confinement_of(const Body& body, const Section& section, double pressure) {
  Confinement found;
  found.longest = 1.2 * body.spacing;
  const std::vector<Vec3d>& r = body.state.r.values();
  const auto skin = packing::skin_of(r, found.longest);
  Vec3d shadow{};  // areas of the skin as seen along x, y, z
  if (skin)
    for (const auto& [i, j, k] : skin->triangles) {
      const Vec3d area = 0.5 * cross(between(r[i], r[j]), between(r[i], r[k]));
      shadow += 0.5 * Vec3d{std::abs(area.x), std::abs(area.y), std::abs(area.z)};
    }
  const double sides = component(shadow, body.across) + component(shadow, body.third);
  if (!(sides > 0.0))
    refuse(body, "no skin is found around the body", "a triaxial test presses on its skin",
           "see the page on pressure: particles may be too far apart, or in one plane");
  const BoundingBox centres = box_around(r);
  const double height = component(centres.high, body.axis) - component(centres.low, body.axis);
  found.applied = pressure * height * (section.extent[0] + section.extent[1]) / sides;
  found.axial = found.applied * component(shadow, body.axis) / section.area;
  return found;
}

const char* component_name(int j, int k) {
  constexpr const char* names[3][3] = {{"xx", "xy", "zx"}, {"xy", "yy", "yz"}, {"zx", "yz", "zz"}};
  return names[j][k];
}

MadeTest test_between_ends(const Body& body, const Request& request) {
  MadeTest test;
  test.request = request;
  const bool shear = request.kind == Kind::shear, grip = shear || request.ends == Ends::grip;
  test.section = section_of(body, request);
  const Side lower = side_of(body, test.lower, body.axis, false, request),
             upper = side_of(body, test.upper, body.axis, true, request);
  require_spread(body, lower), require_spread(body, upper);
  test.length = request.depth ? upper.inner - lower.inner : upper.mean - lower.mean;
  if (!(upper.plane - lower.plane > 0.0) || !(test.length > 0.0))
    refuse(body, "the ends meet", "between the ends there is a specimen",
           "take a longer body, another --axis, or a smaller --depth");
  const double half = gauge_half(body);
  look_at_end(body, lower, half, test), look_at_end(body, upper, half, test);
  test.direction = shear ? body.across : body.axis;
  test.sign = request.kind == Kind::tension || shear ? 1.0 : -1.0;
  test.stress_per_force = 1.0 / test.section->area;
  test.strain_per_way = 1.0 / test.length;
  test.height = test.section->extent[0];
  test.gauge = Gauge{"test_gauge", {}};
  if (shear)
    test.gauge->columns = {component_name(body.axis, body.across)};
  else
    for (const int k : {body.axis, body.across, body.third})
      test.gauge->columns.push_back(component_name(k, k));
  if (request.pressure > 0.0) test.confinement = confinement_of(body, *test.section, request.pressure);
  set_progress(body, test);

  TestText text(body);
  text.comment(grip ? "the ends, which move as rigid bodies" : "the ends, which are free to slide sideways");
  text.side(lower), text.side(upper);
  text.comment("the middle half, where strains are measured");
  text.middle(test.gauge->group, body.axis, half);
  const std::vector<int> fix = grip ? std::vector<int>{} : std::vector<int>{body.axis};
  text.hold({test.lower, fix, {}});
  text.hold({test.upper, fix, along(test.direction, test.sign * test.length),
             test.confinement ? Confining::guided : Confining::as_ever});
  if (!grip) {
    std::vector<PointHold> held = held_along(lower.particles, body.axis);
    const std::vector<PointHold> more = held_along(upper.particles, body.axis);
    held.insert(held.end(), more.begin(), more.end());
    hold_the_body(body, text, std::move(held), lower.particles, upper.particles, Confining::left_out);
  }
  test.text = text.text(test, {test.lower, test.upper}, 2.0 * half * test.section->area);
  if (shear)
    test.notes.push_back(
        fmt::format("the sides are free and bear no shear stress: G is too small, by up to 1/6 of it and "
                    "more in a body of "
                    "few particles across; height over width is {:.3g}, a flat body is better",
                    test.length / test.section->extent[0]));
  return test;
}

// ---- bending ----

/// Of the particles of a side, those in the row across the beam that is nearest to a place along it.
struct RowOfSide {
  Vec3d low, high;  ///< the box that holds it
  double place = 0;
  std::vector<ParticleId> particles;
};
RowOfSide row_at(const Body& body, const Side& side, double place) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const ParticleId p : side.particles)
    if (const double x = component(body.state.r[p], body.axis);
        std::abs(x - place) < std::abs(nearest - place))
      nearest = x;
  const double half = 0.3 * body.spacing;
  RowOfSide row;
  for (const ParticleId p : side.particles)
    if (const double x = component(body.state.r[p], body.axis); std::abs(x - nearest) <= half)
      row.particles.push_back(p), row.place += x;
  row.place /= static_cast<double>(row.particles.size());
  row.low = body.box.low - Vec3d{body.spacing, body.spacing, body.spacing};
  row.high = body.box.high + Vec3d{body.spacing, body.spacing, body.spacing};
  component(row.low, body.axis) = nearest - half, component(row.high, body.axis) = nearest + half;
  component(side.upper ? row.low : row.high, body.across) = side.plane;
  return row;
}

/// What is to be known of a notched beam.
void tell_notch(const Notch& notch, const Body& body, MadeTest& test) {
  test.notes.push_back(fmt::format(
      "the notch is {:.6g} deep, half of the way from the last bond that is left out to the next "
      "one; {} bonds are left out, {} stay across its plane; the ligament above it is {:.3g} mean "
      "bonds high, and K_Ic is that of the material only where it no longer grows with the beam",
      notch.depth, notch.left_out, notch.stay, (notch.height - notch.depth) / body.spacing));
  if (body.model.contact.law != ContactLaw::none && body.model.contact.pairs == ContactPairs::unbonded)
    test.notes.push_back(
        "particles on both faces of the notch touch as unbonded ones do: where they overlap they push "
        "from the start");
}

MadeTest bending(const Body& body, const Request& request) {
  MadeTest test;
  test.request = request;
  const Section section = section_of(body, request);
  if (section.shape == SectionShape::given)
    refuse(body, "--area of a beam", "bending needs the second moment of the section, which is measured",
           "leave --area out");
  const double h = section.extent[0], c = 0.5 * h;
  if (request.depth && *request.depth > 0.25 * h)
    refuse(body, fmt::format("--depth {:.6g} of a beam {:.6g} high", *request.depth, h),
           "supports and load act at the surface: no deeper than a quarter of the height",
           "give a smaller --depth, or leave it out");
  const double I = section.shape == SectionShape::circle ? std::numbers::pi * h * h * h * h / 64.0
                                                         : section.extent[1] * h * h * h / 12.0;
  const Side under = side_of(body, "", body.across, false, request),
             top = side_of(body, "", body.across, true, request);
  const double length = body.extent(body.axis), middle = body.middle(body.axis);
  const double wanted = request.span.value_or(request.notch ? notched_span * h : length - 3.0 * body.spacing);
  const RowOfSide left = row_at(body, under, middle - 0.5 * wanted),
                  right = row_at(body, under, middle + 0.5 * wanted);
  const RowOfSide load = row_at(body, top, 0.5 * (left.place + right.place));
  const RowOfSide below = row_at(body, under, load.place);
  const double span = right.place - left.place, a = load.place - left.place, b = right.place - load.place;
  if ((request.span || request.notch) && wanted > length)
    refuse(body,
           request.span
               ? fmt::format("--span {:.6g}", wanted)
               : fmt::format("the span of a notched beam is {:g} heights, {:.6g}", notched_span, wanted),
           fmt::format("the beam is {:.6g} long along {}", length, name_of_axis(body.axis)),
           request.span ? "give a shorter span"
                        : "take a longer body, or choose the axis of the beam with --axis");
  if (span < 3.0 * h)
    refuse(body, fmt::format("the span is {:.6g}, the beam {:.6g} high", span, h),
           "below a span of three heights a body is no beam, and its formulas mean nothing",
           "choose the axis of the beam with --axis and the load's with --across, or take a longer body");
  test.section = section, test.length = span, test.height = h;
  test.way = request.notch ? test.upper : "test_below";  // the work of the load goes with its own way
  test.direction = body.across, test.sign = -1.0;
  // under a force F at a and b from the supports: stress F a b c / (S I), deflection there F a^2 b^2 / (3 E I
  // S)
  test.stress_per_force = a * b * c / (span * I);
  test.strain_per_way = 3.0 * c / (a * b);
  if (request.notch) test.notch = notch_of(body, request, section, {left.place, right.place, load.place});
  set_progress(body, test);

  TestText text(body);
  text.comment("the rows of particles that rest on the supports, and the one that is pushed");
  text.box("test_left", left.low, left.high), text.box("test_right", right.low, right.high);
  text.both(test.lower, "test_left", "test_right");
  text.box(test.upper, load.low, load.high);
  if (!test.notch) {
    text.comment("the underside below the load, whose way is the deflection");
    text.box(test.way, below.low, below.high);
  }
  text.hold({test.lower, {body.across}, {}});
  text.hold({test.upper, {body.across}, along(body.across, test.sign / test.strain_per_way)});
  std::vector<ParticleId> supports = left.particles;
  supports.insert(supports.end(), right.particles.begin(), right.particles.end());
  std::vector<PointHold> held = held_along(supports, body.across);
  const std::vector<PointHold> more = held_along(load.particles, body.across);
  held.insert(held.end(), more.begin(), more.end());
  hold_the_body(body, text, std::move(held), supports, load.particles);
  std::vector<std::string> ways{test.lower, test.upper};
  if (!test.notch) ways.push_back(test.way);
  test.text = text.text(test, ways, 0.0);
  if (test.notch) {
    tell_notch(*test.notch, body, test);
    return test;
  }
  test.notes.push_back(fmt::format(
      "span over height is {:.3g}; shear makes E of the formula for slender beams too small, for "
      "nu = 0.25 by {:.2g} of it; supports are rows of {} and {} particles, the load is one of {}: "
      "in a packing the looser layer at the surface makes E smaller, too",
      span / h, 3.0 * h * h / (span * span), left.particles.size(), right.particles.size(),
      load.particles.size()));
  return test;
}

// ---- the disc ----

MadeTest disc(const Body& body, const Request& request) {
  MadeTest test;
  test.request = request;
  Request measured = request;
  measured.area.reset();  // that of a disc is of the loaded plane
  const Section section = section_of(body, measured);
  if (section.shape != SectionShape::circle)
    refuse(body, fmt::format("the section normal to {} is a {}", name_of_axis(body.axis), section.text()),
           "the Brazilian test needs a disc",
           "choose the axis of the disc with --axis, or cut one out of the body");
  const double D = section.extent[0], L = body.extent(body.axis);
  if (D < 8.0 * body.spacing)
    refuse(body, fmt::format("the disc is {:.3g} particles across", D / body.spacing),
           "its field of stress needs eight at least", "take smaller particles");
  const Side lower = side_of(body, test.lower, body.across, false, request),
             upper = side_of(body, test.upper, body.across, true, request);
  test.section = section, test.length = D, test.height = L;
  test.direction = body.across, test.sign = -1.0;
  test.stress_per_force = 2.0 / (std::numbers::pi * request.area.value_or(D * L));
  test.strain_per_way = 1.0 / D;
  set_progress(body, test);
  double arc = 0;
  for (const Side* side : {&lower, &upper})
    for (const ParticleId p : side->particles)
      arc = std::max(arc, std::abs(component(body.state.r[p], body.third) - body.middle(body.third)));
  const double angle = std::asin(std::min(1.0, arc / (0.5 * D))) * 180.0 / std::numbers::pi;
  if (angle > 20.0)
    refuse(body, fmt::format("the platens would touch the disc over {:.3g} degrees to each side", angle),
           "beyond 20 degrees it is no Brazilian test", "give a smaller --depth, or take smaller particles");

  TestText text(body);
  text.comment("the particles at the two platens");
  text.side(lower), text.side(upper);
  text.hold({test.lower, {body.across}, {}});
  text.hold({test.upper, {body.across}, along(body.across, test.sign * D)});
  std::vector<PointHold> held = held_along(lower.particles, body.across);
  const std::vector<PointHold> more = held_along(upper.particles, body.across);
  held.insert(held.end(), more.begin(), more.end());
  hold_the_body(body, text, std::move(held), lower.particles, upper.particles);
  test.text = text.text(test, {test.lower, test.upper}, 0.0);
  test.notes.push_back(
      fmt::format("the platens hold the disc over {:.3g} degrees to each side of its diameter", angle));
  return test;
}

}  // namespace

MadeTest make_test(const Body& body, const Request& request) {
  MadeTest test = request.kind == Kind::bend3       ? bending(body, request)
                  : request.kind == Kind::brazilian ? disc(body, request)
                                                    : test_between_ends(body, request);
  if (body.beyond != 0.0)
    test.notes.push_back(fmt::format(
        "all bonds are {} than the radii of their particles: faces are taken {:.6g} {}, half of the {}",
        body.beyond > 0.0 ? "longer" : "shorter", std::abs(body.beyond),
        body.beyond > 0.0 ? "farther out" : "farther in", body.beyond > 0.0 ? "least gap" : "least overlap"));
  if (test.section)
    test.notes.insert(test.notes.end(), test.section->notes.begin(), test.section->notes.end());
  return test;
}

}  // namespace vbond::labtest

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "vbond/labtest/test_body.hpp"
#include "vbond/model/filled_box.hpp"

namespace vbond::labtest {
namespace {

constexpr double rounding = 1e-9;

/// Place of a particle in the section, from its middle.
std::array<double, 2> place_in_section(const Body& body, ParticleId p) {
  return {component(body.state.r[p], body.across) - body.middle(body.across),
          component(body.state.r[p], body.third) - body.middle(body.third)};
}

/// By how much a particle fills more than the place of one of the mean size  [length].
double fills_more(const Body& body, ParticleId p) {
  return std::max(0.0, body.reach(p) - 0.5 * body.spacing);
}

/// Of a body about an axis: twice the distance of its surface from the axis, by the farthest particle of each
/// sector. Sectors are 1.5 spacings wide at the rim, so that each holds some; there are 6 to 36.
struct Roundness {
  double diameter = 0;  ///< mean over the sectors
  double least = 0;     ///< 0: a sector is empty
  double largest = 0;
};
Roundness roundness_of(const Body& body, const std::vector<ParticleId>& particles) {
  const double rim = std::numbers::pi * std::max(body.extent(body.across), body.extent(body.third));
  const auto sectors = static_cast<std::size_t>(std::clamp(rim / (1.5 * body.spacing), 6.0, 36.0));
  std::vector<double> most(sectors, 0.0);
  for (const ParticleId p : particles) {
    const auto [u, v] = place_in_section(body, p);
    const double turn = 0.5 + std::atan2(v, u) / (2.0 * std::numbers::pi);
    double& m = most[std::min(sectors - 1, static_cast<std::size_t>(turn * static_cast<double>(sectors)))];
    m = std::max(m, 2.0 * (std::hypot(u, v) + body.reach(p)));
  }
  const auto [least, largest] = std::minmax_element(most.begin(), most.end());
  Roundness round{0, *least, *largest};
  for (const double m : most) round.diameter += m / static_cast<double>(sectors);
  return round;
}

/// Whether one of these particles is near each of the four corners of the section.
bool fill_corners(const Body& body, const std::vector<ParticleId>& particles) {
  constexpr double near = 0.7;  // of the spacing: a disc of five particles across has .8
  for (const int s : {-1, 1})
    for (const int t : {-1, 1}) {
      double least = std::numeric_limits<double>::infinity();
      for (const ParticleId p : particles) {
        const double R = body.reach(p);
        const auto [u, v] = place_in_section(body, p);
        least = std::min(least, std::hypot(u - s * (0.5 * body.extent(body.across) - R),
                                           v - t * (0.5 * body.extent(body.third) - R)));
      }
      if (least > near * body.spacing) return false;
    }
  return true;
}

/// Equal parts of a length, of two spacings or a little more.
struct Parts {
  double low = 0, width = 0;
  std::size_t count = 1;
  Parts(const Body& body, int direction)
      : low(body.low(direction)),
        count(std::max<std::size_t>(
            1, static_cast<std::size_t>(body.extent(direction) / (2.0 * body.spacing) + rounding))) {
    width = body.extent(direction) / static_cast<double>(count);
  }
  std::size_t at(double x) const {
    return static_cast<std::size_t>(
        std::clamp(std::floor((x - low) / width), 0.0, static_cast<double>(count - 1)));
  }
};

/// A slice of the body normal to its axis. A particle larger than the others is in each slice that it fills.
struct Slice {
  double from = 0, to = 0;  ///< along the axis, from the lower face  [length]
  std::vector<ParticleId> particles;
  std::array<double, 2> extent{};  ///< across and along the third direction  [length]
};
std::vector<Slice> slices_of(const Body& body) {
  const Parts parts(body, body.axis);
  std::vector<Slice> slices(parts.count);
  for (std::size_t k = 0; k < parts.count; ++k)
    slices[k].from = parts.width * static_cast<double>(k),
    slices[k].to = parts.width * static_cast<double>(k + 1);
  for (const ParticleId p : body.model.mass.ids()) {
    const double x = component(body.state.r[p], body.axis), more = fills_more(body, p);
    for (std::size_t k = parts.at(x - more); k <= parts.at(x + more); ++k) slices[k].particles.push_back(p);
  }
  for (Slice& slice : slices) {
    BoundingBox box;
    for (const ParticleId p : slice.particles) box.add(body.state.r[p], body.reach(p));
    if (slice.particles.empty()) continue;
    for (const auto& [k, direction] : {std::pair{0, body.across}, std::pair{1, body.third}})
      slice.extent[static_cast<std::size_t>(k)] =
          component(box.high, direction) - component(box.low, direction);
  }
  return slices;
}

/// Whether the slice has a hole: no particle within 1.5 spacings of the middle of the section, or in a square
/// of two spacings that is inside of the section.
bool has_hole(const Body& body, const Section& section, const Slice& slice) {
  const Parts us(body, body.across), vs(body, body.third);
  std::vector<bool> filled(us.count * vs.count, false);
  double nearest = std::numeric_limits<double>::infinity();
  for (const ParticleId p : slice.particles) {
    const auto [u, v] = place_in_section(body, p);
    const double more = fills_more(body, p);
    nearest = std::min(nearest, std::hypot(u, v) - more);
    const double x = component(body.state.r[p], body.across), y = component(body.state.r[p], body.third);
    for (std::size_t i = us.at(x - more); i <= us.at(x + more); ++i)
      for (std::size_t j = vs.at(y - more); j <= vs.at(y + more); ++j) filled[i * vs.count + j] = true;
  }
  if (nearest > 1.5 * body.spacing) return true;
  for (std::size_t i = 0; i < us.count; ++i)
    for (std::size_t j = 0; j < vs.count; ++j) {
      if (filled[i * vs.count + j]) continue;
      if (section.shape == SectionShape::box) return true;
      const double u = std::abs((static_cast<double>(i) + 0.5) * us.width - 0.5 * body.extent(body.across)),
                   v = std::abs((static_cast<double>(j) + 0.5) * vs.width - 0.5 * body.extent(body.third));
      if (std::hypot(u + 0.5 * us.width, v + 0.5 * vs.width) <= 0.5 * section.extent[0]) return true;
    }
  return false;
}

std::string way_out(const Request& request, const std::string& first) {
  const bool given = request.kind != Kind::bend3 && request.kind != Kind::brazilian;
  return first + (given ? ", or give the area that bears with --area" : "");
}

/// Throws CaseError unless each slice has the section of the whole body, and no hole.
void require_all_along(const Body& body, const Request& request, Section& section) {
  double share = 0;
  const std::vector<Slice> slices = slices_of(body);
  for (const Slice& slice : slices) {
    const double u = slice.extent[0], v = slice.extent[1];
    const bool is_box = section.shape == SectionShape::box;
    const double whole_u = body.extent(body.across), whole_v = body.extent(body.third);
    const double tolerance = (is_box ? 0.5 : 1.0) * body.spacing + rounding;
    if (u < whole_u - tolerance || v < whole_v - tolerance ||
        (!is_box && roundness_of(body, slice.particles).largest < section.extent[0] - 1.6 * body.spacing))
      refuse(
          body,
          fmt::format("the section normal to {} is a {}, but not all along the body: from {:.6g} to {:.6g} "
                      "above its lower face it is {:.6g} x {:.6g}",
                      name_of_axis(body.axis), section.text(), slice.from, slice.to, u, v),
          "a specimen lies along its axis, and has one section between its ends",
          way_out(request, "choose the axis with --axis, turn the body along it"));
    if (has_hole(body, section, slice))
      refuse(
          body,
          fmt::format("the section normal to {} is a {} with a hole, from {:.6g} to {:.6g} above its lower "
                      "face",
                      name_of_axis(body.axis), section.text(), slice.from, slice.to),
          "stresses are forces over a section that is full",
          way_out(request, "take a body without holes of two spacings and more"));
    share += u * v / (whole_u * whole_v) / static_cast<double>(slices.size());
  }
  if (share < 0.95)
    section.notes.push_back(fmt::format(
        "the body is rough or not quite along {}: slices two spacings thick fill {:.3g} of the section {} on "
        "average, stresses are too small by so much; give --area where you know it",
        name_of_axis(body.axis), share, section.text()));
}

/// As homogenise looks at it, which refuses what does not.
void tell_box_not_filled(const Body& body, const Request& request, const std::vector<ParticleId>& all,
                         Section& section) {
  if (section.shape != SectionShape::box) return;
  const auto why = why_box_not_filled(body.model, body.state, body.box, all);
  if (!why) return;
  section.notes.push_back(
      fmt::format("{}; the section is that of this box, {}: its area may be too large, and stresses and "
                  "moduli too small; {}",
                  *why, section.text(), way_out(request, "cut off what sticks out")));
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
  Section section{SectionShape::box, u * v, {u, v}};
  if (!fill_corners(body, all)) {
    const Roundness round = roundness_of(body, all);
    if (round.least == 0.0 || round.least < round.largest - 1.6 * body.spacing - rounding ||
        std::abs(u - v) > 0.5 * body.spacing + rounding)
      refuse(body,
             fmt::format("the section normal to {} is neither a box nor a circle: {:.6g} x {:.6g}, with "
                         "corners that are empty{}",
                         name_of_axis(body.axis), u, v,
                         round.least == 0.0 ? ""
                                            : fmt::format(", and between {:.6g} and {:.6g} across",
                                                          round.least, round.largest)),
             "stresses are forces over the area of the section",
             way_out(request, "choose the axis of the specimen with --axis"));
    const double D = round.diameter;
    section = {SectionShape::circle, 0.25 * std::numbers::pi * D * D, {D, D}};
    if (round.largest - round.least > 0.05 * D)
      section.notes.push_back(fmt::format(
          "the circle has steps: it is between {:.6g} and {:.6g} across, and its area is known to some "
          "{:.2g} "
          "of itself{}",
          round.least, round.largest, (round.largest - round.least) / D,
          request.kind == Kind::bend3 || request.kind == Kind::brazilian
              ? ""
              : "; give --area where you know it"));
  }
  require_all_along(body, request, section);
  tell_box_not_filled(body, request, all, section);
  return section;
}

}  // namespace vbond::labtest

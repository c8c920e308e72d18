#include "vbond/labtest/notch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "vbond/core/error.hpp"
#include "vbond/model/bond.hpp"

namespace vbond::labtest {
namespace {

/// Bonds that cannot be listed, or that would be made anew across the notch.
void refuse_bonds(const Body& body) {
  for (const BondSpec& b : body.c.bonds) {
    if (std::holds_alternative<AtCrossings>(b.select.value))
      throw CaseError(Problem{b.place, "bonds \"" + b.name + "\" join fibres where they cross",
                              "a notch lists the bonds that stay as pairs of particles, and these hang on "
                              "more than their particles",
                              "leave --notch out, or make the body without crossing_gap"});
    if (b.when == BondTime::approach)
      throw CaseError(Problem{b.place, "bonds \"" + b.name + "\" are made on approach",
                              "faces of a notch that touch would be bonded again",
                              "make them at the start, when = \"start\", or leave --notch out"});
  }
}

/// A plane normal to the axis at this place, or near it so that no particle lies in it: then it is half of
/// the way to the next particles below.
double clear_plane(const Body& body, double wanted) {
  const double near = 1e-6 * body.spacing;
  double below = -std::numeric_limits<double>::infinity();
  bool clear = true;
  for (const ParticleId p : body.model.mass.ids()) {
    const double x = component(body.state.r[p], body.axis);
    if (x < wanted - near)
      below = std::max(below, x);
    else if (x <= wanted + near)
      clear = false;
  }
  return clear ? wanted : 0.5 * (below + wanted);
}

/// Whether a bond is another cell of the flat joint that the one before it belongs to.
bool is_next_cell(const Bond* before, const Bond& b) {
  return before != nullptr && before->set == b.set && before->i == b.i && before->j == b.j;
}

/// How far from the stretched side a bond crosses the plane; nothing if it does not.
std::optional<double> depth_of_crossing(const Body& body, const Bond& b, double plane) {
  const Vec3d &i = body.state.r[b.i], &j = body.state.r[b.j];
  const double to_i = component(i, body.axis) - plane, to_j = component(j, body.axis) - plane;
  if ((to_i < 0.0) == (to_j < 0.0)) return std::nullopt;
  const Vec3d at = i + (to_i / (to_i - to_j)) * (j - i);
  return component(at, body.across) - body.low(body.across);
}

double depth_asked(const Request& request, double height) {
  return request.notch->of_height ? request.notch->value * height : request.notch->value;
}

/// Lists the bonds that stay, from the first set on that has lost one: a set that selects by distance bonds
/// what those before it have left.
std::vector<ListedBonds> listed(const Body& body, const std::vector<char>& left_out) {
  std::vector<ListedBonds> all;
  std::size_t first = body.c.bonds.size(), k = 0;
  for (const Bond& b : body.state.bonds)
    if (left_out[k++] != 0) first = std::min(first, static_cast<std::size_t>(b.set));
  for (std::size_t set = first; set < body.c.bonds.size(); ++set) all.push_back({set, {}});
  k = 0;
  const Bond* before = nullptr;
  for (const Bond& b : body.state.bonds) {
    if (left_out[k++] == 0 && b.set >= first && !is_next_cell(before, b))
      all[b.set - first].pairs.push_back(
          {static_cast<std::int64_t>(b.i.value), static_cast<std::int64_t>(b.j.value)});
    before = &b;
  }
  for (const ListedBonds& set : all)
    if (set.pairs.empty())
      throw CaseError(Problem{body.c.bonds[set.set].place,
                              "bonds \"" + body.c.bonds[set.set].name + "\" has no bond besides the notch",
                              "a set of bonds cannot be empty",
                              "give a smaller --notch, or leave this set out"});
  return all;
}

void require_section(const Body& body, const Section& section, double span) {
  const double h = section.extent[0];
  if (section.shape != SectionShape::box)
    refuse(body, fmt::format("the section normal to {} is a {}", name_of_axis(body.axis), section.text()),
           "the formula for the toughness is that of a rectangular beam", "cut a beam out of the body");
  if (std::abs(span / h - notched_span) > notched_span * off_notched_span)
    refuse(body, fmt::format("the span is {:.6g}, {:.4g} heights of the beam", span, span / h),
           fmt::format("the formula for the toughness is that of a span of {:g} heights, here to {:g} %",
                       notched_span, 100.0 * off_notched_span),
           "leave --span out, and take a beam that is longer than 4 heights with smaller particles at the "
           "supports");
}

}  // namespace

double notched_beam_shape(double alpha) {
  const double rest = 1.0 - alpha;
  const double p = 1.99 - alpha * rest * (2.15 - 3.93 * alpha + 2.7 * alpha * alpha);
  return std::sqrt(alpha) * p / ((1.0 + 2.0 * alpha) * rest * std::sqrt(rest));
}

Notch notch_of(const Body& body, const Request& request, const Section& section, const BeamPlaces& places) {
  const double span = places.right - places.left, h = section.extent[0];
  refuse_bonds(body);
  require_section(body, section, span);
  const double wanted = depth_asked(request, h);
  if (!(wanted < h))
    refuse(body, fmt::format("--notch {:.6g} of a beam {:.6g} high", wanted, h), "a notch ends in the beam",
           fmt::format("give one of some {:.3g}, half of the height", 0.5 * h));
  Notch notch{.plane = clear_plane(body, 0.5 * (places.left + places.right)),
              .height = h,
              .thickness = section.extent[1]};
  std::vector<char> left_out;
  const Bond* before = nullptr;
  double deepest = 0, next = std::numeric_limits<double>::infinity();
  for (const Bond& b : body.state.bonds) {
    const auto depth = b.broken ? std::nullopt : depth_of_crossing(body, b, notch.plane);
    const bool cut = depth && *depth <= wanted + 1e-9 * h;
    left_out.push_back(cut ? 1 : 0);
    const bool counted = is_next_cell(before, b);
    before = &b;
    if (!depth || counted) continue;
    (cut ? notch.left_out : notch.stay) += 1;
    if (cut)
      deepest = std::max(deepest, *depth);
    else
      next = std::min(next, *depth);
  }
  if (notch.left_out == 0)
    refuse(
        body, fmt::format("--notch {:.6g}: no bond crosses it", wanted),
        fmt::format("bonds are left out that cross the middle of the span; the first does so {:.6g} from the "
                    "stretched side",
                    next),
        "give a deeper notch");
  if (notch.stay == 0)
    refuse(body, fmt::format("--notch {:.6g} parts the beam: no bond is left above it", wanted),
           "a notch ends in the beam", fmt::format("give one of some {:.3g}, half of the height", 0.5 * h));
  notch.depth = 0.5 * (deepest + next);
  if (notch.share() < least_notch || notch.share() > deepest_notch)
    refuse(body,
           fmt::format("the notch is {:.6g} deep, {:.3g} of the height: half of the way from the last bond "
                       "that is left out to the next one",
                       notch.depth, notch.share()),
           fmt::format("the formula for the toughness is taken from {:g} to {:g} of the height", least_notch,
                       deepest_notch),
           fmt::format("give one of some {:.3g}, half of the height", 0.5 * h));
  notch.bonds = listed(body, left_out);
  // the moment under the load, lessened to the plane of the notch
  const double a = places.load - places.left, b = places.right - places.load;
  const double moment = notch.plane < places.load ? b * (notch.plane - places.left) / span
                                                  : a * (places.right - notch.plane) / span;
  const double stress = 6.0 * moment / (notch.thickness * h * h);
  notch.toughness_per_force = stress * std::sqrt(h) * notched_beam_shape(notch.share());
  return notch;
}

std::string no_work_of_fracture(double left) {
  return fmt::format(
      "the test ends with {:.3g} of the largest force: the work of fracture follows where {:g} or less is "
      "left, "
      "give --drop {:g}",
      left, force_gone, 1.0 - force_gone);
}

void leave_out(const Notch& notch, Case& c) {
  for (const ListedBonds& of : notch.bonds) {
    BondSpec& set = c.bonds[of.set];
    set.select.value = ListedPairs{of.pairs};
    set.faces = {}, set.share = {};  // they have chosen already
  }
}

}  // namespace vbond::labtest

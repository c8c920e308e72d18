#include "vbond/setup/fibres/fibres.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "vbond/case/value.hpp"
#include "vbond/core/images.hpp"
#include "vbond/setup/fibres/fibre_field.hpp"
#include "vbond/setup/fibres/fibre_vessel.hpp"
#include "vbond/setup/fibres/orientation.hpp"
#include "vbond/setup/fibres/size_draw.hpp"
#include "vbond/setup/inertia.hpp"

namespace vbond {
namespace {

std::int64_t bonds_of(double length, double spacing) {
  return std::max<std::int64_t>(1, std::llround(length / spacing));
}

// ---- fibres -------------------------------------------------------------------------------------

double section(const FibresSpecimen& s) {
  return 0.25 * std::numbers::pi * s.diameter * s.diameter;
}

std::optional<SizeDraw> sizes_of(const SpecimenSpec& spec, const FibresSpecimen& s) {
  if (!s.lengths) return std::nullopt;
  SizeDraw sizes(*s.lengths, s.spacing);
  if (sizes.is_empty())
    refuse_fibres(spec.place, spec, "nothing is left of its lengths",
                  "they are cut off at min and max, and below the spacing", "correct the distribution");
  return sizes;
}

/// How many fibres are asked for.
std::size_t number_of(const SpecimenSpec& spec, const FibresSpecimen& s, const std::optional<SizeDraw>& sizes,
                      double volume) {
  const double each = section(s) * (sizes ? sizes->mean() : s.length.value());
  const double wanted =
      s.fibres ? static_cast<double>(*s.fibres) : std::round(s.volume_share.value() * volume / each);
  if (wanted < 1.0)
    refuse_fibres(s.amount, spec, fmt::format("volume_share = {:.6g} is no fibre", *s.volume_share),
                  fmt::format("one fibre of mean length is a share of {:.6g}", each / volume),
                  "take a larger share, a smaller vessel, or thinner or shorter fibres");
  const double particles = wanted * (each / section(s) / s.spacing + 1.0);
  if (!(particles <= static_cast<double>(keys::most_particles)))
    refuse_fibres(s.amount, spec, fmt::format("{:.4g} fibres of some {:.4g} particles", wanted, particles),
                  "a specimen has at most 1e8", "take fewer fibres, or a larger spacing");
  return static_cast<std::size_t>(wanted);
}

/// The angle between neighbouring segments, 0: straight.
double angle_of_bend(const SpecimenSpec& spec, const FibresSpecimen& s, double length) {
  const auto n = static_cast<double>(bonds_of(length, s.spacing));
  const auto curl = [n](double angle) {
    return angle == 0.0 ? 1.0 : std::sin(0.5 * n * angle) / (n * std::sin(0.5 * angle));
  };
  double angle = s.curvature.value_or(0.0) * length / n;
  if (s.curl && *s.curl < 1.0) {
    double low = 0.0, high = 2.0 * std::numbers::pi / n;
    for (int k = 0; k < 60; ++k) {
      angle = 0.5 * (low + high);
      (curl(angle) > *s.curl ? low : high) = angle;
    }
  }
  if (angle == 0.0) return angle;
  if (n < 2.0)
    refuse_fibres(spec.place, spec, fmt::format("a fibre {:.6g} long has one bond and is straight", length),
                  "curved fibres have two bonds at least", "use a smaller spacing");
  constexpr double most = 0.9 * 2.0 * std::numbers::pi;
  if (n * angle > most || (n * angle > std::numbers::pi && curl(angle) * length < s.diameter + s.gap))
    refuse_fibres(spec.place, spec,
                  fmt::format("a fibre {:.6g} long turns by {:.4g} degrees and meets itself", length,
                              n * angle * 180.0 / std::numbers::pi),
                  "an arc turns by 324 degrees at most, and its ends keep a diameter and the gap",
                  "use a smaller curvature, or a curl nearer to 1");
  return angle;
}

/// An arc of equal segments about the mean of its points, its ends along p, bent towards `side`.
std::vector<Vec3d> arc(std::int64_t bonds, double length, double angle, const Vec3d& p, const Vec3d& side) {
  const double step = length / static_cast<double>(bonds), middle = 0.5 * static_cast<double>(bonds - 1);
  std::vector<Vec3d> points{Vec3d{}};
  for (std::int64_t k = 0; k < bonds; ++k) {
    const double heading = angle * (static_cast<double>(k) - middle);
    points.push_back(points.back() + step * (std::cos(heading) * p + std::sin(heading) * side));
  }
  Vec3d mean;
  for (const Vec3d& r : points) mean += r / static_cast<double>(points.size());
  for (Vec3d& r : points) r -= mean;
  return points;
}

Vec3d side_of(const Vec3d& p, const DirectionDraw& directions, Random& random) {
  if (directions.dimensions() == 2)
    return (random.uniform() < 0.5 ? 1.0 : -1.0) * normalised(cross(directions.normal(), p));
  for (;;) {
    const Vec3d side = across(random.in_ball(), p);
    if (norm2(side) > 1e-4) return normalised(side);
  }
}

/// Bonds of a chain join the images that are nearest to each other.
void check_spacing(const SpecimenSpec& spec, const FibresSpecimen& s, const FibreVessel& vessel,
                   const std::vector<double>& lengths) {
  const CellEdges cell = vessel.cell();
  if (cell.empty()) return;
  const Vec3d h = heights(cell);
  const Periodic periodic = vessel.periodic();
  double least = INFINITY, longest = 0.0;
  for (int k = 0; k < 3; ++k)
    if (periodic[static_cast<std::size_t>(k)]) least = std::min(least, component(h, k));
  for (const double length : lengths)
    longest = std::max(longest, length / static_cast<double>(bonds_of(length, s.spacing)));
  if (longest < 0.49 * least) return;
  refuse_fibres(spec.place, spec, fmt::format("bonds of its fibres are {:.6g} long", longest),
                fmt::format("in a cell that is {:.6g} wide a bond must be shorter than half of that", least),
                "use a smaller spacing or a larger cell");
}

/// What all fibres of a specimen have in common.
struct Request {
  const SpecimenSpec& spec;
  const FibresSpecimen& s;
  FibreVessel vessel;
  DirectionDraw draw;
  std::optional<SizeDraw> sizes;  ///< none: all of one length
};

struct Drawn {
  FibreField field;
  std::vector<double> lengths;
  std::size_t drawn_again = 0;  ///< fibres whose first direction did not fit
  std::size_t pushed = 0;       ///< that lay across others at first
};

Drawn draw_fibres(const Request& q, std::size_t n, Random& random) {
  const auto& [spec, s, vessel, draw, sizes] = q;
  constexpr int most_tries = 200;
  Drawn d;
  d.field.vessel = vessel;
  d.field.radius = 0.5 * s.diameter;
  d.field.distance = s.diameter + s.gap;
  d.lengths = sizes ? sizes->draw(n, random) : std::vector<double>(n, s.length.value());
  check_spacing(spec, s, vessel, d.lengths);
  const std::vector<Vec3d> directions = draw.draw(d.lengths.size(), random);
  for (std::size_t f = 0; f < d.lengths.size(); ++f) {
    const double L = d.lengths[f], angle = angle_of_bend(spec, s, L);
    Vec3d p = directions[f];
    std::vector<Vec3d> shape;
    bool has_room = false, is_clear = false;
    for (int k = 0; k < most_tries && !(has_room && is_clear); ++k) {
      if (k == 1) ++d.drawn_again;
      if (k > 0) p = draw.draw(random);
      shape = arc(bonds_of(L, s.spacing), L, angle, p, side_of(p, draw, random));
      has_room = room_for(d.field, shape).has_value();
      is_clear = has_room && !meets_its_image(d.field, shape);
    }
    if (!has_room)
      refuse_fibres(spec.place, spec, fmt::format("a fibre {:.6g} long does not fit in between", L),
                    fmt::format("of {} directions none leaves it inside with its radius {:.6g}", most_tries,
                                0.5 * s.diameter),
                    "use shorter fibres, a larger box, layer or cell, or directions along it: orientation = "
                    "\"planar\"");
    if (!is_clear)
      refuse_fibres(
          spec.place, spec, fmt::format("a fibre {:.6g} long meets its own image", L),
          fmt::format("of {} directions none leaves a gap of {:.6g} to itself, one or more edges of the "
                      "cell farther",
                      most_tries, s.gap),
          "use shorter fibres or a larger cell");
    d.field.add(shape);
  }
  return d;
}

double share(const std::vector<double>& lengths, const FibresSpecimen& s, double volume) {
  return section(s) * std::accumulate(lengths.begin(), lengths.end(), 0.0) / volume;
}

/// Longer ones first: they find a place less easily.
std::vector<std::size_t> by_length(const std::vector<double>& lengths) {
  std::vector<std::size_t> order(lengths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return lengths[i] > lengths[j]; });
  return order;
}

/// So many fibres without crossings, the same each time; none if they are not brought apart.
std::optional<Drawn> place(const Request& q, std::size_t n) {
  Random random(q.s.seed);
  Drawn d = draw_fibres(q, n, random);
  d.pushed = add_sequentially(d.field, by_length(d.lengths), random);
  if (d.pushed > 0 && !push_apart(d.field, {q.draw.dimensions(), q.draw.normal()})) return std::nullopt;
  return d;
}

/// About the largest number that is placed where `bad` are not: 5 % of it, or one, more were tried in vain.
/// Whoever asks for it gets it.
[[noreturn]] void refuse_with_nearest(const Request& q, std::size_t wanted) {
  std::size_t good = 0, bad = wanted;
  double reached = 0.0;
  while (bad - good > 1 + good / 20) {
    const std::size_t middle = good + (bad - good) / 2;
    if (const auto d = place(q, middle)) {
      good = middle;
      reached = share(d->lengths, q.s, q.vessel.volume());
    } else {
      bad = middle;
    }
  }
  const double each = q.sizes ? q.sizes->mean() : q.s.length.value(),
               to_ask = static_cast<double>(good) * section(q.s) * each / q.vessel.volume();
  const bool flat = q.draw.dimensions() == 2;
  refuse_fibres(
      q.s.amount, q.spec,
      fmt::format("{} fibres{} were not brought apart; {} were, a volume share of {:.6g}", wanted,
                  q.s.fibres ? "" : fmt::format(", volume_share = {:.6g},", *q.s.volume_share), good,
                  reached),
      fmt::format("surfaces of fibres keep a gap of {:.6g}", q.s.gap),
      (q.s.fibres ? fmt::format("use fibres = {}", good) : fmt::format("use volume_share = {:.9g}", to_ask)) +
          ", or shorter, straighter or more aligned fibres" + (q.s.fibres ? ", or a larger vessel" : "") +
          (flat ? "; fibres that may tilt out of their plane a little find much more room: "
                  "orientation = \"tensor\" with for example [0.49, 0.49, 0.02, 0, 0, 0]"
                : ""));
}

// ---- what is told -------------------------------------------------------------------------------

std::string in_words(const OrientationTensor& a) {
  return fmt::format("xx {:.4f}, yy {:.4f}, zz {:.4f}, xy {:.4f}, xz {:.4f}, yz {:.4f}", a[0], a[1], a[2],
                     a[3], a[4], a[5]);
}

void tell(const SpecimenSpec& spec, const FibresSpecimen& s, const Drawn& d, SpecimenPoints& points) {
  const std::size_t pushed = d.pushed;
  const FibreField& field = d.field;
  std::vector<Vec3d> of_ends;
  double curl = 0.0, along = 0.0;
  OrientationTensor of_axes{};
  for (std::size_t f = 0; f < field.size(); ++f) {
    const Vec3d ends = between(points.r[field.first[f]], points.r[field.first[f + 1] - 1]);
    of_ends.push_back(normalised(ends));
    curl += norm(ends) / d.lengths[f] / static_cast<double>(field.size());
    for (std::size_t k = field.first[f]; k + 1 < field.first[f + 1]; ++k) {
      const Vec3d t = between(points.r[k], points.r[k + 1]);
      const double l = norm(t);
      const OrientationTensor one = mean_dyad({t / l});
      along += l;
      for (std::size_t m = 0; m < 6; ++m) of_axes[m] += l * one[m];
    }
  }
  for (double& x : of_axes) x /= along;
  const OrientationTensor a = mean_dyad(of_ends);
  const double reached = share(d.lengths, s, field.vessel.volume()), gap = least_distance(field) - s.diameter,
               length = along / static_cast<double>(field.size());
  const auto [least, largest] = std::minmax_element(d.lengths.begin(), d.lengths.end());
  const std::string who = fmt::format("specimen \"{}\": ", spec.name);
  points.notes.push_back(
      who +
      fmt::format("{} fibres of {} particles, volume share {:.6g}{}, length {:.6g} to {:.6g}, mean {:.6g}",
                  field.size(), points.r.size(), reached,
                  s.volume_share ? fmt::format(" of {:.6g} asked for", *s.volume_share) : "", *least,
                  *largest, length));
  points.notes.push_back(who + "orientation of ends " + in_words(a) +
                         (curl < 1.0 - 1e-9 ? "; of axes " + in_words(of_axes) : "") +
                         fmt::format("; mean curl {:.6g}", curl));
  points.notes.push_back(
      who +
      (std::isfinite(gap) ? fmt::format("surfaces are {:.6g} apart at least, {:.6g} asked for; ", gap, s.gap)
                          : std::string("there is one fibre; ")) +
      (pushed == 0
           ? "all found a free place by chance"
           : fmt::format("{} found a free place by chance, and {} more were added and all pushed apart",
                         field.size() - pushed, pushed)));
  if (d.drawn_again > 0)
    points.notes.push_back(
        who + fmt::format("{} directions were drawn again, as such fibres do not fit: orientations are not "
                          "distributed as asked for, compare the tensor",
                          d.drawn_again));
  points.figures = {{"fibres", {static_cast<double>(field.size())}},
                    {"volume_share", {reached}},
                    {"mean_length", {length}},
                    {"mean_curl", {curl}},
                    {"orientation_of_ends", {a.begin(), a.end()}},
                    {"orientation_of_axes", {of_axes.begin(), of_axes.end()}},
                    {"fibres_pushed_apart", {static_cast<double>(pushed)}},
                    {"directions_drawn_again", {static_cast<double>(d.drawn_again)}}};
  if (std::isfinite(gap)) points.figures.push_back({"least_gap", {gap}});
}

void add_chains(const SpecimenSpec& spec, const FibresSpecimen& s, const FibreField& field,
                const std::vector<double>& lengths, SpecimenPoints& points) {
  std::vector<std::int64_t> first, last, ends;
  const bool with_inertia = times_inertia_is_given(spec, points) == 0;
  for (std::size_t f = 0; f < field.size(); ++f) {
    const std::size_t n = field.points_of(f);
    const double spacing = lengths[f] / static_cast<double>(n - 1);
    for (std::size_t k = 0; k < n; ++k) {
      const auto number = static_cast<std::int64_t>(field.first[f] + k);
      const bool at_end = k == 0 || k + 1 == n;
      points.fibre.push_back(static_cast<std::int64_t>(f));
      if (k + 1 < n) points.bonds.push_back({{number, number + 1}, no_bond_type});
      if (spec.density) points.mass.push_back(*spec.density * section(s) * spacing * (at_end ? 0.5 : 1.0));
      if (with_inertia)
        points.inertia.push_back((spec.density ? points.mass.back() : spec.mass.value_or(0.0)) *
                                 (0.25 * sq(field.radius) + sq(spacing) / 12.0));
      if (at_end) ends.push_back(number);
    }
    first.push_back(static_cast<std::int64_t>(field.first[f]));
    last.push_back(static_cast<std::int64_t>(field.first[f + 1]) - 1);
  }
  points.parts = {{"ends", ends}, {"first", first}, {"last", last}};
  points.radius.assign(points.r.size(), field.radius);
}

}  // namespace

SpecimenPoints make_fibres(const SpecimenSpec& spec, const Case& c) {
  const auto& s = std::get<FibresSpecimen>(spec.shape);
  const Request q{spec, s, vessel_of(spec, s, c), DirectionDraw(s), sizes_of(spec, s)};
  const std::size_t n = number_of(spec, s, q.sizes, q.vessel.volume());
  const std::optional<Drawn> placed = place(q, n);
  if (!placed) refuse_with_nearest(q, n);
  const Drawn& d = *placed;
  SpecimenPoints points;
  points.r = d.field.points();
  add_chains(spec, s, d.field, d.lengths, points);
  tell(spec, s, d, points);
  return points;
}

double count_points(const FibresSpecimen& s) {
  if (!s.fibres || !s.length || !(s.spacing > 0.0)) return 0.0;
  return static_cast<double>(*s.fibres) * static_cast<double>(bonds_of(*s.length, s.spacing) + 1);
}

}  // namespace vbond

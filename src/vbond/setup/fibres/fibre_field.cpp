#include "vbond/setup/fibres/fibre_field.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/setup/fibres/fibre_segments.hpp"

namespace vbond {

Periodic FibreVessel::periodic() const {
  return {faces[0] == Face::through, faces[1] == Face::through, faces[2] == Face::through};
}

CellEdges FibreVessel::cell() const {
  const Periodic p = periodic();
  if (!p[0] && !p[1] && !p[2]) return {};
  CellEdges cell;
  for (const Vec3d& edge : edges) cell.push_back({edge});
  return cell;
}

void FibreField::add(const std::vector<Vec3d>& points_about_middle) {
  if (first.empty()) first.push_back(0);
  shape.insert(shape.end(), points_about_middle.begin(), points_about_middle.end());
  first.push_back(shape.size());
  middle.emplace_back();
  turn.emplace_back();
}

std::vector<Vec3d> FibreField::points() const {
  std::vector<Vec3d> r;
  r.reserve(shape.size());
  for (std::size_t f = 0; f < size(); ++f)
    for (std::size_t k = first[f]; k < first[f + 1]; ++k) r.push_back(middle[f] + rotate(turn[f], shape[k]));
  return r;
}

namespace {

std::vector<Vec3d> shape_of(const FibreField& field, std::size_t fibre) {
  const auto at = [&](std::size_t k) { return field.shape.begin() + static_cast<std::ptrdiff_t>(k); };
  return {at(field.first[fibre]), at(field.first[fibre + 1])};
}

}  // namespace

std::optional<std::array<std::array<double, 2>, 3>> room_for(const FibreField& field,
                                                             const std::vector<Vec3d>& shape) {
  std::array<std::array<double, 2>, 3> room{};
  for (std::size_t k = 0; k < 3; ++k) {
    room[k] = {0.0, 1.0};
    if (field.vessel.faces[k] != Face::whole) continue;
    const Vec3d n = field.vessel.along(k);
    double low = 0.0, high = 0.0;
    for (const Vec3d& p : shape) low = std::min(low, dot(p, n)), high = std::max(high, dot(p, n));
    const double edge = norm(field.vessel.edges[k]);
    room[k] = {(field.radius - low) / edge, 1.0 - (field.radius + high) / edge};
    if (room[k][0] > room[k][1]) return std::nullopt;
  }
  return room;
}

bool meets_its_image(const FibreField& field, const std::vector<Vec3d>& shape) {
  if (field.vessel.cell().empty()) return false;
  FibreField alone{field.vessel, field.radius, field.distance, {}, {}, {}, {}};
  alone.add(shape);
  const Segments segments(alone);
  const std::vector<Vec3d> r = alone.points();
  bool meets = false;
  for_segments_within(alone.vessel, segments, r, alone.distance, [&](const SegmentPair& pair) {
    meets = meets || distance2(segments, r, pair) < sq(alone.distance);
  });
  return meets;
}

std::size_t add_sequentially(FibreField& field, const std::vector<std::size_t>& order, Random& random) {
  // a round tries one place for each fibre that has none, and costs as much as ten steps of pushing apart;
  // few fibres are tried more often
  constexpr double worth_while = 0.05;  // of those that are left
  const Segments segments(field);
  const auto most_in_vain = std::clamp<std::size_t>(20000 / (1 + segments.point.size()), 5, 100),
             most_rounds = 20 * most_in_vain;
  std::vector<char> placed(field.size(), 0);
  std::vector<std::size_t> pending = order;
  for (std::size_t round = 0, in_vain = 0; round < most_rounds && in_vain < most_in_vain && !pending.empty();
       ++round) {
    for (const std::size_t f : pending) {
      const auto room = room_for(field, shape_of(field, f)).value();
      field.middle[f] = field.vessel.corner;
      for (std::size_t k = 0; k < 3; ++k)
        field.middle[f] += std::lerp(room[k][0], room[k][1], random.uniform()) * field.vessel.edges[k];
    }
    const std::vector<Vec3d> r = field.points();
    std::vector<std::vector<std::size_t>> across(field.size());
    for_segments_within(field.vessel, segments, r, field.distance, [&](const SegmentPair& pair) {
      const std::size_t f = segments.fibre[pair.i], g = segments.fibre[pair.j];
      if (f == g || (placed[f] && placed[g])) return;
      if (distance2(segments, r, pair) >= sq(field.distance)) return;
      across[f].push_back(g);
      across[g].push_back(f);
    });
    std::vector<std::size_t> left;
    for (const std::size_t f : pending) {
      const bool free =
          std::none_of(across[f].begin(), across[f].end(), [&](std::size_t g) { return placed[g] != 0; });
      if (free)
        placed[f] = 1;
      else
        left.push_back(f);
    }
    const auto found = static_cast<double>(pending.size() - left.size());
    in_vain = found < worth_while * static_cast<double>(pending.size()) ? in_vain + 1 : 0;
    pending = std::move(left);
  }
  return pending.size();
}

double least_distance(const FibreField& field) {
  const Segments segments(field);
  const std::vector<Vec3d> r = field.points();
  double size = 0.0;
  for (const Vec3d& edge : field.vessel.edges) size += norm(edge);
  for (const Vec3d& p : field.shape) size = std::max(size, 4.0 * norm(p));
  double least = INFINITY;
  for (double reach = field.distance; least == INFINITY; reach = std::min(2.0 * reach, size)) {
    for_segments_within(field.vessel, segments, r, reach, [&](const SegmentPair& pair) {
      const double d = std::sqrt(distance2(segments, r, pair));
      if (d <= reach) least = std::min(least, d);
    });
    if (reach >= size) break;  // an image is no farther than an edge
  }
  return least;
}

}  // namespace vbond

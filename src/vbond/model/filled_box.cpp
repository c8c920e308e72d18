#include "vbond/model/filled_box.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace vbond {
namespace {

/// From the corners of a box filled with particles the nearest one is some mean distance of particles away:
/// twice that is little. From a ball it is a third of the side.
std::optional<std::string> empty_corner(const State& state, const BoundingBox& box,
                                        const std::vector<ParticleId>& body) {
  const double far = 2.0 * mean_distance(box, body.size());
  for (const double x : {box.low.x, box.high.x})
    for (const double y : {box.low.y, box.high.y})
      for (const double z : {box.low.z, box.high.z}) {
        const auto near = [&](ParticleId p) { return norm(between(Vec3d{x, y, z}, state.r[p])) <= far; };
        if (std::none_of(body.begin(), body.end(), near))
          return fmt::format(
              "its corner ({:.6g}, {:.6g}, {:.6g}) is more than {:.3g} away from all particles", x, y, z,
              far);
      }
  return std::nullopt;
}

double face_area(const BoundingBox& box, int axis) {
  const Vec3d size = box.high - box.low;
  return component(size, (axis + 1) % 3) * component(size, (axis + 2) % 3);
}

/// A layer of the body has a particle for each square of their mean distance. With less than a third of that
/// the box ends at some that stick out.
std::optional<std::string> thin_face(const Model& model, const State& state, const BoundingBox& box,
                                     const std::vector<ParticleId>& body) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const std::vector<ParticleId> face = face_of_box(model, state, box, body, axis, side);
      const double expected = face_area(box, axis) / sq(mean_distance(box, body.size()));
      if (3.0 * static_cast<double>(face.size()) < expected)
        return fmt::format(
            "its face on the side of {}{} has {} particles that stick out, particle {} among them, where "
            "{:.0f} would fill it",
            side < 0.0 ? '-' : '+', "xyz"[axis], face.size(), face.front().value, expected);
    }
  return std::nullopt;
}

}  // namespace

double volume_of(const BoundingBox& box) {
  const Vec3d size = box.high - box.low;
  return size.x * size.y * size.z;
}

double mean_distance(const BoundingBox& box, std::size_t particles) {
  return std::cbrt(volume_of(box) / static_cast<double>(particles));
}

std::vector<ParticleId> face_of_box(const Model& model, const State& state, const BoundingBox& box,
                                    const std::vector<ParticleId>& body, int axis, double side) {
  const double end = component(side < 0.0 ? box.low : box.high, axis),
               distance = mean_distance(box, body.size()),
               rounding = 1e-9 * component(box.high - box.low, axis);
  std::vector<ParticleId> face;
  for (const ParticleId p : body)
    if (side * (end - component(state.r[p], axis)) <= std::max(2.0 * model.radius[p], distance) + rounding)
      face.push_back(p);
  return face;
}

std::optional<std::string> why_box_not_filled(const Model& model, const State& state, const BoundingBox& box,
                                              const std::vector<ParticleId>& body) {
  std::optional<std::string> why = empty_corner(state, box, body);
  if (!why) why = thin_face(model, state, box, body);
  if (why) why = "the body does not fill the box around it: " + *why;
  return why;
}

}  // namespace vbond

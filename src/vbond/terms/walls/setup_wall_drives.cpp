#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "vbond/model/periodic_cell.hpp"
#include "vbond/terms/walls/setup_walls.hpp"

namespace vbond {
namespace {

/// Turning about a pivot moves the wall's centre, as soon as a servo has driven it away from there: not along
/// the servo, which has its own say.
void check_servo_turns(const WallDriveSpec& d, const StageResolver& resolver, const WallDrive& drive) {
  const Vec3d axis = d.angular_velocity, e = normalised(d.servo->direction);
  constexpr double rounding = 1e-9;
  if (!drive.pivot || norm(cross(axis, e)) <= rounding * norm(axis)) return;
  resolver.problems.add(
      d.place,
      fmt::format("wall \"{}\" turns about a pivot that is fixed in space, across the "
                  "direction of its servo",
                  d.wall.value),
      "the rotation would move it along servo.direction, in which the servo alone does",
      "leave the pivot out, so that it turns about its moments_about wherever the servo takes it, "
      "or turn about servo.direction");
}

/// The place in Model::walls of the wall of an entry; nothing if there is none.
std::optional<std::size_t> wall_of_entry(const StageResolver& resolver, const WallDriveSpec& d,
                                         const std::vector<WallDrive>& before) {
  const auto index = look_up_wall(d.wall, resolver.model, resolver.problems);
  const auto same = [&](const auto& other) { return other.index == *index; };
  if (index && std::any_of(before.begin(), before.end(), same))
    resolver.problems.add(
        d.wall.place,
        fmt::format("wall \"{}\" is moved twice in stage \"{}\"", d.wall.value, resolver.spec.name),
        "a stage has one entry for a wall", "put both motions into one entry");
  return index;
}

}  // namespace

void WallsTerm::resolve(const StageResolver& resolver, StagePart<WallsTerm>& to) {
  const bool at_rest = is_static(resolver.spec.kind);
  std::vector<WallDrive>& drives = to.walls;
  for (const WallDriveSpec& d : resolver.spec.walls) {
    const auto index = wall_of_entry(resolver, d, drives);
    if (!index) continue;
    WallDrive drive;
    drive.wall = d.wall.value;
    drive.index = *index;
    drive.off = d.off;
    drive.velocity = at_rest ? d.displacement : d.velocity;
    drive.angular_velocity = at_rest ? d.rotation : d.angular_velocity;
    drive.pivot = d.pivot;
    drive.factor = resolver.function(d.factor, d.place);
    if (d.oscillation) drive.amplitude = d.oscillation->amplitude, drive.frequency = d.oscillation->frequency;
    if (resolver.model.cell.any() && !may_turn_in_cell(resolver.model.walls[*index].shape, drive))
      resolver.problems.add(
          d.place, fmt::format("wall \"{}\" turns", d.wall.value),
          "in a periodic body only a cylinder may, about its own axis: all else would differ "
          "from image to image",
          "leave the rotation out, or give it along the cylinder's axis and without a pivot");
    if (d.servo) check_servo_turns(d, resolver, drive);
    if (d.servo)
      drive.servo = {normalised(d.servo->direction),
                     d.servo->force,
                     resolver.function(d.servo->factor, d.place),
                     d.servo->mass,
                     d.servo->damping,
                     d.servo->fastest.value_or(std::numeric_limits<double>::infinity())};
    drives.push_back(std::move(drive));
  }
}

}  // namespace vbond

#include "vbond/case/keys.hpp"
#include "vbond/case/special_values.hpp"

namespace vbond::keys {
namespace {

/// Any number of directions; none is not written.
struct DirectionsCodec : ListCodec<VectorCodec> {
  std::string write(const std::vector<Vec3d>& directions) const {
    return directions.empty() ? std::string{} : ListCodec<VectorCodec>::write(directions);
  }
};

/// A movement of a degree of freedom that is not held would be lost without a word; less than a thousandth
/// of one is a direction that was rounded.
void check_moves_are_held(Table& t, const HeldDirections& held, const char* along, const Vec3d& v,
                          const char* about, const Vec3d& w) {
  const auto unheld = [&held](const Vec3d& x, bool is_rotation) {
    return norm(x - held_part(held, x, is_rotation)) > (held.axes ? 1e-3 * norm(x) : 0.0);
  };
  t.check(!unheld(v, false), {along, "fix"}, "a component along a direction that fix does not hold",
          "add the direction (\"x\", \"y\", \"z\", or a vector as [0.6, 0, 0.8]) to fix, or set the "
          "component to 0");
  t.check(
      !unheld(w, true), {about, "fix"}, "a component about an axis that fix does not hold",
      "add the axis (\"rx\", \"ry\", \"rz\") to fix or a vector to fix_rotation, or set the component to 0");
}

/// The same for a rigid group; all degrees of freedom are not written.
struct FixOfGripCodec : FixCodec {
  std::string write(const SupportSpec& s) const { return s.held == all_held ? "" : FixCodec::write(s); }
};

/// A rigid group that is free in some degrees of freedom.
void check_free_grip(Table& t, const SupportSpec& s, std::optional<StageKind> kind) {
  t.check(s.along.empty(), {"fix"}, "a rigid group is held along and about the world's axes",
          "name some of \"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"");
  const int turns = s.held[3] + s.held[4] + s.held[5];
  t.check(turns != 1, {"fix"}, "a rigid group holds no rotation, two or all three",
          "add another of \"rx\", \"ry\", \"rz\", or take it out");
  t.check(turns == 3 || (s.angular_velocity == Vec3d{} && s.rotation == Vec3d{}),
          {"angular_velocity", "rotation", "fix"},
          "a rigid group that turns as it is told holds all three rotations",
          "add \"rx\", \"ry\" and \"rz\" to fix");
  t.check(!s.pivot || (s.held[0] && s.held[1] && s.held[2] && s.velocity == Vec3d{}), {"pivot", "fix"},
          "the pivot of a rigid group that is free in part stands still",
          "hold \"x\", \"y\" and \"z\" at rest, or leave pivot out: it is the centre of mass then");
  t.check(kind != StageKind::modes, {"fix"}, "modes take rigid groups that are held altogether",
          "leave fix out, or ring the body in a stage of dynamics");
}

}  // namespace

void describe(Table& t, SupportSpec& s, std::optional<StageKind> kind) {
  t.locate(s.place);
  t.key("group", s.group, group_name, required, "which particles");
  t.key("rigid", s.rigid, FlagCodec{}, optional,
        "a grip: the group moves as one rigid body, positions and orientations, all of them held");
  t.when(!s.rigid, "rigid = false", [&] {
    t.key("fix", s, FixCodec{}, required,
          "which degrees of freedom are held: translation along, rotation about the world's axes; a vector "
          "holds translation along it; at rest, where one rotation is held and two are free, the balance "
          "depends "
          "on the way there, and so on steps");
    t.key("fix_rotation", s.about, DirectionsCodec{{direction_vector}}, optional,
          "axes, as vectors, about which rotation is held as well");
    t.check(s.held != HeldDofs{} || !s.along.empty() || !s.about.empty(), {"fix"}, "must hold something",
            "name a direction, as in fix = [\"x\"]");
  });
  if (t.reading() && s.rigid && !t.is_given("fix")) s.held = all_held;
  t.when(s.rigid, "rigid = true", [&] {
    t.key("fix", s, FixOfGripCodec{}, default_is("all of them"),
          "which degrees of freedom of the group as one body are held, along and about the world's axes; "
          "loads on its particles move it along and about the others");
    t.key("pivot", s.pivot, vector_of(length), default_is("middle of the group"),
          "a point of the axis as the stage begins; the middle is the mean of the positions then, of a group "
          "that is free in part its centre of mass");
  });
  t.when(!kind || !is_static(*kind), in_dynamics, [&] {
    t.key("velocity", s.velocity, vector_of(velocity), optional,
          "of the held translations; of a rigid group's pivot");
    t.key("angular_velocity", s.angular_velocity, vector_of(angular_velocity), optional,
          "of the held rotations; of a rigid group about its pivot");
    describe(t, s.factor);
    check_moves_are_held(t, directions_of(s), "velocity", s.velocity, "angular_velocity", s.angular_velocity);
  });
  // about a balance at rest: modes take the supports as they are
  t.when(
      !kind || (is_static(*kind) && kind != StageKind::modes),
      "kind = \"equilibrium\", \"path\", \"buckling\" or \"fracture\"", [&] {
        t.key(
            "displacement", s.displacement, vector_of(length), optional,
            "of the held translations, from where the stage finds them, at load factor 1; of a rigid group's "
            "pivot");
        t.key(
            "rotation", s.rotation, vector_of(angle), optional,
            "of the held rotations at load factor 1; with all three held a rotation vector, of a rigid group "
            "about its pivot");
        check_moves_are_held(t, directions_of(s), "displacement", s.displacement, "rotation", s.rotation);
      });
  if (s.rigid && s.held != all_held) check_free_grip(t, s, kind);
}

void describe(Table& t, LoadSpec& s, std::optional<StageKind> kind) {
  t.locate(s.place);
  t.key("group", s.group, group_name, required, "which particles");
  t.key("force", s.force, vector_of(force), optional,
        "on each particle, fixed in direction unless it follows");
  t.key("moment", s.moment, vector_of(moment), optional,
        "on each particle, fixed in direction unless it follows");
  t.key("total_force", s.total_force, vector_of(force), optional,
        "on the whole group, shared by mass: through its centre of mass");
  t.key("total_moment", s.total_moment, vector_of(moment), optional,
        "on the whole group, as moments on its particles, shared by mass: a torque about any axis along it");
  t.when(!kind || takes_followers(*kind), "kind = \"dynamics\", \"equilibrium\" or \"path\"", [&] {
    t.key("follower", s.follower, FlagCodec{}, optional,
          "the load turns with each particle: it is given along the particle's own axes, those of the world "
          "where "
          "the case has not turned it");
  });
  t.when(!kind || !is_static(*kind), in_dynamics, [&] { describe(t, s.factor); });
  t.when(!kind || is_static(*kind), in_statics, [&] {
    t.key("constant", s.constant, FlagCodec{}, optional,
          "at full size from the start, not in proportion to the load factor; modes: always");
  });
}

}  // namespace vbond::keys

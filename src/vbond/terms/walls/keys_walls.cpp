#include <cmath>

#include "vbond/case/keys.hpp"

namespace vbond::keys {
namespace {

constexpr ReferenceCodec wall_name{"wall"};

const ChoiceCodec<WallSide>& side_codec() {
  static const ChoiceCodec<WallSide> codec{{"inside", "outside"}, {WallSide::inside, WallSide::outside}};
  return codec;
}

}  // namespace

void describe(Table& t, PlaneWallSpec& w) {
  t.key("point", w.point, vector_of(length), optional, "a point of the plane");
  t.key("normal", w.normal, direction_vector, required,
        "points to the side of the particles; the length does not matter");
}

void describe(Table& t, DiscWallSpec& w) {
  t.key("centre", w.centre, vector_of(length), optional, "its centre");
  t.key("normal", w.normal, direction_vector, required,
        "to one of its two sides; the length does not matter");
  t.key("radius", w.radius, positive(length), required, "its radius");
}

void describe(Table& t, CylinderWallSpec& w) {
  t.key("centre", w.centre, vector_of(length), optional, "the middle of its axis");
  t.key("axis", w.axis, direction_vector, required, "along it; the length does not matter");
  t.key("radius", w.radius, positive(length), required, "its radius");
  t.key("length", w.length, positive(length), default_is("endless"),
        "from rim to rim, without lids; such a cylinder is felt from inside and from outside");
  t.when(!w.length, "no length", [&] {
    t.key("side", w.side, side_codec(), optional, "on which side of the surface particles are");
  });
}

void describe(Table& t, SphereWallSpec& w) {
  t.key("centre", w.centre, vector_of(length), optional, "its centre");
  t.key("radius", w.radius, positive(length), required, "its radius");
  t.key("side", w.side, side_codec(), optional, "on which side of the surface particles are");
}

void describe(Table& t, BoxWallSpec& w) {
  t.key("min", w.min, vector_of(length), required, "corner with the least coordinates");
  t.key("max", w.max, vector_of(length), required, "corner with the largest coordinates");
  t.check(w.min.x < w.max.x && w.min.y < w.max.y && w.min.z < w.max.z, {"min", "max"},
          "each coordinate of max must be larger than that of min",
          "exchange them; a flat wall is a disc or a mesh");
}

void describe_mesh(Table& t, Placed<std::filesystem::path>& file, double& scale, Vec3d& shift) {
  t.key("file", file, FileCodec{}, required, "triangles: STL (binary or ASCII), OBJ or PLY");
  t.key("scale", scale, positive(pure), optional,
        "lengths of the file times this are lengths of the case; 0.001 for a file in mm in SI units");
  t.key("shift", shift, vector_of(length), optional, "added to all corners after scaling");
}

void describe(Table& t, MeshWallSpec& w) {
  describe_mesh(t, w.file, w.scale, w.shift);
}

void describe(Table& t, WallOscillationSpec& o) {
  t.key("amplitude", o.amplitude, vector_of(length), required,
        "A of the displacement A sin(2 pi f t), t from the start of the stage");
  t.key("frequency", o.frequency, positive(frequency), required, "f");
  t.check(o.amplitude != Vec3d{}, {"amplitude"}, "must not be zero: nothing would move",
          "leave oscillation out");
}

void describe(Table& t, WallServoSpec& s) {
  t.key("direction", s.direction, direction_vector, required,
        "in which the wall presses; its length does not matter");
  t.key("force", s.force, positive(force), required, "with which it presses in the end");
  describe(t, s.factor);
  t.key("mass", s.mass, positive(mass), required, "of the wall, which moves as a body of this mass");
  t.key("damping", s.damping, not_negative(damping), optional, "b of a force -b v on the wall");
  t.key("fastest", s.fastest, positive(velocity), default_is("none"), "largest speed of the wall");
}

void describe(Table& t, WallSpec& w) {
  t.locate(w.place);
  t.key("name", w.name, NameCodec{}, default_is("`\"wall-1\"`, `\"wall-2\"`, ..."), "name of the wall");
  static const std::vector<std::string> shapes{"plane", "disc", "cylinder", "sphere", "box", "mesh"};
  std::size_t shape = t.reading() ? shapes.size() : w.shape.index();
  t.key("shape", shape, ChoiceCodec<std::size_t>{shapes, {0, 1, 2, 3, 4, 5}}, required,
        "plane: a half space; disc: a round plate; box: its six faces; mesh: triangles from a file");
  std::vector<std::string> conditions;
  for (const std::string& s : shapes) conditions.push_back("shape = \"" + s + "\"");
  t.alternatives(w.shape, shape, conditions);
  t.key("material", w.material, material_name, default_is("the first of the case"), "what it is made of");
  t.key("moments_about", w.moments_about, vector_of(length), default_is("its point or centre"),
        "point of the wall that the moment on it refers to");
}

namespace {

void describe_motion(Table& t, WallDriveSpec& d) {
  t.key("velocity", d.velocity, vector_of(velocity), optional, "of the wall");
  t.key("angular_velocity", d.angular_velocity, vector_of(angular_velocity), optional,
        "of its rotation about the pivot");
  describe(t, d.factor);
  t.table("oscillation", d.oscillation, "a swing of the wall on top of its other motion");
  t.table("servo", d.servo, "the wall is driven until particles press back with a force");
}

void check_off(Table& t, const WallDriveSpec& d) {
  t.check(!d.pivot && d.velocity == Vec3d{} && d.angular_velocity == Vec3d{} && d.factor.points.empty() &&
              !d.oscillation && !d.servo && d.displacement == Vec3d{} && d.rotation == Vec3d{},
          {"off"}, "a wall that is off does not move", "leave either off or the motion out");
}

void check_motion(Table& t, const WallDriveSpec& d) {
  t.check(d.velocity != Vec3d{} || d.angular_velocity != Vec3d{} || d.oscillation || d.servo,
          {"wall", "velocity", "angular_velocity", "oscillation", "servo"},
          "nothing moves the wall: no velocity, angular_velocity, oscillation or servo",
          "add one of them, or leave the wall out: it stands still then; off = true takes it away");
  t.check(!d.pivot || d.angular_velocity != Vec3d{}, {"pivot", "angular_velocity"},
          "nothing turns about the pivot: there is no angular_velocity",
          "add angular_velocity, or remove pivot");
  t.check(d.factor.points.empty() || d.velocity != Vec3d{} || d.angular_velocity != Vec3d{},
          {"ramp", "table", "velocity", "angular_velocity"},
          "it does nothing: it is the factor of velocity and angular_velocity, and there are none",
          "remove it; a servo has a ramp or table of its own, an oscillation none");
  const auto along = [&d](const Vec3d& v) {
    return d.servo && std::abs(dot(v, d.servo->direction)) > 1e-12 * norm(v) * norm(d.servo->direction);
  };
  const char* const rule = "has a part along servo.direction, in which the wall moves as the servo has it";
  t.check(!along(d.velocity), {"velocity", "servo"}, rule, "take that part away, or the servo");
  t.check(!d.oscillation || !along(d.oscillation->amplitude), {"oscillation", "servo"}, rule,
          "take that part of amplitude away, or the servo");
}

void check_displacement(Table& t, const WallDriveSpec& d) {
  t.check(d.displacement != Vec3d{} || d.rotation != Vec3d{}, {"wall", "displacement", "rotation"},
          "nothing moves the wall: no displacement or rotation",
          "add one of them, or leave the wall out: it stands still then; a force moves it (servo) in stages "
          "of kind = \"dynamics\" only");
  t.check(!d.pivot || d.rotation != Vec3d{}, {"pivot", "rotation"},
          "nothing turns about the pivot: there is no rotation", "add rotation, or remove pivot");
}

}  // namespace

void describe(Table& t, WallDriveSpec& d, std::optional<StageKind> kind) {
  t.locate(d.place);
  t.key("wall", d.wall, wall_name, required, "which wall; those that are not named stand still");
  t.key("pivot", d.pivot, vector_of(length), default_is("moments_about, which goes with the wall"),
        "point about which it turns: in dynamics fixed in space, in a static stage where it is at load "
        "factor 0, from where it goes along with displacement");
  t.key("off", d.off, FlagCodec{}, optional,
        "takes the wall away in this stage; it is there again in the next one that does not say so");
  t.when(!kind || !is_static(*kind), "kind = \"dynamics\"", [&] { describe_motion(t, d); });
  t.when(!kind || is_static(*kind), "kind = \"equilibrium\" or \"fracture\"", [&] {
    t.key("displacement", d.displacement, vector_of(length), optional,
          "of the wall, from where the stage finds it, at load factor 1");
    t.key("rotation", d.rotation, vector_of(angle), optional,
          "rotation vector about the pivot at load factor 1");
  });
  if (d.off)
    check_off(t, d);
  else if (kind)
    is_static(*kind) ? check_displacement(t, d) : check_motion(t, d);
}

}  // namespace vbond::keys

namespace vbond {

void WallsTerm::describe(keys::Table& t, SpecPart<WallsTerm>& s, std::optional<StageKind> kind) {
  t.when(
      !kind || kind == StageKind::dynamics || kind == StageKind::equilibrium || kind == StageKind::fracture,
      "kind = \"dynamics\", \"equilibrium\" or \"fracture\"", [&] {
        t.tables(key, s.walls, keys::optional, "what moves walls; the others stand still",
                 [kind](keys::Table& k, WallDriveSpec& drive) { keys::describe(k, drive, kind); });
      });
}

}  // namespace vbond

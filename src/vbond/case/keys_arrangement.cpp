// What is done with the particles of a specimen, and the solids that they have the inertia of.
#include "vbond/case/keys_specimen.hpp"

namespace vbond::keys {

void check_total(Table& t, double particles, const std::vector<std::string>& keys) {
  t.check(particles <= static_cast<double>(most_particles), keys, "must not make more than 1e8 particles",
          "take fewer particles");
}

void describe_arrangement(Table& t, SpecimenSpec& s) {
  t.tables("cut", s.cut, optional, "regions that take particles away, one after another: first of all");
  t.table("turn", s.turn, "turns places and orientations: after the cuts");
  t.key("move", s.move, vector_of(length), optional, "added to all positions: after the turn");
  t.tables("array", s.array, optional, "copies in a row; two or three tables make a grid: last of all");
  double copies = 1.0;
  for (const CopiesSpec& c : s.array) copies *= static_cast<double>(c.count);
  t.check(s.array.size() <= 3, {"array"}, "must have at most 3 tables",
          "put more rows into specimens of their own");
  check_total(t, copies, {"array"});
}

void describe(Table& t, SolidSpec& s) {
  const std::vector<std::string> forms{"ellipsoid", "box", "cylinder"};
  t.alternatives(s.shape, t.exactly_one(forms, s.shape.index()), forms);
}

void describe(Table& t, EllipsoidSolid& s) {
  t.key("ellipsoid", s.semi_axes, tuple_of<3>(positive(length)), required,
        "its semi-axes along x, y, z of the particle");
}

void describe(Table& t, BoxSolid& s) {
  t.key("box", s.edges, tuple_of<3>(positive(length)), required, "its edges along x, y, z of the particle");
}

void describe(Table& t, CylinderSolid& s) {
  t.key("cylinder", s.size, tuple_of<2>(positive(length)), required,
        "its radius and its length, along z of the particle");
}

// ---- what is done with the points ---------------------------------------------------------------

void describe(Table& t, CutSpec& c) {
  t.locate(c.place);
  const std::vector<std::string> forms{"box", "sphere", "cylinder", "plane", "half_space", "mesh"};
  t.alternatives(c.region, t.exactly_one(forms, c.region.index()), forms);
  using enum CutSpec::Keep;
  t.key("keep", c.keep, ChoiceCodec<CutSpec::Keep>{{"outside", "inside"}, {outside, inside}}, optional,
        "the particles that stay: those outside of the region, or those in it");
}

void describe(Table& t, TurnSpec& turn) {
  t.key("axis", turn.axis, direction_vector, optional, "of the rotation; its length does not matter");
  t.key("angle", turn.angle, number(angle), required, "right-handed about the axis");
  t.key("about", turn.about, vector_of(length), optional, "a point of the axis");
}

void describe(Table& t, CopiesSpec& c) {
  t.key("count", c.count, CountCodec{1}, required, "number of copies, the first one counted");
  t.key("step", c.step, vector_of(length), required, "from one copy to the next");
  t.check(c.count == 1 || c.step != Vec3d{}, {"step", "count"},
          "must not be zero: copies would lie on one another", "write for example step = [10, 0, 0]");
}

}  // namespace vbond::keys

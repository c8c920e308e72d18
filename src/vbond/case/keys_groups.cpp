#include "vbond/case/keys.hpp"

namespace vbond::keys {

void describe(Table& t, GroupSpec& g) {
  t.locate(g.place);
  const std::vector<std::string> forms{"indices",    "box",          "sphere",    "cylinder", "plane",
                                       "half_space", "mesh",         "material",  "type",     "fibres",
                                       "union",      "intersection", "difference"};
  t.alternatives(g.region, t.exactly_one(forms, g.region.index()), forms);
}

void describe(Table& t, IndexList& indices) {
  t.key("indices", indices, list_of(particle_number, 1), required, "particle numbers, counted from 0");
}

void describe(Table& t, BoxRegion& r) {
  t.table("box", required, "the particles in a box with edges along the axes", [&r](Table& b) {
    b.key("min", r.min, vector_of(length), required, "corner with the least coordinates");
    b.key("max", r.max, vector_of(length), required, "corner with the largest coordinates");
    b.check(r.min.x <= r.max.x && r.min.y <= r.max.y && r.min.z <= r.max.z, {"min", "max"},
            "no coordinate of min may be larger than that of max", "exchange them");
  });
}

void describe(Table& t, SphereRegion& r) {
  t.table("sphere", required, "the particles in a ball", [&r](Table& b) {
    b.key("centre", r.centre, vector_of(length), required, "its centre");
    b.key("radius", r.radius, positive(length), required, "its radius");
  });
}

void describe(Table& t, CylinderRegion& r) {
  t.table("cylinder", required, "the particles in a cylinder with flat ends", [&r](Table& b) {
    b.key("from", r.from, vector_of(length), required, "the middle of one end");
    b.key("to", r.to, vector_of(length), required, "the middle of the other end");
    b.key("radius", r.radius, positive(length), required, "its radius");
    b.check(r.from != r.to, {"to", "from"}, "the ends of the axis must differ", "correct one of them");
  });
}

void describe(Table& t, PlaneRegion& r) {
  t.table("plane", required, "the particles near a plane", [&r](Table& b) {
    b.key("point", r.point, vector_of(length), required, "a point of the plane");
    b.key("normal", r.normal, direction_vector, required, "its normal; the length does not matter");
    b.key("within", r.within, not_negative(length), required,
          "largest distance from the plane, to either side");
  });
}

void describe(Table& t, HalfSpaceRegion& r) {
  t.table("half_space", required, "the particles behind a plane: where its normal does not point",
          [&r](Table& b) {
            b.key("point", r.point, vector_of(length), required, "a point of the plane");
            b.key("normal", r.normal, direction_vector, required,
                  "its normal, out of the half-space; the length does not matter");
          });
}

void describe(Table& t, MeshRegion& r) {
  t.table("mesh", required, "the particles inside of closed surfaces of triangles",
          [&r](Table& b) { describe_mesh(b, r.file, r.scale, r.shift); });
}

void describe(Table& t, MaterialGroup& g) {
  t.key("material", g.material, material_name, required, "the particles of this material");
}

void describe(Table& t, TypeGroup& g) {
  t.key("type", g.type, CountCodec{1}, required, "the atoms of this type in the LAMMPS data files");
}

void describe(Table& t, FibreGroup& g) {
  t.key("fibres", g.fibres, list_of(CountCodec{0, most_particles - 1}, 1), required,
        "numbers of fibres, counted from 0 in each specimen of kind = \"fibres\"; after an array those of "
        "each "
        "copy follow those of the one before");
}

void describe(Table& t, UnionGroup& g) {
  t.key("union", g.groups, list_of(group_name, 1), required, "the particles of any of these groups");
}

void describe(Table& t, IntersectionGroup& g) {
  t.key("intersection", g.groups, list_of(group_name, 1), required,
        "the particles that all these groups have");
}

void describe(Table& t, DifferenceGroup& g) {
  t.table("difference", required, "the particles of one group that others do not have", [&g](Table& d) {
    d.key("of", g.of, group_name, required, "the group");
    d.key("without", g.without, list_of(group_name, 1), required, "groups whose particles are left out");
  });
}

}  // namespace vbond::keys

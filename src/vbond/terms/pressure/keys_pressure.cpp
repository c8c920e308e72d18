#include "vbond/terms/pressure/keys_pressure.hpp"

#include "vbond/case/keys.hpp"

namespace vbond::keys {
namespace {

constexpr const char* in_rest = "kind = \"equilibrium\", \"path\", \"buckling\", \"modes\" or \"fracture\"";

void describe_strips(Table& t, PressureSpec& s) {
  t.key("width", s.width, positive(length), required, "of the strip along each bond, across the plane");
  t.key("normal", s.normal, direction_vector, optional,
        "of the plane in which the chain lies, to 3 degrees; strips stand on it, the length does not matter");
}

void describe_skin(Table& t, PressureSpec& s) {
  t.key(
      "longest", s.longest, positive(length), default_is("1.2 times the mean distance of bonded particles"),
      "between particles is body where a sphere through four of them has no larger radius, and hollows that "
      "are closed; larger values span wider gaps");
}

}  // namespace

void describe(Table& t, FacetRegion& r) {
  t.locate(r.place);
  const std::vector<std::string> forms{"box", "sphere", "cylinder", "plane", "half_space", "mesh"};
  t.alternatives(r.region, t.exactly_one(forms, r.region.index()), forms);
}

void describe(Table& t, PressureSpec& s, std::optional<StageKind> kind) {
  t.locate(s.place);
  default_to_all(s.group);
  using enum PressedSurface;
  t.key("surface", s.surface,
        ChoiceCodec<PressedSurface>{{"strips", "triangles", "skin"}, {strips, triangles, skin}}, required,
        "strips: along bonds of a chain or ring; triangles: of three bonds, as in sheets and shells; skin: "
        "the outer faces of a solid, by the Delaunay tetrahedra of its particles");
  t.key("group", s.group, group_name, optional, "the particles that the surface is made of");
  t.key("pressure", s.pressure, number(stress), required,
        "> 0 presses on a solid from outside, and towards `inside` of a chain or sheet");
  t.key("kind", s.kind,
        ChoiceCodec<PressureKind>{{"follower", "dead", "central"},
                                  {PressureKind::follower, PressureKind::dead, PressureKind::central}},
        optional,
        "follower: normal to the facets as they stand; dead: the forces of the start stay; central: the "
        "parts of "
        "them that point to `centre` keep their sizes, and follow the way to it");
  t.when(s.kind == PressureKind::central, "kind = \"central\"",
         [&] { t.key("centre", s.centre, vector_of(length), required, "where forces > 0 point to"); });
  t.when(s.surface == strips, "surface = \"strips\"", [&] { describe_strips(t, s); });
  t.when(s.surface == triangles, "surface = \"triangles\"", [&] {
    t.key("file", s.file, FileCodec{}, default_is("triangles of three bonds"),
          "CSV with the columns i, j, k: particle numbers, counted from 0, of each triangle");
  });
  t.when(s.surface != skin, "surface = \"strips\" or \"triangles\"", [&] {
    t.key("inside", s.inside, vector_of(length), default_is("the inside of a closed surface"),
          "a point on the side to which a pressure > 0 pushes: that of the facet that is nearest to it; "
          "surfaces "
          "with free edges need it");
  });
  t.when(s.surface == skin, "surface = \"skin\"", [&] { describe_skin(t, s); });
  t.table("region", s.region, "only facets whose middle is in this region as the stage begins");
  t.when(!kind || !is_static(*kind), "kind = \"dynamics\"", [&] { describe(t, s.factor); });
  t.when(!kind || is_static(*kind), in_rest, [&] {
    t.key("constant", s.constant, FlagCodec{}, optional,
          "at full size from the start, not in proportion to the load factor; modes: always");
  });
  t.check(s.pressure != 0.0, {"pressure"}, "must not be 0: nothing would press", "leave the entry out");
}

}  // namespace vbond::keys

namespace vbond {

void PressureTerm::describe(keys::Table& t, SpecPart<PressureTerm>& s, std::optional<StageKind> kind) {
  t.tables(key, s.pressures, keys::optional, "pressures on chains, sheets and the skin of solids",
           [kind](keys::Table& k, PressureSpec& pressure) { keys::describe(k, pressure, kind); });
}

}  // namespace vbond

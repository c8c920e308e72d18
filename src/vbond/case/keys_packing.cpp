#include <algorithm>
#include <set>
#include <string>

#include "vbond/case/keys.hpp"

namespace vbond::keys {
namespace {

constexpr NumberCodec share_below_one{pure, {0, 1, false, true}};

void describe_ends(Table& t, std::optional<double>& from, std::optional<double>& to) {
  t.key("from", from, positive(length), default_is("three standard deviations below the middle"),
        "no grain is smaller");
  t.key("to", to, positive(length), default_is("three standard deviations above it"), "no grain is larger");
  t.check(!from || !to || *from < *to, {"from", "to"}, "the least radius must be below the largest",
          "exchange them");
}

}  // namespace

void describe(Table& t, VesselSpec& v) {
  t.locate(v.place);
  const std::vector<std::string> forms{"box", "sphere", "cylinder", "plane", "half_space", "mesh"};
  t.alternatives(v.region, t.exactly_one(forms, v.region.index()), forms);
  using enum CutSpec::Keep;
  t.key("keep", v.keep, ChoiceCodec<CutSpec::Keep>{{"inside", "outside"}, {inside, outside}}, optional,
        "where grains are: in the region, or around it");
}

void describe(Table& t, EqualGrains& g) {
  t.key("radius", g.radius, positive(length), required, "of all grains");
}

void describe(Table& t, UniformGrains& g) {
  t.key("radii", g.radii, tuple_of<2>(positive(length)), required,
        "the least and the largest; in between all are as frequent");
  t.check(g.radii[0] < g.radii[1], {"radii"}, "the least radius must be below the largest",
          "exchange them, or write radius for equal grains");
}

void describe(Table& t, NormalGrains& g) {
  t.table("normal", required, "radii are distributed normally", [&g](Table& n) {
    n.key("mean", g.mean, positive(length), required, "mean radius");
    n.key("deviation", g.deviation, positive(length), required, "standard deviation of the radius");
    describe_ends(n, g.from, g.to);
    n.check(g.from || g.mean - 3.0 * g.deviation > 0.0, {"deviation", "mean", "from"},
            "three standard deviations below the mean no radius is above 0", "give from");
  });
}

void describe(Table& t, LognormalGrains& g) {
  t.table("lognormal", required, "logarithms of radii are distributed normally", [&g](Table& n) {
    n.key("median", g.median, positive(length), required, "median radius by number");
    n.key("deviation", g.deviation, NumberCodec{pure, {0, 3, true, false}}, required,
          "standard deviation of ln R");
    describe_ends(n, g.from, g.to);
  });
}

void describe(Table& t, CurveGrains& g) {
  t.table("curve", required, "a curve of sizes, such as a sieve curve", [&g](Table& c) {
    c.key("radii", g.radii, list_of(positive(length), 2), required,
          "radii, growing: half the widths of sieves");
    c.key("passing", g.passing, list_of(NumberCodec{pure, {0, 1, false, false}}, 2), required,
          "the share of grains smaller than each: from 0 to 1, straight in between");
    c.key("by", g.by_mass, ChoiceCodec<bool>{{"mass", "number"}, {true, false}}, optional,
          "share of what; mass is that of one kind of grains, so that volume is the same");
    c.check(g.radii.size() == g.passing.size(), {"passing", "radii"}, "there must be as many as radii",
            "give one share for each radius");
    const auto falls = [](const std::vector<double>& x, bool strictly) {
      for (std::size_t k = 1; k < x.size(); ++k)
        if (strictly ? !(x[k - 1] < x[k]) : x[k - 1] > x[k]) return true;
      return false;
    };
    c.check(!falls(g.radii, true), {"radii"}, "radii must grow", "put them in order");
    c.check(!falls(g.passing, false) &&
                (g.passing.empty() || (g.passing.front() == 0.0 && g.passing.back() == 1.0)),
            {"passing"}, "must begin with 0, end with 1 and not fall in between",
            "add the radius below which there is no grain, and that above which there is none");
  });
}

void describe(Table& t, GrainSpec& g) {
  t.locate(g.place);
  t.key("name", g.name, NameCodec{}, optional, "its grains form a group of this name");
  t.key("share", g.share, positive(pure), optional, "of all grains, as share_by says; only ratios count");
  const std::vector<std::string> forms{"radius", "radii", "normal", "lognormal", "curve"};
  t.alternatives(g.sizes, t.exactly_one(forms, g.sizes.index()), forms);
  t.key("density", g.density, positive(density), default_is("that of the specimen"),
        "of these grains; only one of the two may be given");
}

void describe(Table& t, PackingSpecimen& s) {
  t.tables("grains", s.grains, required, "kinds of grains");
  t.tables("vessel", s.vessel, default_is("the cell of the case"),
           "regions that grains are packed into; of several what all of them leave");
  t.key("share_by", s.share_by,
        ChoiceCodec<GrainShares>{{"volume", "mass", "number"},
                                 {GrainShares::volume, GrainShares::mass, GrainShares::number}},
        optional, "what the shares of kinds of grains are parts of");
  t.key("porosity", s.porosity, share_below_one, default_is("one of porosity, particles and jammed"),
        "1 - volume of grains over volume of the vessel; grains are as many as that takes");
  t.key("particles", s.particles, CountCodec{1}, default_is("one of porosity, particles and jammed"),
        "number of grains");
  t.key("jammed", s.jammed, FlagCodec{}, optional,
        "grains grow until they lock, and shrink until they just touch; with particles, so many of them, "
        "without, as many as leaves their sizes as asked");
  t.key("overlap", s.overlap, NumberCodec{pure, {0, 0.2, false, false}},
        default_is("1e-3; with jammed grains just touch"),
        "largest overlap that may be left, over the smaller radius");
  t.key("floaters", s.floaters,
        ChoiceCodec<FloatingGrains>{{"keep", "remove", "grow"},
                                    {FloatingGrains::keep, FloatingGrains::remove, FloatingGrains::grow}},
        optional,
        "what becomes of grains with fewer neighbours than min_neighbours: they stay, or are taken away, or "
        "grow in their holes");
  t.key("min_neighbours", s.neighbours, CountCodec{1, 12}, optional, "with fewer a grain is a floater");
  t.key("gap", s.gap, NumberCodec{pure, {1, 3, false, false}}, optional,
        "grains are neighbours within the sum of their radii times this");
  t.key("seed", s.seed, seed_number, optional, "of the random places");
  t.check(s.porosity.has_value() + (s.particles || s.jammed) == 1,
          {"porosity", "particles", "jammed", "kind"},
          "exactly one of porosity, particles and jammed is required; jammed may have particles too",
          "write for example porosity = 0.4");
  t.check(!s.jammed || !s.overlap || *s.overlap >= 1e-6, {"overlap"},
          "grains that are jammed cannot be told to overlap by less than 1e-6",
          "leave it out: they then just touch, in good balance");
  t.check(!s.grains.empty() || !t.reading(), {"grains", "kind"}, "there must be a kind of grains",
          "write for example grains = [{ radius = 1.0 }]");
  std::set<std::string> names;
  bool once = true;
  for (const GrainSpec& g : s.grains) once = names.insert(g.name).second && once;
  t.check(once, {"grains"}, "two kinds of grains have one name", "give each a name of its own");
}

}  // namespace vbond::keys

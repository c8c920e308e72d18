#include <optional>

#include "vbond/case/keys.hpp"

namespace vbond::keys {
namespace {

constexpr CountCodec number_of_bodies{1, most_particles};

void describe_visits(Table& t, VisitSpec& v) {
  t.key("stages", v.stages, list_of(stage_name), default_is("all stages of dynamics"), "in which stages");
  t.key("from", v.from, TimeCodec{}, default_is("the beginning of the stage"),
        "time of each of these stages");
  t.key("until", v.until, TimeCodec{}, default_is("the end of the stage"), "likewise");
  t.key(
      "every", v.every, TimeCodec{}, default_is("500 steps"),
      "time from one visit to the next, the first of them after this time of the stage: what is due by then "
      "is done at once, and the step loop is set up anew, which takes as long as some steps");
}

void describe_rate(Table& t, double& bodies_per_time) {
  std::optional<double> rate;
  if (bodies_per_time > 0.0) rate = bodies_per_time;
  t.key("rate", rate, positive(frequency), default_is("none: all are due at once"),
        "bodies that become due per time; those that find no room wait for the next visit");
  bodies_per_time = rate.value_or(0.0);
}

template <class Regions>
void describe_region(Table& t, Regions& region, const std::vector<std::string>& forms) {
  t.alternatives(region, t.exactly_one(forms, region.index()), forms);
}

}  // namespace

void describe(Table& t, SourceSpec& s) {
  t.locate(s.place);
  t.key("name", s.name, NameCodec{}, default_is("`\"source-1\"`, `\"source-2\"`, ..."), "name of the source");
  t.key("specimen", s.specimen, specimen_name, required,
        "what comes in: this specimen, which waits, with the bonds that sets with when = \"start\" make "
        "inside of "
        "it");
  t.key("count", s.count, number_of_bodies, required, "how many such bodies there are in all");
  describe_rate(t, s.rate);
  describe_visits(t, s.visits);
  describe_region(t, s.region, {"box", "sphere", "cylinder", "mesh"});
  t.key("fit", s.whole, ChoiceCodec<bool>{{"whole", "centre"}, {true, false}}, optional,
        "what of a body is inside of the region: all of it, or its centre of mass");
  t.key("orientation", s.turned, ChoiceCodec<bool>{{"random", "given"}, {true, false}}, optional,
        "turned at random, all rotations alike, or as the specimen stands");
  t.key("velocity", s.velocity, vector_of(velocity), optional, "of the centre of mass as a body comes in");
  t.key("velocity_spread", s.velocity_spread, not_negative(velocity), optional,
        "standard deviation of each component of a normally distributed velocity on top of it");
  t.key("angular_velocity", s.angular_velocity, vector_of(angular_velocity), optional,
        "of the body about its centre of mass");
  t.key("angular_velocity_spread", s.angular_velocity_spread, not_negative(angular_velocity), optional,
        "the same for it");
  t.key("tries", s.tries, CountCodec{1, 1'000'000}, optional,
        "places that are tried for a body at each visit; where something is in the way at all of them it "
        "waits");
  t.key("seed", s.seed, seed_number, optional, "of the random numbers");
}

void describe(Table& t, SinkSpec& s) {
  t.locate(s.place);
  default_to_all(s.group);
  t.key("name", s.name, NameCodec{}, default_is("`\"sink-1\"`, `\"sink-2\"`, ..."), "name of the sink");
  t.key("group", s.group, group_name, optional, "which particles it may take out");
  describe_visits(t, s.visits);
  describe_region(t, s.region, {"box", "sphere", "cylinder", "plane", "half_space", "mesh"});
  t.key("takes", s.outside, ChoiceCodec<bool>{{"inside", "outside"}, {false, true}}, optional,
        "particles whose centres are inside of the region, or outside of it");
}

}  // namespace vbond::keys

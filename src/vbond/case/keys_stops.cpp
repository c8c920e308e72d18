#include "vbond/case/keys.hpp"

namespace vbond::keys {

void describe(Table& t, DistanceStopSpec& s) {
  t.locate(s.place);
  t.key("between", s.between, tuple_of<2>(particle_number), required, "numbers of the two particles");
  t.check(s.between[0] != s.between[1], {"between"}, "must be two different particles", "change one number");
  const std::size_t side = t.exactly_one({"below", "above"}, s.below ? 0 : 1);
  t.when(side == 0, "below",
         [&] { t.key("below", s.value, positive(length), required, "stop at this or less"); });
  t.when(side == 1, "above",
         [&] { t.key("above", s.value, positive(length), required, "stop at this or more"); });
  s.below = side == 0;
}

void describe(Table& t, RestStopSpec& s) {
  t.locate(s.place);
  t.key("kinetic_energy_below", s.kinetic_energy_below, positive(energy), required,
        "the kinetic energy must stay below this");
  t.key(
      "during", s.during, TimeCodec{}, required,
      "for this time: longer than half the slowest period, since a swing has no kinetic energy at its turns");
}

void describe(Table& t, BreakStopSpec& s) {
  t.locate(s.place);
  t.key("count", s.count, CountCodec{1, INT64_C(1'000'000'000)}, required,
        "how many bonds must have broken since the stage began");
}

void describe(Table& t, PeakStopSpec& s) {
  t.locate(s.place);
  default_to_all(s.group);
  t.key("quantity", s.quantity,
        ChoiceCodec<PeakQuantity>{
            {"compressive-force", "reaction", "wall-force"},
            {PeakQuantity::compressive_force, PeakQuantity::reaction, PeakQuantity::wall_force}},
        optional,
        "mean compression of the bonds in the group, its total support force, or the force of particles on a "
        "wall");
  t.when(s.quantity != PeakQuantity::wall_force, "quantity = \"compressive-force\" or \"reaction\"",
         [&] { t.key("group", s.group, group_name, optional, "of which particles"); });
  t.when(s.quantity == PeakQuantity::wall_force, "quantity = \"wall-force\"",
         [&] { t.key("wall", s.wall, ReferenceCodec{"wall"}, required, "which wall, moving or not"); });
  t.when(s.quantity != PeakQuantity::compressive_force, "quantity = \"reaction\" or \"wall-force\"", [&] {
    t.key("direction", s.direction, direction_vector, optional,
          "component of the force; the force on a wall that presses points against its motion");
  });
  t.key("drop", s.drop, NumberCodec{pure, {0, 1, true, true}}, optional,
        "part of the peak that must be lost");
  t.key("above", s.above, not_negative(force), optional,
        "peaks up to this do not count, as that of a first touch");
  t.key("average_over", s.average_over, TimeCodec{}, required,
        "the quantity is averaged over blocks of this time");
}

}  // namespace vbond::keys

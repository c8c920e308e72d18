#include "vbond/case/keys.hpp"

namespace vbond::keys {

void describe(Table& t, CellSpec& c) {
  t.locate(c.place);
  t.key("from_specimen", c.from_specimen, specimen_name, default_is("none"),
        "the cell is the periodic box of the LAMMPS data file of this specimen, turned and moved with it");
  const bool of_file = c.from_specimen || t.is_given("from_specimen");
  t.when(!of_file, "no from_specimen, whose box gives edges and corner", [&] {
    t.key("a", c.edges[0], vector_of(length), required, "the first edge of the cell");
    t.key("b", c.edges[1], vector_of(length), required, "the second one");
    t.key("c", c.edges[2], vector_of(length), required,
          "the third one; a, b and c are a right-handed system");
    t.key("corner", c.corner, vector_of(length), optional,
          "where the edges begin: particles of specimens are brought into the cell from there");
  });
  t.key("open", c.open, SubsetCodec<3>{{"a", "b", "c"}}, optional,
        "edges along which nothing repeats; each is along x, y or z and normal to those along which the body "
        "does, and gives areas and volumes only");
  t.check(!(c.open[0] && c.open[1] && c.open[2]), {"open"}, "a cell repeats along one edge at least",
          "leave one of a, b and c out, or the table [cell]");
  t.key("rotation", c.triangular, ChoiceCodec<bool>{{"symmetric", "triangular"}, {false, true}}, optional,
        "how the cell is kept from turning: its deformation gradient is symmetric, or upper triangular, by "
        "which "
        "a stays along x and b in the plane of x and y");
}

void describe(Table& t, CellComponentSpec& c, std::optional<StageKind> kind) {
  t.locate(c.place);
  const bool motion = !kind || !is_static(*kind), rest = !kind || is_static(*kind);
  t.when(motion, "kind = \"dynamics\"", [&] {
    t.key(
        "rate", c.rate, number(frequency), default_is("none"),
        "rate of this component of the deformation gradient, of which the edges at the start are the first");
  });
  t.when(rest, "kind = \"equilibrium\", \"path\", \"buckling\" or \"fracture\"", [&] {
    t.key(
        "strain", c.strain, number(pure), default_is("none"),
        "change of this component of the deformation gradient, from what the stage finds, at load factor 1");
  });
  t.key("stress", c.stress, number(stress), default_is("none"),
        "Cauchy's stress that the component gives way to, tension > 0; at rest at load factor 1");
  const bool strained = c.rate.has_value() || c.strain.has_value();
  t.check(!(strained && c.stress), {"stress", "rate", "strain"},
          "a component is given by its strain or by its stress, not by both", "keep one of them");
  t.check(strained || c.stress, {"rate", "strain", "stress"}, "nothing moves this component",
          "give it a stress, or a rate or strain; one that is to stay as it is needs no table");
  t.when(motion, "kind = \"dynamics\"", [&] { describe(t, c.factor); });
}

void describe(Table& t, CellServo& s) {
  t.key("modulus", s.modulus, positive(stress), required,
        "at least the stiffness of the body while its particles follow the cell: a strain rate is the stress "
        "that "
        "is missing over modulus times time");
  t.key("time", s.time, positive(duration), required,
        "in which the stress comes near what is asked for; longer than the body's slowest wave takes through "
        "the "
        "cell");
  t.key("fastest", s.fastest, positive(frequency), required, "the largest strain rate");
}

void describe_drive(Table& t, CellDriveSpec& d, std::optional<StageKind> kind) {
  for (std::size_t k = 0; k < 6; ++k)
    t.table(
        cell_component_names[k], optional, "of the cell: how this component moves; without it, it stays",
        [&d, k, kind](Table& c) {
          describe(c, d.component[k] ? *d.component[k] : d.component[k].emplace(), kind);
        },
        d.component[k].has_value());
  const auto moves = [](const auto& c) { return c.has_value(); };
  t.check(std::any_of(d.component.begin(), d.component.end(), moves), {"xx", "servo"},
          "nothing moves the cell", "write for example xx = { stress = 0.0 }, or leave the table out");
  t.when(!kind || !is_static(*kind), "kind = \"dynamics\"", [&] {
    t.table("servo", d.servo, "how fast the cell gives way to stresses that are asked for");
    const auto asks = [](const auto& c) { return c && c->stress; };
    t.check(d.servo || std::none_of(d.component.begin(), d.component.end(), asks), {"servo"},
            "a component that gives way to a stress needs to know how fast",
            "write for example servo = { modulus = 1.0, time = 10.0, fastest = 0.01 }");
  });
}

}  // namespace vbond::keys

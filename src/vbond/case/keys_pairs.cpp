#include <string>
#include <variant>
#include <vector>

#include "vbond/case/keys.hpp"

/// Which pairs a set bonds, and when.
namespace vbond::keys {
namespace {

void describe_faces(Table& t, BondSpec& b) {
  t.key("neighbours", b.faces.only, ChoiceCodec<bool>{{"all", "voronoi"}, {false, true}}, optional,
        "of the pairs within distance, gap or gap_factor: all, or those alone whose Voronoi cells share a "
        "face; "
        "cells are those of all particles, radical ones by their radii");
  t.when(b.faces.only, "neighbours = \"voronoi\"", [&] {
    t.key("least_face", b.faces.least, not_negative(pure), optional,
          "least area of the face that two cells share, over the square of the distance of the centres");
  });
  t.check(
      !b.faces.only || (b.reach() && b.when != BondTime::approach), {"neighbours", "when"},
      "neighbours = \"voronoi\" chooses among pairs within distance, gap or gap_factor, before the run or as "
      "stages begin",
      "give gap_factor, for example 1.6, in place of another selection; for bonds made on approach leave "
      "neighbours out");
}

void describe_share(Table& t, BondShare& share) {
  t.key(
      "share", share.part, NumberCodec{pure, {0, 1, true, false}}, optional,
      "part of the selected pairs that is bonded; which of them, a number of each pair says, in every stage "
      "the same");
  t.when(share.part < 1.0, "share < 1",
         [&] { t.key("seed", share.seed, seed_number, optional, "of the choice of pairs"); });
}

void describe_time(Table& t, BondSpec& b) {
  t.key("when", b.when,
        ChoiceCodec<BondTime>{{"start", "stage", "approach"},
                              {BondTime::start, BondTime::stage, BondTime::approach}},
        optional,
        "made before the run, as stages begin, or during the run as soon as two particles are near enough");
  t.when(b.when != BondTime::start, "when = \"stage\" or \"approach\"", [&] {
    t.key("stages", b.stages, list_of(stage_name), default_is("approach: all stages"), "in which stages");
    t.check(b.when != BondTime::stage || !b.stages.empty(), {"stages", "when"},
            "when = \"stage\" needs the names of the stages", "add stages = [\"...\"]");
  });
}

}  // namespace

void describe_selection(Table& t, BondSpec& b) {
  describe_time(t, b);

  const std::vector<std::string> selections{"distance", "pairs",      "file",        "from_specimen",
                                            "gap",      "gap_factor", "crossing_gap"};
  const std::size_t selection = t.exactly_one(selections, b.select.value.index());
  t.alternatives(b.select.value, selection, selections);
  t.locate(b.select.place);
  if (selection < selections.size()) t.locate(b.select.place, selections[selection]);
  t.check(b.when != BondTime::approach || b.reach(),
          {"when", "distance", "pairs", "file", "from_specimen", "gap", "gap_factor", "crossing_gap"},
          "bonds made on approach are selected by distance, gap or gap_factor",
          "give distance, gap or gap_factor instead of the other selection");
  describe_faces(t, b);
  describe_share(t, b.share);
}

void check_crossings(Table& t, const BondSpec& b) {
  if (!std::holds_alternative<AtCrossings>(b.select.value)) return;
  t.check(
      b.recipe.attachment != Attachment::neck, {"attach", "crossing_gap"},
      "attach = \"neck\" is for spheres, and crossings are of fibres",
      "bond their axes (attach = \"centres\") or their surfaces (\"surfaces\", where these do not touch)");
  t.check(!b.recipe.capsule, {"capsule_radius", "crossing_gap"}, "a bond at a crossing is no fibre itself",
          "leave capsule_radius out");
  t.check(b.recipe.expansion == 0.0, {"expansion", "crossing_gap"}, "bonds at crossings do not expand",
          "leave expansion out: the fibres themselves may expand");
}

void describe(Table& t, WithinDistance& s) {
  t.key("distance", s.distance, positive(length), required,
        "all pairs whose centres are at most this far apart, but for 1e-9 of it");
}

void describe(Table& t, WithinGap& s) {
  t.key(
      "gap", s.gap, not_negative(length), required,
      "all pairs whose surfaces, as spheres, are at most this far apart: distance of centres - R_i - R_j <= "
      "gap, but for 1e-9 of the radii");
}

void describe(Table& t, WithinFactor& s) {
  t.key("gap_factor", s.factor, positive(pure), required,
        "all pairs whose centres are at most so many times R_i + R_j apart, but for 1e-9 of the radii");
}

void describe(Table& t, AtCrossings& s) {
  t.key("crossing_gap", s.gap, not_negative(length), required,
        "where two fibres are nearest to each other, if their surfaces are at most this far apart: bonded at "
        "their axes (or surfaces, which must not touch) there, also between particles. Fibres are bonds of "
        "sets "
        "before this one with capsule_radius; if there are none, those from specimens");
}

void describe(Table& t, ListedPairs& s) {
  t.key("pairs", s.pairs, list_of(tuple_of<2>(particle_number), 1), required,
        "these pairs of particle numbers");
  bool apart = true;
  for (const auto& p : s.pairs) apart = apart && p[0] != p[1];
  t.check(apart, {"pairs"}, "a particle cannot be bonded to itself",
          "give two different numbers in each pair");
}

void describe(Table& t, PairsFile& s) {
  t.key("file", s.file, FileCodec{}, required,
        "CSV file with header i,j and a pair of particle numbers per line, counted from 0 when specimens are "
        "cut and copied");
}

void describe(Table& t, SpecimenPairs& s) {
  bool yes = true;
  t.key("from_specimen", yes, FlagCodec{}, required,
        "true: the bonds that specimens bring along: those of LAMMPS data files and of the bonds_file of CSV "
        "specimens, and the edges of kinds cylinder, cone and sphere");
  t.check(yes, {"from_specimen"}, "can only be true", "leave it out and select by distance, pairs or file");
  t.key("bond_type", s.bond_type, CountCodec{1}, default_is("bonds of all types"),
        "only those of this bond type of the file");
}

}  // namespace vbond::keys

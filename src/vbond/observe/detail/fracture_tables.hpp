#pragma once
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "vbond/model/field_table.hpp"
#include "vbond/model/state.hpp"
#include "vbond/statics/fracture_under_way.hpp"

/// FractureUnderWay as it lies in a checkpoint: columns of numbers.
namespace vbond {

struct FiledNumber {
  double value = 0;
};
struct FiledCount {
  std::int32_t value = 0;
};
struct FiledWord {
  std::int64_t value = 0;
};
struct FiledPlace {
  Vec3d value;
};
struct FiledTurn {
  Quatd value;
};
struct FiledBreak {
  std::array<double, 30> numbers{};
};
struct FiledPart {
  ParticleId particle;
  std::uint8_t dof = 0, floats = 0;
  bool grip = false, turned = false;
  std::array<double, 18> axes{};
};
struct FiledPair {
  ParticleId i, j;
};
struct FiledFound {
  std::int64_t points = 0, iterations = 0, factors = 0, released_parts = 0;
  std::int64_t avalanches = 0, largest_avalanche = 0;
  double peak_load = 0, peak_load_factor = 0;
  double initial = 0, work = 0, stored = 0, dissipated = 0, released = 0, largest = 0;
};
struct FiledFactor {
  double load_factor = 0;
  std::int64_t breaks = 0, proofs = 0;
  double spent = 0, in_cycle = 0, slow = 0, wasted = 0, recent = 0;
};

struct FiledFracture {
  FractureUnderWay::Numbers numbers;
  FiledFound found;
  FiledFactor factor;
  std::vector<FiledBreak> breaks;
  std::vector<FiledNumber> residuals, rate;
  std::vector<FiledPart> held;
  std::vector<FiledTurn> turned, turns_of_grips;
  std::vector<FiledPair> pattern, factor_pattern;
  PerBond<BondHistory> remembered, of_tangent;
  PerParticle<Vec3d> factor_r;
  PerParticle<Quatd> factor_q;
  std::vector<FiledPlace> factor_cell;
  std::vector<FiledCount> change_sizes, change_unknowns;
  std::vector<FiledNumber> change_numbers, change_least;
  std::vector<FiledWord> random_as_made, random;
};

namespace filed {
inline constexpr FieldTraits any{.filed = Filed::where_any};
using N = FractureUnderWay::Numbers;
using F = FiledFracture;
}  // namespace filed

inline constexpr auto under_way_table = std::tuple{
    fields_of(
        "/fracture/", &filed::F::numbers,
        field("load_factor", &filed::N::load_factor, unit::none,
              "of the balance; all of /fracture only within a stage of that kind"),
        field("dissipated_before", &filed::N::dissipated_before, unit::energy, "by bonds, before the stage"),
        field("largest_reaction", &filed::N::largest_reaction, unit::none, "of any support so far"),
        field("avalanche_factor", &filed::N::avalanche_factor, unit::none,
              "load factor of the avalanche under way"),
        field("in_avalanche", &filed::N::in_avalanche, unit::none, "breaks in it"),
        field("has_before", &filed::N::has_before, unit::none,
              "1: there is a balance before this one, from which the next step is guessed"),
        field("before_factor", &filed::N::before_factor, unit::none, "its load factor"),
        field("before_use", &filed::N::before_use, unit::none, "the largest utilisation there"),
        field("on_way", &filed::N::on_way, unit::none, "1: the load factor is on its way"),
        field("way_to", &filed::N::way_to, unit::none, "where to"),
        field("way_limit", &filed::N::way_limit, unit::none, "longest step"),
        field("breaking", &filed::N::breaking, unit::none, "1: it goes down after a break"),
        field("worst_from", &filed::N::worst_from, unit::none,
              "load factors between which most is missing in the books"),
        field("worst_to", &filed::N::worst_to, unit::none, "as worst_from"),
        field("worst_energy", &filed::N::worst_energy, unit::energy, "what is missing there"),
        field("peak_pushes", &filed::N::peak_pushes, unit::none, "1: the largest load so far was negative"),
        field("stable", &filed::N::stable, unit::none, "1: the balance is stable, as far as is known"),
        field("open", &filed::N::open, unit::none, "1: whether it is stable is open"),
        field("flows", &filed::N::flows, unit::none, "1: bonds yield, soften or rub"),
        field("held_at", &filed::N::held_at, unit::none,
              "load factor at which parts that came off were held last, or 0"),
        field("breaks_since", &filed::N::breaks, unit::none, "since then"),
        field("unknowns", &filed::N::unknowns, unit::none, "how many there are"),
        field("cell_stress_at_start", &filed::N::cell_stress_at_start, unit::stress,
              "of components of the cell that give way: xx, yy, zz, yz, zx, xy")),
    fields_of(
        "/fracture/", &filed::F::found, field("points", &FiledFound::points, unit::none, "of balance so far"),
        field("iterations", &FiledFound::iterations, unit::none, "of Newton's method"),
        field("factors", &FiledFound::factors, unit::none, "of the tangent that were made"),
        field("released_parts", &FiledFound::released_parts, unit::none, "that came off, and were held"),
        field("avalanches", &FiledFound::avalanches, unit::none, "so far"),
        field("largest_avalanche", &FiledFound::largest_avalanche, unit::none, "most breaks in one"),
        field("peak_load", &FiledFound::peak_load, unit::none, "as in fracture.csv"),
        field("peak_load_factor", &FiledFound::peak_load_factor, unit::none, "load factor there"),
        field("initial", &FiledFound::initial, unit::energy, "stored when the load factor was 0"),
        field("work", &FiledFound::work, unit::energy, "of loads and supports"),
        field("stored", &FiledFound::stored, unit::energy, "at this balance"),
        field("dissipated", &FiledFound::dissipated, unit::energy, "by bonds that yield or soften"),
        field("released", &FiledFound::released, unit::energy, "by breaks"),
        field("largest", &FiledFound::largest, unit::energy, "of these, the scale of the books")),
    rows_of("/fracture/", &filed::F::breaks, filed::any,
            field("breaks", &FiledBreak::numbers, unit::none,
                  "of each break: point, avalanche, bond, i, j, utilisation, load factor; shares of tension, "
                  "shear, bending, torsion, compression; N, V, M_b, M_t; middle (3), direction (3); load, "
                  "load factor after, load after, energies held, released, work, stored; 1 where the two "
                  "after it are known")),
    rows_of(
        "/fracture/", &filed::F::residuals, filed::any,
        field("residuals", &FiledNumber::value, unit::none, "of the last balance, iteration by iteration")),
    rows_of("/fracture/", &filed::F::rate, filed::any,
            field("rate", &FiledNumber::value, unit::none, "of the unknowns per load factor")),
    rows_of("/fracture/held_", &filed::F::held, filed::any,
            field("particle", &FiledPart::particle, unit::none, "of parts that are held where they are"),
            field("dof", &FiledPart::dof, unit::none, "which degree of freedom is held, from 0"),
            field("floats", &FiledPart::floats, unit::none, "1: since the stage began; 0: it came off"),
            field("grip", &FiledPart::grip, unit::none, "1: of the grip that begins with the particle"),
            field("turned", &FiledPart::turned, unit::none, "1: along axes of its own"),
            field("axes", &FiledPart::axes, unit::none, "those")),
    rows_of("/fracture/", &filed::F::turned, filed::any,
            field("turned_at_start", &FiledTurn::value, unit::none,
                  "orientations, as the stage began, of particles held about one axis")),
    rows_of("/fracture/", &filed::F::turns_of_grips, filed::any,
            field("turns_of_grips", &FiledTurn::value, unit::none,
                  "how rigid groups had turned in the stage, as parts were held last")),
    rows_of("/fracture/pattern_", &filed::F::pattern, filed::any,
            field("i", &FiledPair::i, unit::none, "pairs for which the tangent has room"),
            field("j", &FiledPair::j, unit::none, "the other one")),
    fields_of<FiledFracture>(
        "/fracture/",
        field("remembered_before", &filed::F::remembered, unit::none,
              "what bonds remembered at the balance before; only where they flow", filed::any),
        field("remembered_of_tangent", &filed::F::of_tangent, unit::none,
              "what the tangent was summed up with instead; only where it is that", filed::any)),
    fields_of<FiledFracture>(
        "/fracture/factor_",
        field("r", &filed::F::factor_r, unit::length,
              "positions where the factor was made that is kept; all of factor_ only if there is one",
              filed::any),
        field("q", &filed::F::factor_q, unit::none, "orientations there", filed::any)),
    rows_of("/fracture/factor_pattern_", &filed::F::factor_pattern, filed::any,
            field("i", &FiledPair::i, unit::none, "pairs for which it has room; none: those of the tangent"),
            field("j", &FiledPair::j, unit::none, "the other one")),
    rows_of("/fracture/factor_", &filed::F::factor_cell, filed::any,
            field("cell", &FiledPlace::value, unit::length, "edges of the cell there")),
    fields_of("/fracture/factor_", &filed::F::factor,
              field("load_factor", &FiledFactor::load_factor, unit::none, "there", filed::any),
              field("breaks", &FiledFactor::breaks, unit::none, "of those since parts were held, before it",
                    filed::any),
              field("proofs", &FiledFactor::proofs, unit::none, "of definite tangents by it", filed::any),
              field("spent", &FiledFactor::spent, unit::none, "solutions before the last proof", filed::any),
              field("in_cycle", &FiledFactor::in_cycle, unit::none, "solutions since", filed::any),
              field("slow", &FiledFactor::slow, unit::none,
                    "iterations since the last proof that a new factor would have saved", filed::any),
              field("wasted", &FiledFactor::wasted, unit::none,
                    "of the solutions before it those that a new factor would have saved", filed::any),
              field("recent", &FiledFactor::recent, unit::none, "of those, from proof to proof", filed::any)),
    rows_of("/fracture/factor_", &filed::F::change_sizes, filed::any,
            field("change_sizes", &FiledCount::value, unit::none, "how many unknowns each change has")),
    rows_of("/fracture/factor_", &filed::F::change_unknowns, filed::any,
            field("change_unknowns", &FiledCount::value, unit::none, "those, change by change")),
    rows_of("/fracture/factor_", &filed::F::change_numbers, filed::any,
            field("change_numbers", &FiledNumber::value, unit::none, "the changes, column by column")),
    rows_of("/fracture/factor_", &filed::F::change_least, filed::any,
            field("change_least", &FiledNumber::value, unit::none,
                  "of each change: parts below this part of the largest are left out")),
    rows_of("/fracture/factor_", &filed::F::random_as_made, filed::any,
            field("random_as_made", &FiledWord::value, unit::none,
                  "random numbers (Mersenne Twister) as the factor was made")),
    rows_of("/fracture/factor_", &filed::F::random, filed::any,
            field("random", &FiledWord::value, unit::none, "and as they are")),
};

}  // namespace vbond

#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "vbond/setup/bond_pairs.hpp"

namespace vbond {

struct HashOfPair {
  std::size_t operator()(const Pair& p) const {
    const auto ends = static_cast<std::uint64_t>(p.i.value) << 32 | p.j.value;
    const Image& n = p.image_j;
    return std::hash<std::uint64_t>{}(ends + 0x9E3779B97F4A7C15u *
                                                 static_cast<std::uint64_t>(n.a + 3 * n.b + 9 * n.c));
  }
};

/// Selects the pairs of one bond set: pairs_by_place.cpp, and those that are named in bond_pairs.cpp.
struct PairSelection {
  const Case& c;
  const BondSpec& spec;
  std::uint32_t set;
  const Model& model;
  const State& state;
  Problems& problems;
  SharedCells& shared;
  std::vector<char> in_a, in_b;
  std::unordered_map<Pair, std::uint32_t, HashOfPair> bonded;  ///< by which set
  const PerParticle<char>* some = nullptr;  ///< first particles of pairs that are wanted; null: all
  const char* way_out = "use a number in that range";  ///< where there is no such particle

  bool joins_groups(ParticleId i, ParticleId j) const {
    return (in_a[i.value] && in_b[j.value]) || (in_a[j.value] && in_b[i.value]);
  }
  const SourcePlace& place() const { return spec.select.place.file.empty() ? spec.place : spec.select.place; }

  /// Of crossings also where they are.
  SelectedPairs select() {
    if (const auto* at = std::get_if<AtCrossings>(&spec.select.value)) return crossings(at->gap);
    SelectedPairs selected{std::visit(*this, spec.select.value), {}};
    if (some != nullptr) std::erase_if(selected.pairs, [this](const Pair& p) { return (*some)[p.i] == 0; });
    return selected;
  }
  std::vector<Pair> operator()(const WithinDistance& within);
  std::vector<Pair> operator()(const WithinGap& within);
  std::vector<Pair> operator()(const WithinFactor& within);
  std::vector<Pair> operator()(const AtCrossings& at) { return crossings(at.gap).pairs; }
  std::vector<Pair> operator()(const ListedPairs& listed);
  std::vector<Pair> operator()(const PairsFile& pairs_file);
  std::vector<Pair> operator()(const SpecimenPairs& wanted);

 private:
  /// Bonds of a file that go through the boundary of its box: how many, and the first.
  struct AcrossBoundary {
    std::size_t count = 0;
    ParticleId i, j;
    double length = 0;
  };

  PerBond<Bond> fibres() const;
  SelectedPairs crossings(double gap);
  template <class Within>
  void refuse_no_crossing(double gap, const PerBond<Bond>& bonds, Within within);
  std::vector<Pair> refuse_value(const char* key, double value, const char* rule);
  bool lacks_radii(const char* key);
  std::vector<Pair> near_pairs(const BondReach& reach, const std::string& within, const char* key);
  double apart(const Pair& p) const;
  const char* unit_of_apart() const;
  double mean_radius() const;
  std::vector<Pair> pairs_in_memory(const BondReach& reach, const std::string& within,
                                    const PerParticle<char>* of_some = nullptr) const;
  void refuse_none_brought(std::size_t brought, std::optional<std::int64_t> type,
                           const std::set<std::int64_t>& types);
  void refuse_across_boundary(const AcrossBoundary& b);
  void take(std::int64_t number_i, std::int64_t number_j, const SourcePlace& place, std::vector<Pair>& pairs);
  Image nearest_image(ParticleId i, ParticleId j) const;
  static std::vector<Pair> ordered(std::vector<Pair> pairs);

  static constexpr std::uint32_t new_pair = 0xffffffff;  // no bond set has this number
};

}  // namespace vbond

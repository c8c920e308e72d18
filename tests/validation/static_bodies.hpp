#pragma once
#include <array>
#include <vector>

#include "statics/bodies.hpp"

/// Bodies whose static solutions are validated, and what is asked of them.
namespace vbond::testing {

inline std::vector<ParticleId> everybody(const Specimen& s) {
  return s.model.groups[0].particles;
}

/// A chain of standard bonds through these points, its plane x-y.
inline Specimen chain_through(const std::vector<Vec3d>& r, double EA) {
  Specimen s = particles_at(r, 0.1 * norm(r[1] - r[0]));
  BondRecipe recipe = rod50_bond(EA);
  recipe.n_2 = Vec3d{0, 0, 1};
  for (std::size_t k = 0; k + 1 < r.size(); ++k) bond(s, k, k + 1, recipe);
  return s;
}

/// Lee's frame: a column up from the origin and a beam from its top towards +x, N bonds each, EI = L = 1.
inline Specimen lees_frame(std::size_t N, double EA = 4e4) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= 2 * N; ++k) {
    const double along = static_cast<double>(k) / static_cast<double>(N);
    r.push_back(k <= N ? Vec3d{0, along, 0} : Vec3d{along - 1, 1, 0});
  }
  return chain_through(r, EA);
}

/// Lee's frame on the way down: both ends pinned, P on the beam at a fifth of its length from the corner.
inline StaticStage lees_path(const Specimen& s, std::size_t N) {
  StaticStage stage =
      static_stage(StageKind::path,
                   {fixed(everybody(s), in_plane),
                    fixed({ParticleId{0}, ParticleId{2 * N}}, {true, true, false, false, false, false})},
                   {pushed(N + N / 5, {0, -1, 0})});
  stage.path.first_step = 1.0;
  return stage;
}

/// A portal: two columns on the x axis and the beam between their tops, N bonds each, EI = L = 1. Particles
/// go round from the left foot, 0, by the corners N and 2 N to the right foot, 3 N.
inline Specimen portal(std::size_t N, double EA) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k <= 3 * N; ++k) {
    const double along = static_cast<double>(k) / static_cast<double>(N);
    if (k <= N)
      r.push_back({0, along, 0});
    else if (k <= 2 * N)
      r.push_back({along - 1, 1, 0});
    else
      r.push_back({1, 3 - along, 0});
  }
  return chain_through(r, EA);
}

/// The portal in its plane, feet clamped or pinned, the same force on both corners.
inline StaticStage portal_stage(StageKind kind, const Specimen& s, std::size_t N, bool clamped_feet,
                                const Vec3d& force) {
  return static_stage(kind,
                      {fixed(everybody(s), in_plane), fixed({ParticleId{0}, ParticleId{3 * N}},
                                                            {true, true, false, false, false, clamped_feet})},
                      {pushed(N, force), pushed(2 * N, force)});
}

/// A triangular sheet in the shape of an equilateral triangle, n bonds a side.
struct Plate {
  Specimen specimen;
  std::vector<ParticleId> edge, interior;
  ParticleId centre;  ///< of n divisible by 3
};

/// Bonds along the edge have stiffnesses of their own.
inline Plate triangular_plate(std::size_t n, const BondStiffness<double>& inside,
                              const BondStiffness<double>& along_edge) {
  std::vector<Vec3d> r;
  std::vector<std::array<std::size_t, 2>> at;  // row, place in it
  for (std::size_t row = 0; row <= n; ++row)
    for (std::size_t k = 0; k + row <= n; ++k) {
      r.push_back({static_cast<double>(k) + 0.5 * static_cast<double>(row),
                   0.5 * std::sqrt(3.0) * static_cast<double>(row), 0});
      at.push_back({row, k});
    }
  Plate plate{particles_at(r, 0.4, 1e-6), {}, {}, ParticleId{0}};
  const auto number = [n](std::size_t row, std::size_t k) { return row * (n + 1) - row * (row - 1) / 2 + k; };
  const auto join = [&](std::size_t i, std::size_t j, bool on_edge) {
    BondRecipe recipe;
    recipe.parameters = on_edge ? along_edge : inside;
    recipe.n_2 = Vec3d{0, 0, 1};
    bond(plate.specimen, i, j, recipe);
  };
  for (std::size_t p = 0; p < r.size(); ++p) {
    const auto [row, k] = at[p];
    const bool on_edge = row == 0 || k == 0 || row + k == n;
    (on_edge ? plate.edge : plate.interior).emplace_back(p);
    if (3 * row == n && 3 * k == n) plate.centre = ParticleId{p};
    if (row + k == n) continue;  // the last of its row
    join(p, p + 1, row == 0);
    join(p, number(row + 1, k), k == 0);
    join(p + 1, number(row + 1, k), row + k + 1 == n);
  }
  return plate;
}

/// Edges supported, no movement in the plane.
inline std::vector<Support> supported_edges(const Plate& plate) {
  return {fixed(everybody(plate.specimen), {true, true, false, false, false, true}),
          fixed(plate.edge, {true, true, true, false, false, true})};
}

/// Deflection of the centre under a load q per area: half sqrt(3) q on each particle inside.
inline double centre_deflection(const Plate& plate, double q) {
  const StaticStage stage = static_stage(StageKind::equilibrium, supported_edges(plate),
                                         {{"inside", plate.interior, {0, 0, 0.5 * std::sqrt(3.0) * q}}});
  return run_static_stage(plate.specimen.model, stage, plate.specimen.state, {}).state.r[plate.centre].z;
}

}  // namespace vbond::testing

#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/core/column.hpp"
#include "vbond/core/id_list.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/contact.hpp"
#include "vbond/model/source.hpp"
#include "vbond/physics/top.hpp"
#include "vbond/terms/walls/wall.hpp"

namespace vbond {

enum class UnitSystem : std::uint8_t { reduced, si };

/// A named set of particles, in increasing order.
struct Group {
  std::string name;
  IdList<ParticleId> particles;
};

/// The cell that a body repeats with. Edges of directions that are open give areas and volumes only.
struct CellShape {
  std::array<Vec3d, 3> edges{};  ///< at the start: a right-handed system  [length]
  Periodic periodic{};           ///< along which of them
  Vec3d corner;                  ///< where the edges begin  [length]
  /// What bars rotations of the cell: its deformation gradient F is symmetric, or upper triangular.
  bool triangular = false;

  bool any() const { return periodic[0] || periodic[1] || periodic[2]; }
  friend bool operator==(const CellShape&, const CellShape&) = default;
};

/// What does not change during a run, except between stages. Units: those of the case
/// (reduced: a = m = c_A = 1; SI: m, kg, s).
struct Model {
  UnitSystem units = UnitSystem::reduced;
  double T_0 = 0;               ///< 2 pi sqrt(m / c_A), of the first particle and first bond  [time]
  PerParticle<double> mass;     ///< [mass]
  PerParticle<double> inertia;  ///< moment of inertia; of a top the least of its three  [mass*length^2]
  PerParticle<double> radius;   ///< [length]
  /// Moments and principal axes; empty: they are the same about all axes, for all particles. See make_top().
  PerParticle<PrincipalInertia> principal;
  /// Which specimen of the case made the particle, from 0, for pictures only; empty: all one body.
  PerParticle<std::uint32_t> specimen;
  PerParticle<Vec3d> r_0;     ///< positions at the start; displacements are from here  [length]
  std::vector<Group> groups;  ///< "all" is the first
  ContactModel contact;
  std::vector<ContactMaterial> materials;  ///< empty: one, that of ContactModel
  PerParticle<std::uint32_t> material;     ///< of each particle, in materials; empty: the first for all
  std::vector<Wall> walls;
  CellShape cell;               ///< at the start
  std::vector<Source> sources;  ///< of bodies that come in during the run

  std::size_t particles() const { return mass.size(); }
  std::uint32_t specimen_of(ParticleId p) const { return specimen.empty() ? 0 : specimen[p]; }
  std::uint32_t material_of(ParticleId p) const { return material.empty() ? 0 : material[p]; }
  /// Whether the moments of inertia of a particle differ from each other.
  bool is_top(ParticleId p) const { return !principal.empty() && !all_equal(principal[p].moments); }
  /// The group of that name, or nullptr.
  const Group* find_group(const std::string& name) const {
    for (const Group& g : groups)
      if (g.name == name) return &g;
    return nullptr;
  }
};

/// Whether a particle is of a body that comes in during the run: its place in r_0 is where the first body of
/// its source waits.
inline bool comes_in(const Model& model, ParticleId p) {
  return std::any_of(model.sources.begin(), model.sources.end(),
                     [p](const Source& s) { return s.body_of(p).has_value(); });
}
/// Whether r_0 tells how two particles stood to each other: both are there from the start, or come in with
/// one body.
inline bool stood_together(const Model& model, ParticleId i, ParticleId j) {
  for (const Source& s : model.sources) {
    const auto of_i = s.body_of(i), of_j = s.body_of(j);
    if (of_i || of_j) return of_i == of_j;
  }
  return true;
}

/// The cell of a model, at rest.
inline CellEdges cell_at_start(const Model& model) {
  CellEdges cell;
  if (model.cell.any())
    for (const Vec3d& edge : model.cell.edges) cell.push_back({.along = edge});
  return cell;
}

/// What two particles do when they touch, by their materials.
inline TouchNumbers<double> touch_numbers(const Model& m, ParticleId i, ParticleId j) {
  return touch_numbers(m.contact, m.materials, m.material_of(i), m.material_of(j));
}

/// Equal particles at these positions, in one group "all", without contacts; T_0 is that of a bond with c_A
/// = 1.
inline Model equal_particles(const std::vector<Vec3d>& r, double mass, double inertia, double radius) {
  Model m;
  m.T_0 = 2.0 * std::numbers::pi * std::sqrt(mass);
  m.r_0 = PerParticle<Vec3d>(r);
  m.mass.assign(r.size(), mass);
  m.inertia.assign(r.size(), inertia);
  m.radius.assign(r.size(), radius);
  m.groups = {{"all", IdList<ParticleId>::consecutive(ParticleId{0}, r.size())}};
  return m;
}

/// Gives a particle three moments of inertia. Bounds of time steps, contacts and damping by ratio use the
/// least.
inline void make_top(Model& m, ParticleId p, const PrincipalInertia& inertia) {
  if (m.principal.empty())
    for (const double I : m.inertia) m.principal.push_back({{I, I, I}, {}});
  m.principal[p] = inertia;
  m.inertia[p] = least_of(inertia.moments);
}

}  // namespace vbond

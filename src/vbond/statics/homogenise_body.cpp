// K is the tangent of the free body. Strained: the surface moves by Y = e x, others by u, with K_uu u + K_us
// Y = 0; C = Y^T K Y/V of both together. Loaded: K u = F, where six degrees of freedom are held against
// motions of the body as a whole, and bear nothing, since F is in balance; S = F^T u/V. With the areas of a
// closed surface the mean strain of a surface that moves by e x is e: so what is strained is among the
// motions of that mean strain, of which what is loaded has the least energy.
#include "vbond/statics/homogenise_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/tensor.hpp"
#include "vbond/model/filled_box.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/statics/detail/homogenising.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/one_blas_thread.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {
namespace {

void refuse_without_surface(const Model& model) {
  require_material(!model.cell.any(), "a body with a cell has constants of its cell, and no surface");
}

/// The largest part that hangs together by bonds and contacts, in increasing order.
std::vector<ParticleId> largest_part(const Model& model, const State& state) {
  refuse_without_surface(model);
  const Unknowns unknowns(model.particles(), {}, 1.0);
  const PartImages parts = images_of_parts(model, state, unknowns);
  std::vector<std::size_t> count(parts.loops.size(), 0);
  for (const std::size_t part : parts.part) ++count[part];
  const auto largest = static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin());
  std::vector<ParticleId> of;
  for (const ParticleId p : parts.part.ids())
    if (parts.part[p] == largest) of.push_back(p);
  return of;
}

BoundingBox box_of_part(const Model& model, const State& state, const std::vector<ParticleId>& particles) {
  BoundingBox box;
  for (const ParticleId p : particles) box.add(state.r[p], model.radius[p]);
  return box;
}

/// sum A (x) x.
DenseMatrix area_moment(const State& state, const BodySurface& s) {
  DenseMatrix sum = DenseMatrix::Zero(3, 3);
  for (std::size_t k = 0; k < s.particles.size(); ++k)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        sum(i, j) += component(s.areas[k], i) * component(state.r[s.particles[k]], j);
  return sum;
}
Vec3d mean_place(const State& state, const std::vector<ParticleId>& particles) {
  Vec3d sum;
  for (const ParticleId p : particles) sum += state.r[p];
  return sum / static_cast<double>(particles.size());
}

/// The least change: by B (x - mean), where B (sum of y (x) y) is what is missing. The areas add up to zero.
void close_surface(const State& state, BodySurface& s) {
  const Vec3d mean = mean_place(state, s.particles);
  DenseMatrix spread = DenseMatrix::Zero(3, 3);
  for (const ParticleId p : s.particles) {
    const Vec3d y = state.r[p] - mean;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) spread(i, j) += component(y, i) * component(y, j);
  }
  const DenseEigen e = dense_eigenpairs(spread);
  require_material(e.found && e.values[0] > 1e-9 * e.values[2],
                   "the particles of the surface lie in one plane: they have no volume");
  const DenseMatrix inverse = e.vectors * e.values.cwiseInverse().asDiagonal() * e.vectors.transpose(),
                    B = (s.volume * DenseMatrix::Identity(3, 3) - area_moment(state, s)) * inverse;
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    const Vec3d y = state.r[s.particles[k]] - mean;
    for (int i = 0; i < 3; ++i) component(s.areas[k], i) += B(i, 0) * y.x + B(i, 1) * y.y + B(i, 2) * y.z;
  }
}

void check_closed(const State& state, const BodySurface& s) {
  require_material(s.particles.size() == s.areas.size() && s.volume > 0.0 && s.volume < INFINITY,
                   "a surface has an area for each particle, and a volume > 0");
  require_material(std::is_sorted(s.particles.begin(), s.particles.end()) &&
                       (s.particles.empty() || s.particles.back().value < state.r.size()),
                   "particles of the surface must be those of the body, in increasing order");
  Vec3d sum;
  double size = 0.0, all = 0.0;
  for (std::size_t k = 0; k < s.areas.size(); ++k) {
    sum += s.areas[k], all += norm(s.areas[k]);
    size += norm(s.areas[k]) * norm(state.r[s.particles[k]]);
  }
  constexpr double rounding = 1e-10;
  const DenseMatrix missing = area_moment(state, s) - s.volume * DenseMatrix::Identity(3, 3);
  require_material(
      norm(sum) <= rounding * all && missing.cwiseAbs().maxCoeff() <= rounding * (size + s.volume),
      "areas are not those of a closed surface: their sum must be 0, and that of A (x) x the volume times 1");
}

/// How a unit of each strain moves a place, and what a unit of each stress exerts on an area.
Vec3d strained_place(std::size_t k, const Vec3d& x) {
  SymmetricParts unit{};
  unit[k] = k < 3 ? 1.0 : 0.5;
  return times(cell_tensor(unit, false), x);
}
Vec3d stressed_area(std::size_t k, const Vec3d& area) {
  SymmetricParts unit{};
  unit[k] = 1.0;
  return times(cell_tensor(unit, false), area);
}

/// The unknowns of a body as rows of one with more of them.
std::vector<int> rows_in(const Unknowns& some, const Unknowns& all) {
  std::vector<int> rows;
  for (int k = 0; k < some.size(); ++k) {
    const auto [p, dof] = some.place(k);
    rows.push_back(all.of(p, dof));
  }
  return rows;
}
DenseMatrix some_rows(const DenseMatrix& of_all, const std::vector<int>& rows) {
  DenseMatrix some(Eigen::Index(rows.size()), of_all.cols());
  for (std::size_t k = 0; k < rows.size(); ++k) some.row(Eigen::Index(k)) = of_all.row(rows[k]);
  return some;
}

Constants symmetric_over(const DenseMatrix& H, double volume) {
  Constants C;
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b)
      C[a][b] = 0.5 * (H(Eigen::Index(a), Eigen::Index(b)) + H(Eigen::Index(b), Eigen::Index(a))) / volume;
  return C;
}

/// A finite body as it stands.
class StrainedBody {
 public:
  StrainedBody(const Model& model, const State& state, const BodySurface& surface, const StaticStage& stage)
      : model_(model), state_(state), surface_(surface), stage_(stage), free_(model, stage_, state) {}

  Constants by_displacement() const;
  Constants by_traction(std::string& solver_name) const;

 private:
  DenseMatrix fields(const DenseMatrix& columns, const StaticStage& held, TangentSolver& solver) const;

  const Model& model_;
  const State& state_;
  const BodySurface& surface_;
  const StaticStage stage_;
  const StaticBody free_;
};

/// K^-1 of these columns over all unknowns, held ones at rest.
DenseMatrix StrainedBody::fields(const DenseMatrix& columns, const StaticStage& held,
                                 TangentSolver& solver) const {
  const StaticBody body(model_, held, state_);
  const std::vector<int> rows = rows_in(body.unknowns(), free_.unknowns());
  DenseMatrix x = DenseMatrix::Zero(columns.rows(), 6);
  if (rows.empty()) return x;
  const DenseMatrix found = solved_with_tangent(solver, body, some_rows(columns, rows));
  for (std::size_t k = 0; k < rows.size(); ++k) x.row(rows[k]) = found.row(Eigen::Index(k));
  return x;
}

Constants StrainedBody::by_displacement() const {
  const Vec3d mean = mean_place(state_, surface_.particles);
  DenseMatrix Y = DenseMatrix::Zero(free_.unknowns().size(), 6);
  for (Eigen::Index k = 0; k < 6; ++k)
    for (const ParticleId p : surface_.particles) {
      const Vec3d u = strained_place(std::size_t(k), state_.r[p] - mean);
      for (int dof = 0; dof < 3; ++dof) Y(free_.unknowns().of(p, dof), k) = component(u, dof);
    }
  const SparseMatrix& K = free_.tangent();
  StaticStage held = stage_;
  Support support{"surface", surface_.particles, {}, {}, {}};
  support.held = all_held;
  held.supports.push_back(std::move(support));
  TangentSolver solver(stage_.newton.solver);
  Y -= fields(K * Y, with_floating_held(model_, held, state_, {}), solver);
  return symmetric_over(Y.transpose() * (K * Y), surface_.volume);  // an error of the fields counts squared
}

Constants StrainedBody::by_traction(std::string& solver_name) const {
  DenseMatrix F = DenseMatrix::Zero(free_.unknowns().size(), 6);
  for (Eigen::Index k = 0; k < 6; ++k)
    for (std::size_t s = 0; s < surface_.particles.size(); ++s) {
      const Vec3d f = stressed_area(std::size_t(k), surface_.areas[s]);
      for (int dof = 0; dof < 3; ++dof)
        F(free_.unknowns().of(surface_.particles[s], dof), k) += component(f, dof);
    }
  TangentSolver solver(stage_.newton.solver);
  const DenseMatrix u = fields(F, with_floating_held(model_, stage_, state_, {}), solver),
                    Fu = F.transpose() * u;
  solver_name = solver.name();
  const DenseMatrix S = Fu + Fu.transpose() - u.transpose() * (free_.tangent() * u);
  const DenseEigen e = dense_eigenpairs(0.5 * (S + S.transpose()));
  if (!(e.found && e.values[0] > 0.0))
    throw NoEquilibrium(homogenise_name,
                        "some stress strains the body by nothing: its surface is too few particles",
                        "name more particles of the surface");
  const DenseMatrix C = e.vectors * e.values.cwiseInverse().asDiagonal() * e.vectors.transpose();
  return symmetric_over(C, 1.0 / surface_.volume);
}

}  // namespace

double volume_of_box(const Model& model, const State& state) {
  return volume_of(box_of_part(model, state, largest_part(model, state)));
}

BodySurface surface_of_box(const Model& model, const State& state, std::optional<double> volume) {
  const std::vector<ParticleId> part = largest_part(model, state);
  const BoundingBox box = box_of_part(model, state, part);
  const Vec3d size = box.high - box.low;
  const std::optional<std::string> why = why_box_not_filled(model, state, box, part);
  require_material(!why, why.value_or("") +
                             ". Take off what sticks out, or name the particles of the surface as a group, "
                             "and give the volume");
  PerParticle<Vec3d> areas(model.particles());
  PerParticle<char> outer(model.particles(), 0);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const std::vector<ParticleId> face = face_of_box(model, state, box, part, axis, side);
      const double area = component(size, (axis + 1) % 3) * component(size, (axis + 2) % 3);
      for (const ParticleId p : face)
        component(areas[p], axis) += side * area / static_cast<double>(face.size()), outer[p] = 1;
    }
  BodySurface s;
  s.volume = volume.value_or(volume_of(box));
  for (const ParticleId p : part)
    if (outer[p] != 0) s.particles.push_back(p), s.areas.push_back(areas[p]);
  const DenseMatrix found = area_moment(state, s);
  for (int axis = 0; axis < 3; ++axis) {  // layers of particles are nearer to each other than the faces
    require_material(found(axis, axis) > 0.0, "all particles lie in one plane: they have no volume");
    for (Vec3d& A : s.areas) component(A, axis) *= s.volume / found(axis, axis);
  }
  close_surface(state, s);
  return s;
}

BodySurface surface_of(const Model& model, const State& state, const std::vector<ParticleId>& particles,
                       double volume) {
  const std::vector<ParticleId> part = largest_part(model, state);
  BodySurface s;
  s.volume = volume;
  std::set_intersection(part.begin(), part.end(), particles.begin(), particles.end(),
                        std::back_inserter(s.particles));
  require_material(s.particles.size() >= 4,
                   "the surface has fewer than four particles of the largest part of the body");
  s.areas.resize(s.particles.size());
  close_surface(state, s);
  return s;
}

HomogenisedBody homogenise_body(const Model& model, const State& given, const BodySurface& surface,
                                const NewtonSettings& newton) {
  refuse_without_surface(model);
  refuse_what_is_no_material(model, given);
  const StaticStage stage = stage_of_homogenising(newton);
  const OneBlasThread alone;
  const StaticStage held = with_floating_held(model, stage, given, {});
  refuse_free_bodies(model, held, given);
  State state = given;
  const bool moved = !StaticBody(model, held, given).rests_to_rounding();
  if (moved) state = run_static_stage(model, held, given, {}).state;
  refuse_kinks(model, state);
  BodySurface s = surface;
  if (moved) close_surface(state, s);
  check_closed(state, s);
  const std::vector<ParticleId> part = largest_part(model, state);
  require_material(std::includes(part.begin(), part.end(), s.particles.begin(), s.particles.end()),
                   "particles of the surface are not of the largest part of the body");
  HomogenisedBody found;
  try {
    const StrainedBody specimen(model, state, s, stage);
    found.by_displacement = specimen.by_displacement();
    found.by_traction = specimen.by_traction(found.solver);
  } catch (...) {  // memory has run out, or a solver does not converge
    throw current_failure(stage);
  }
  found.volume = s.volume;
  for (const ParticleId p : part) found.density += model.mass[p] / s.volume;
  found.particles = model.particles();
  found.bonds = unbroken_bonds(state);
  found.surface = s.particles.size();
  found.floating = model.particles() - part.size();
  found.moved = moved;
  for (const Constants* C : {&found.by_displacement, &found.by_traction})
    for (const auto& row : *C)
      for (const double x : row)
        if (!std::isfinite(x))
          throw NoEquilibrium(homogenise_name, "constants are not finite", "look at the bonds");
  return found;
}

}  // namespace vbond

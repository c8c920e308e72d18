// The energy of bonds to images depends on particles u and on the generalised strains E = (e, k), which move
// the images: their second derivatives K_uE and K_EE are sums over those bonds of their blocks times the
// motion g of the image. With u in balance (K_EE - K_Eu K_uu^-1 K_uE)/area is left.
#include "vbond/statics/homogenise_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/core/images.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/statics/detail/homogenising.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/one_blas_thread.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {
namespace {

/// Which axes of the world a sheet has: its two, and the normal.
struct SheetAxes {
  std::array<int, 3> axis{};
  double area = 0;
};

SheetAxes axes_of_sheet(const Model& model, const State& state) {
  const auto& periodic = model.cell.periodic;
  require_material(model.cell.any() && std::count(periodic.begin(), periodic.end(), true) == 2,
                   "a sheet has a cell that is periodic in two directions and open in the third");
  const std::size_t open = std::size_t(std::find(periodic.begin(), periodic.end(), false) - periodic.begin());
  const Vec3d normal = cross(state.cell[(open + 1) % 3].along, state.cell[(open + 2) % 3].along);
  for (int n = 0; n < 3; ++n)
    if (std::abs(component(normal, n)) >= (1.0 - 1e-12) * norm(normal))
      return {{(n + 1) % 3, (n + 2) % 3, n}, norm(normal)};
  require_material(
      false, fmt::format("the normal of the sheet is along ({:.6g}, {:.6g}, {:.6g}), and constants count "
                         "along axes: turn the sheet so that it lies in the plane of two of them",
                         normal.x, normal.y, normal.z));
  return {};
}

/// A force N along a bond of length a adds some N a to what bending costs, c_B and c_T: it must be far less
/// than these, but for what rounding of places makes of it.
bool bears_no_force(const State& s, BondId k) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const Bond& b = s.bonds[k];
  const BondStiffness<double> c = b.law->stiffness(b);
  const double rounding =
      64.0 * epsilon * (c.c_A * b.a * (b.a + norm(s.r[b.i]) + norm(s.r[b.j])) + angular_scale(b));
  return norm(bond_loads(s, k).F) * b.a <= 1e-8 * std::min(c.c_B, c.c_T) + rounding;
}

void refuse_strained(const Model& model, const State& s) {
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    require_material(
        b.broken || (is_at_rest(s, k) && bears_no_force(s, k) && history_of_bond(s, k) == no_history),
        fmt::format("bond {} (particles {}, {}) is strained or has flowed, and a sheet is looked "
                    "at whose bonds are at rest: take prestrain out",
                    k.value, b.i.value, b.j.value));
  }
  for_touching_pairs(model, s, [](ParticleId i, ParticleId j, const Image&, double) {
    require_material(false, fmt::format("particles {} and {} touch and press: bond all that touch, or leave "
                                        "[contact] out",
                                        i.value, j.value));
  });
}

/// How an image moves, that is L away from the particle at x, with a unit of each of e and k.
using ImageMotion = Eigen::Matrix<double, 6, 6>;  // shift and turn times the length scale
ImageMotion motion_of_image(const std::array<int, 3>& axis, const Vec3d& x, const Vec3d& L, double length) {
  const double x1 = component(x, axis[0]), x2 = component(x, axis[1]), z = component(x, axis[2]),
               L1 = component(L, axis[0]), L2 = component(L, axis[1]);
  ImageMotion g = ImageMotion::Zero();
  for (int k = 0; k < 3; ++k) {
    const double t11 = k == 0 ? 1.0 : 0.0, t22 = k == 1 ? 1.0 : 0.0, t12 = k == 2 ? 0.5 : 0.0,
                 a = t11 * L1 + t12 * L2, b = t12 * L1 + t22 * L2;  // the tensor times L
    g(axis[0], k) = a, g(axis[1], k) = b;
    g(axis[0], 3 + k) = z * a, g(axis[1], 3 + k) = z * b;
    g(axis[2], 3 + k) = -(x1 * a + x2 * b) - 0.5 * (L1 * a + L2 * b);
    g(3 + axis[0], 3 + k) = -b * length, g(3 + axis[1], 3 + k) = a * length;
  }
  return g;
}

}  // namespace

HomogenisedSheet homogenise_sheet(const Model& model, const State& state, const NewtonSettings& newton) {
  const SheetAxes sheet = axes_of_sheet(model, state);
  refuse_what_is_no_material(model, state);
  const OneBlasThread alone;
  const Model here = about_cell_of(model, state);
  StaticStage stage = stage_of_homogenising(newton);
  refuse_free_bodies(here, stage, state);
  refuse_kinks(here, state);
  refuse_strained(here, state);
  stage = with_floating_held(here, stage, state, {});
  HomogenisedSheet found;
  found.area = sheet.area;
  const PartImages parts = images_of_parts(here, state, Unknowns(here.particles(), {}, 1.0));
  found.parts = static_cast<std::size_t>(std::count_if(parts.loops.begin(), parts.loops.end(),
                                                       [](const auto& loops) { return !loops.empty(); }));
  require_material(found.parts > 0, "no particle hangs together with an image of it: there is no sheet");
  Vec3d centre;
  double mass = 0.0;
  for (const ParticleId p : state.r.ids()) {
    const bool floats = parts.loops[parts.part[p]].empty();
    found.floating += floats ? 1 : 0;
    found.density += model.mass[p] / sheet.area;
    if (!floats) centre += model.mass[p] * state.r[p], mass += model.mass[p];
  }
  centre = centre / mass;
  try {
    const StaticBody body(here, stage, state);
    const Unknowns& unknowns = body.unknowns();
    DenseMatrix K_uE = DenseMatrix::Zero(unknowns.size(), 6), K_EE = DenseMatrix::Zero(6, 6);
    const SparseMatrix& K = body.tangent();
    body.for_image_blocks([&](ParticleId i, ParticleId j, const Image& n, const Assembly::Block& of_pair) {
      const ImageMotion g =
          motion_of_image(sheet.axis, state.r[j] - centre, to_image(state.cell, n), unknowns.length());
      const Eigen::Matrix<double, 12, 6> loads = of_pair.rightCols<6>() * g;
      K_EE += g.transpose() * loads.bottomRows<6>();
      for (int dof = 0; dof < 6; ++dof) {
        if (const int k = unknowns.of(i, dof); k != Unknowns::held) K_uE.row(k) += loads.row(dof);
        if (const int k = unknowns.of(j, dof); k != Unknowns::held) K_uE.row(k) += loads.row(6 + dof);
      }
    });
    TangentSolver solver(newton.solver);
    DenseMatrix C = K_EE;
    if (unknowns.size() > 0) {
      const DenseMatrix X = solved_with_tangent(solver, body, K_uE), coupled = K_uE.transpose() * X;
      C += X.transpose() * (K * X) - coupled - coupled.transpose();  // an error of X counts squared
    }
    found.solver = solver.name();
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const auto of = [&C, &sheet](std::size_t row, std::size_t column) {
          return 0.5 *
                 (C(Eigen::Index(row), Eigen::Index(column)) + C(Eigen::Index(column), Eigen::Index(row))) /
                 sheet.area;
        };
        found.A[a][b] = of(a, b), found.B[a][b] = of(a, 3 + b), found.D[a][b] = of(3 + a, 3 + b);
        if (!std::isfinite(found.A[a][b] + found.B[a][b] + found.D[a][b]))
          throw NoEquilibrium(homogenise_name, "constants are not finite", "look at the bonds");
      }
  } catch (...) {  // memory has run out, or a solver does not converge
    throw current_failure(stage);
  }
  for (std::size_t k = 0; k < 3; ++k) component(found.axes[k], sheet.axis[k]) = 1.0;
  found.plane = component(centre, sheet.axis[2]);
  found.particles = model.particles();
  found.bonds = unbroken_bonds(state);
  return found;
}

}  // namespace vbond

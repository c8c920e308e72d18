#include "vbond/model/periodic_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vbond/core/images.hpp"
#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/stress.hpp"

namespace vbond {
namespace {

/// Sum over the edges of x_k (x) the edge k of the reciprocal system: what turns edge k into x_k.
Tensor from_edges(const std::array<Vec3d, 3>& x, const std::array<Vec3d, 3>& edge) {
  const double V = dot(edge[0], cross(edge[1], edge[2]));
  Tensor t = dyad(x[0], cross(edge[1], edge[2]) / V);
  t += dyad(x[1], cross(edge[2], edge[0]) / V);
  t += dyad(x[2], cross(edge[0], edge[1]) / V);
  return t;
}

std::array<Vec3d, 3> edges_of(const CellEdges& cell) {
  return {cell[0].along, cell[1].along, cell[2].along};
}

bool is_along(const Vec3d& edge, int axis) {
  return norm(edge) == std::abs(component(edge, axis));
}

}  // namespace

Tensor cell_tensor(const std::array<double, 6>& x, bool triangular) {
  const auto lower = [triangular](double y) { return triangular ? 0.0 : y; };
  return {{Vec3d{x[0], x[5], x[4]}, Vec3d{lower(x[5]), x[1], x[3]}, Vec3d{lower(x[4]), lower(x[3]), x[2]}}};
}

std::array<double, 6> cell_components(const Tensor& t) {
  return {t.row[0].x, t.row[1].y, t.row[2].z, t.row[1].z, t.row[0].z, t.row[0].y};
}

Tensor cell_gradient(const CellShape& shape, const CellEdges& cell) {
  return from_edges(edges_of(cell), shape.edges);
}

Tensor cell_velocity_gradient(const CellEdges& cell) {
  return from_edges({cell[0].rate, cell[1].rate, cell[2].rate}, edges_of(cell));
}

double kinetic_energy_beside_flow(const Model& model, const State& state) {
  double energy = kinetic_energy(model, state);
  if (state.cell.empty()) return energy;
  const Tensor L = cell_velocity_gradient(state.cell);
  for (const ParticleId p : model.mass.ids()) {
    if (is_absent(state, p)) continue;
    const Vec3d flow = times(L, state.r[p]);
    energy += model.mass[p] * dot(flow, 0.5 * flow - state.v[p]);
  }
  return energy;
}

Tensor cell_stress(const Model& model, const BodyPart& body) {
  const State& s = body.state;
  Tensor sum;
  for (const Tensor& t : stress_between_particles(model, body)) sum += transposed(t);
  if (s.v.empty()) return (1.0 / volume(s.cell)) * body.summed(sum);
  const Tensor L = cell_velocity_gradient(s.cell);
  Vec3d momentum;
  double mass = 0.0;
  for (const ParticleId p : s.v.ids()) {
    if (!body.has(p) || is_absent(s, p)) continue;
    const Vec3d own = s.v[p] - times(L, s.r[p]), carried = model.mass[p] * own;
    sum += dyad(-carried, own);
    momentum += carried;
    mass += model.mass[p];
  }
  momentum = body.summed(momentum);
  body.all.sum({&mass, 1});
  sum = body.summed(sum);
  if (mass > 0.0) sum += dyad(momentum / mass, momentum);  // a drift through the cell is no stress
  return (1.0 / volume(s.cell)) * sum;
}

std::vector<std::string> stresses_not_reached(const CellDrive& drive, const State& s, double time) {
  std::vector<std::string> sentences;
  if (!drive.any_stress()) return sentences;
  const double V = volume(s.cell);
  SymmetricParts now = symmetric_part({{s.cell[0].virial / V, s.cell[1].virial / V, s.cell[2].virial / V}});
  double largest = 1e-4 * drive.servo.modulus;  // less is no strain to speak of
  for (const double stress : now) largest = std::max(largest, std::abs(stress));
  for (const CellComponent& c : drive.component)
    if (c.by == CellComponent::By::stress) largest = std::max(largest, std::abs(c.value * c.factor(time)));
  for (std::size_t k = 0; k < 6; ++k) {
    const CellComponent& c = drive.component[k];
    if (c.by != CellComponent::By::stress) continue;
    const double wanted = c.value * c.factor(time);
    if (std::abs(now[k] - wanted) > 0.01 * largest)
      sentences.push_back(fmt::format("cell.{} has the stress {:.4g}, and {:.4g} was asked for",
                                      cell_component_names[k], now[k], wanted));
  }
  return sentences;
}

namespace {

/// A bound of what unit changes of these components of F give rise to in all of them, where bonds resist
/// stretching and shear by these coefficients, and particles follow the cell and do not turn.
template <class Coefficients>
double affine_bound(const CellShape& shape, const State& s, const std::array<bool, 6>& counts,
                    Coefficients&& coefficients) {
  using Components = std::array<double, 6>;
  std::array<Components, 6> sum{};  // second derivatives of the energy with components of F
  for (const Bond& b : s.bonds) {
    if (b.broken) continue;
    const BondStiffness<double> c = coefficients(b);
    const Vec3d r = between(s, b), d = normalised(r);
    std::array<Vec3d, 6> u;
    for (std::size_t k = 0; k < 6; ++k) {
      Components unit{};
      unit[k] = 1.0;
      u[k] = times(cell_tensor(unit, shape.triangular), r);
    }
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t l = 0; l < 6; ++l) {
        const double along = dot(u[k], d) * dot(u[l], d);
        sum[k][l] += c.c_A * along + c.c_D * (dot(u[k], u[l]) - along);
      }
  }
  double most = 0.0;
  for (std::size_t k = 0; k < 6; ++k) {
    double row = 0.0;
    for (std::size_t l = 0; l < 6; ++l)
      if (counts[k] && counts[l]) row += std::abs(sum[k][l]);
    const double times_counted = k >= 3 && !shape.triangular ? 2.0 : 1.0;  // F_xy and F_yx
    most = std::max(most, row / (times_counted * volume(s.cell)));
  }
  return most;
}

}  // namespace

double affine_modulus(const CellShape& shape, const State& s) {
  return affine_bound(shape, s, {true, true, true, true, true, true},
                      [](const Bond& b) { return b.law->stiffness(b); });
}

double affine_viscosity(const CellShape& shape, const State& s, const CellDrive& drive) {
  std::array<bool, 6> counts{};
  for (std::size_t k = 0; k < 6; ++k) counts[k] = drive.component[k].by == CellComponent::By::stress;
  return affine_bound(shape, s, counts, [](const Bond& b) {
    return is_damped(b) ? b.law->damping(b) : BondStiffness<double>{};
  });
}

std::array<bool, 3> open_axes(const CellShape& shape) {
  std::array<bool, 3> open{};
  for (std::size_t k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis)
      if (!shape.periodic[k] && is_along(shape.edges[k], axis)) open[static_cast<std::size_t>(axis)] = true;
  return open;
}

namespace {

bool is_along(const Vec3d& x, const Vec3d& axis) {
  return norm(cross(x, axis)) <= 1e-12 * norm(x);
}

}  // namespace

bool repeats_with_cell(const WallShape& shape, const CellShape& cell) {
  const auto* plane = std::get_if<PlaneWall>(&shape);
  const auto* cylinder = std::get_if<CylinderWall>(&shape);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d& edge = cell.edges[k];
    if (!cell.periodic[k]) continue;
    const bool same_on_plane = plane != nullptr && std::abs(dot(plane->normal, edge)) <= 1e-12 * norm(edge);
    const bool same_on_cylinder =
        cylinder != nullptr && std::isinf(cylinder->length) && is_along(edge, cylinder->axis);
    if (!same_on_plane && !same_on_cylinder) return false;
  }
  return true;
}

bool may_turn_in_cell(const WallShape& shape, const WallDrive& drive) {
  const auto* cylinder = std::get_if<CylinderWall>(&shape);
  return drive.angular_velocity == Vec3d{} ||
         (cylinder != nullptr && is_along(drive.angular_velocity, cylinder->axis) && !drive.pivot);
}

std::vector<std::string> mistakes_in_cell(const Model& model) {
  Mistakes found(model);
  const CellShape& cell = model.cell;
  if (!cell.any()) return {};
  const auto name = [](std::size_t k) { return std::string(1, static_cast<char>('a' + k)); };
  for (std::size_t k = 0; k < 3; ++k) found.require_finite(cell.edges[k], "the cell", name(k).c_str());
  found.require_finite(cell.corner, "the cell", "the corner");
  const double V = dot(cell.edges[0], cross(cell.edges[1], cell.edges[2]));
  const double largest = norm(cell.edges[0]) * norm(cell.edges[1]) * norm(cell.edges[2]);
  found.require(
      V > 1e-6 * largest,
      fmt::format("the edges of the cell span the volume {}: they must be a right-handed system, not "
                  "of one plane",
                  V));
  const std::array<bool, 3> open = open_axes(cell);
  for (std::size_t k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis)
      found.require(
          !cell.periodic[k] || !open[static_cast<std::size_t>(axis)] || component(cell.edges[k], axis) == 0.0,
          "edge " + name(k) + " of the cell is not normal to an open direction");
  const auto count = [](const std::array<bool, 3>& x) { return x[0] + x[1] + x[2]; };
  found.require(count(open) + count(cell.periodic) == 3,
                "an open edge of the cell must be along an axis of the world");
  for (const Wall& w : model.walls)
    found.require(repeats_with_cell(w.shape, cell),
                  "wall \"" + w.name + "\" does not go on through the faces of the cell");
  return std::move(found).take();
}

std::vector<std::string> mistakes_in_cell(const Model& model, const State& s) {
  Mistakes found(model);
  found.require(s.cell.size() == (model.cell.any() ? 3u : 0u),
                fmt::format("the state has {} edges of a cell: three where the model has a cell, else none",
                            s.cell.size()));
  if (s.cell.size() == 3) {
    for (const CellEdge& e : s.cell) {
      found.require_finite(e.along, "the state", "an edge of the cell");
      found.require_finite(e.rate, "the state", "the rate of an edge of the cell");
    }
    found.require(volume(s.cell) > 0.0, fmt::format("the cell has the volume {}", volume(s.cell)));
  }
  const auto is_there = [&](const Image& n) {
    return (n.a == 0 || model.cell.periodic[0]) && (n.b == 0 || model.cell.periodic[1]) &&
           (n.c == 0 || model.cell.periodic[2]);
  };
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (!is_there(image_of_j(b))) {
      found.require(false,
                    fmt::format("bonds[{}] joins an image along an edge that is not periodic", k.value));
      break;
    }
  }
  for (const PairMemory& m : s.contact_history)
    if (!is_there(m.image_j)) {
      found.require(false, "contacts name an image along an edge that is not periodic");
      break;
    }
  for (const FibreMemory& m : s.fibre_history)
    if (!is_there(m.image_a_j) || !is_there(m.image_b_i) || !is_there(m.image_b_j)) {
      found.require(false, "contacts of capsules name an image along an edge that is not periodic");
      break;
    }
  return std::move(found).take();
}

std::vector<std::string> mistakes_in_drive(const Model& model, const CellDrive& drive, bool at_rest) {
  Mistakes found(model);
  if (!drive.any()) return {};
  found.require(model.cell.any(), "a stage moves the cell, and the model has none");
  const std::array<bool, 3> open = open_axes(model.cell);
  for (std::size_t k = 0; k < 6; ++k) {
    const CellComponent& c = drive.component[k];
    if (c.by == CellComponent::By::held) continue;
    const std::string who = fmt::format("component {} of the cell", cell_component_names[k]);
    found.require(std::isfinite(c.value), fmt::format("{}: its value is {}", who, c.value));
    for (const int axis : cell_component_axes[k])
      if (open[static_cast<std::size_t>(axis)]) {
        found.require(false, who + " is along an open direction");
        break;
      }
    found.require(!at_rest || c.factor.points.empty(),
                  who + " has a factor over time: a stage at rest has none");
    for (const TimeFunction::Point& p : c.factor.points)
      found.require(std::isfinite(p.t) && std::isfinite(p.factor),
                    fmt::format("the factor of {} has the point ({}, {})", who, p.t, p.factor));
  }
  if (at_rest || !drive.any_stress()) return std::move(found).take();
  const CellServo& s = drive.servo;
  for (const auto& [what, value] :
       {std::pair{"modulus", s.modulus}, {"time", s.time}, {"fastest", s.fastest}})
    found.require(above_zero(value),
                  fmt::format("the servo of the cell has {} = {}: it must be > 0", what, value));
  return std::move(found).take();
}

}  // namespace vbond

#include "vbond/dynamics/cell_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vbond/core/images.hpp"

namespace vbond {
namespace {

bool moves(const CellEdges& cell) {
  return std::any_of(cell.begin(), cell.end(), [](const CellEdge& e) { return !(e.rate == Vec3d{}); });
}

void sum_over_parts(std::array<Vec3d, 3>& rows, const Exchange& exchange) {
  std::array<double, 9> numbers{};
  for (std::size_t k = 0; k < 9; ++k) numbers[k] = component(rows[k / 3], static_cast<int>(k % 3));
  exchange.sum(numbers);
  for (std::size_t k = 0; k < 9; ++k) component(rows[k / 3], static_cast<int>(k % 3)) = numbers[k];
}

}  // namespace

CellMotion::CellMotion(const Model& model, const Stage& stage, Bodies& bodies, CellEdges& cell,
                       const Exchange& exchange)
    : model_(model),
      stage_(stage),
      bodies_(bodies),
      cell_(cell),
      exchange_(exchange),
      any_(stage.cell.any() || moves(cell)) {
  if (any_) L_start_ = L_end_ = cell_velocity_gradient(cell);
}

/// Of the components of F. Times are those of the middle of the step, stresses those of its start.
std::array<double, 6> CellMotion::rates(double time) const {
  std::array<double, 6> rates{};
  const SymmetricParts stress = symmetric_part((1.0 / volume(cell_)) * kept());
  for (std::size_t k = 0; k < 6; ++k) {
    const CellComponent& c = stage_.cell.component[k];
    const double wanted = c.value * c.factor(time);
    if (c.by == CellComponent::By::strain) rates[k] = wanted;
    if (c.by != CellComponent::By::stress) continue;
    const CellServo& servo = stage_.cell.servo;
    rates[k] = std::clamp((wanted - stress[k]) / (servo.modulus * servo.time), -servo.fastest, servo.fastest);
  }
  return rates;
}

void CellMotion::add_flow(const Tensor& flow, const Team& team) {
  team.for_blocks([&](const Block& b) {
    for (std::size_t k = b.rows.first; k < std::min(b.rows.last, bodies_.order.own); ++k)
      bodies_.motion[k].v += times(flow, bodies_.pose[k].r);
  });
}

void CellMotion::stop(const Team& team) {
  add_flow(-1.0 * L_end_, team);
  for (CellEdge& e : cell_) e = {.along = e.along};
  L_start_ = L_end_ = {};
  any_ = false;
}

void CellMotion::begin_step(std::int64_t step, const Team& team) {
  const Tensor rate =
      cell_tensor(rates((static_cast<double>(step) + 0.5) * stage_.dt), model_.cell.triangular);
  const CellEdges before = cell_;
  for (std::size_t k = 0; k < 3; ++k) damping_before_[k] = cell_[k].damping;
  bool changed = false;
  for (std::size_t k = 0; k < 3; ++k) {
    cell_[k].rate = times(rate, model_.cell.edges[k]);
    changed |= !(cell_[k].rate == before[k].rate);
  }
  L_start_ = cell_velocity_gradient(cell_);
  if (changed) {
    CellEdges change = before;  // dH/dt' - dH/dt
    for (std::size_t k = 0; k < 3; ++k) change[k].rate = cell_[k].rate - before[k].rate;
    add_flow(cell_velocity_gradient(change), team);
  }
  for (CellEdge& e : cell_) e.along += stage_.dt * e.rate;
  L_end_ = cell_velocity_gradient(cell_);
}

std::optional<std::string> CellMotion::fault() const {
  constexpr double least = 1e-3, most = 0.3;
  const double part = volume(cell_) / volume(cell_at_start(model_));
  if (!(part > least && std::isfinite(part)))
    return fmt::format("its volume is {:.3g} of that at the start: less than {} is no cell", part, least);
  double rate = 0.0;
  for (const Vec3d& row : L_start_.row) rate = std::max(rate, norm(row));
  if (!(rate * stage_.dt < most))
    return fmt::format("it strains by {:.3g} in a step: no more than {} can be followed", rate * stage_.dt,
                       most);
  return std::nullopt;
}

CellMotion::Virial CellMotion::virial(const Team& team, const Tensor& L) const {
  struct Sums {
    Tensor virial;
    Vec3d momentum;  // beside the cell
    double mass = 0;
  };
  std::vector<Sums> of_block(team.blocks());
  const LargeArray<LoadRow>& local =
      bodies_.local_damping.empty() && stage_.local_damping > 0.0 ? bodies_.damping : bodies_.local_damping;
  team.for_blocks([&](const Block& b) {
    Sums& sum = of_block[b.index];
    for (std::size_t k = b.rows.first; k < std::min(b.rows.last, bodies_.order.own); ++k) {
      const Vec3d& r = bodies_.pose[k].r;
      const Vec3d F = local.empty() ? bodies_.load[k].F : bodies_.load[k].F - local[k].F;
      const Vec3d own = bodies_.motion[k].v - times(L, r);
      const Vec3d momentum = bodies_.mass[k] * own;
      sum.virial += dyad(F, r);
      sum.virial += dyad(momentum, own);
      sum.momentum += momentum;
      sum.mass += bodies_.mass[k];
    }
  });
  Tensor sum;
  Vec3d momentum;
  double mass = 0.0;
  for (const Sums& s : of_block) sum += s.virial, momentum += s.momentum, mass += s.mass;
  for (std::size_t k = 0; k < 3; ++k) sum += dyad(forces_[k], cell_[k].along);  // of images, beyond particles
  std::array<double, 13> all{};
  for (std::size_t k = 0; k < 9; ++k) all[k] = component(sum.row[k / 3], static_cast<int>(k % 3));
  std::copy_n(&momentum.x, 3, all.begin() + 9);
  all[12] = mass;
  exchange_.sum(all);
  for (std::size_t k = 0; k < 9; ++k) component(sum.row[k / 3], static_cast<int>(k % 3)) = all[k];
  momentum = {all[9], all[10], all[11]};
  const Tensor drift = all[12] > 0.0 ? dyad(momentum / all[12], momentum) : Tensor{};
  Tensor stress = -1.0 * sum;
  stress += drift;
  return {stress, drift};
}

/// V sigma = -(sum of F (x) r over particles and images) - the sum of m (c - C) (x) (c - C).
void CellMotion::keep(const Virial& now) {
  for (std::size_t k = 0; k < 3; ++k) cell_[k].virial = now.stress.row[k];
  drift_ = now.drift;
}
Tensor CellMotion::kept() const {
  return {{cell_[0].virial, cell_[1].virial, cell_[2].virial}};
}

void CellMotion::look(const Team& team) {
  keep(virial(team, L_end_));
}

void CellMotion::take_damping(OfEdges edges_times_force) {
  sum_over_parts(edges_times_force, exchange_);
  for (std::size_t k = 0; k < 3; ++k) cell_[k].damping = edges_times_force[k];
}

CellMotion::Done CellMotion::end_step(const Team& team) {
  Done done;
  for (std::size_t k = 0; k < 3; ++k)
    done.damping -= 0.5 * stage_.dt * dot(damping_before_[k] + cell_[k].damping, cell_[k].rate);
  const double before = double_dot(kept(), L_start_) - double_dot(drift_, L_start_);
  keep(virial(team, L_end_));
  done.work = 0.5 * stage_.dt * (before + double_dot(kept(), L_end_) - double_dot(drift_, L_end_));
  return done;
}

void CellMotion::take_out(const Tensor& virial) {
  for (std::size_t k = 0; k < 3; ++k) cell_[k].virial += virial.row[k];
}

void CellMotion::take_out(const Vec3d& r_ij, const Image& image_j, const Vec3d& F, const Vec3d& damping) {
  take_out(-1.0 * dyad(F, r_ij));                   // F at r_i and -F at r_j
  cell_[0].damping += double(image_j.a) * damping;  // the image had the opposite force
  cell_[1].damping += double(image_j.b) * damping;
  cell_[2].damping += double(image_j.c) * damping;
}

}  // namespace vbond

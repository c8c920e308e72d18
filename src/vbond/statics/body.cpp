#include "vbond/statics/detail/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "vbond/model/bond_sums.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/statics/detail/pulse.hpp"

namespace vbond {
namespace {

/// The mean distance of bonded particles; without bonds the mean radius; 1 if that is 0 as well.
double length_scale(const Model& model, const State& s) {
  double sum = 0.0, bonds = 0.0;
  for (const Bond& b : s.bonds)
    if (!b.broken) sum += norm(between(s, b)), bonds += 1.0;
  if (sum > 0.0) return sum / bonds;
  sum = std::accumulate(model.radius.begin(), model.radius.end(), 0.0);
  return sum > 0.0 ? sum / static_cast<double>(model.particles()) : 1.0;
}

using Block = Assembly::Block;

Block block_of(const PairTangent<3>& t) {
  Eigen::Matrix3d d;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) d(a, b) = t.d[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
  Block K = Block::Zero();
  K.block<3, 3>(0, 0) = K.block<3, 3>(6, 6) = d;
  K.block<3, 3>(0, 6) = K.block<3, 3>(6, 0) = -d;
  return K;
}

bool has_finite_place(const State& s, ParticleId p) {
  const Quatd& q = s.q[p];
  return is_finite(s.r[p]) && std::isfinite(q.w + q.x + q.y + q.z);
}

/// What a bond's turning is measured by: the distance of the centres, or of the bonded points where the
/// centres lie closer together.
double span(const Bond& b, const State& s) {
  return std::max(norm(between(s, b)), norm(bonded_points(b, bond_pose(b, s))));
}

/// Components of the cell that give way to stresses. They count by a length of the cell such that the
/// tangent's entries are of the size that those of particles have, however large the cell: V C/length^2 of a
/// body with the modulus C beside C L.
Unknowns::Cell free_cell(const Model& model, const StaticStage& stage, double length) {
  Unknowns::Cell cell;
  if (!stage.cell.any_stress()) return cell;
  for (std::size_t k = 0; k < 6; ++k) cell.free[k] = stage.cell.component[k].by == CellComponent::By::stress;
  const auto& [a, b, c] = model.cell.edges;
  cell.length = std::sqrt(dot(a, cross(b, c)) / length);
  return cell;
}

PairTangent<3> touch(const Model& m, const State& s, ParticleId i, ParticleId j, const Image& n) {
  return contact_tangent(touch_forms(m.contact), touch_numbers(m, i, j), between(s, i, j, n), m.radius[i],
                         m.radius[j]);
}

}  // namespace

Block block_of(const PairTangent<9>& t, double length) {
  Block K;
  const auto d = [&t](int row, int column) {
    return t.d[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  };
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int group = 0; group < 3; ++group) {  // F, M_ij, M_ji
        const int row = group == 0 ? a : group == 1 ? 3 + a : 9 + a;
        const int from = 3 * group + a;
        K(row, b) = d(from, b);
        K(row, 3 + b) = -d(from, 3 + b);
        K(row, 6 + b) = -d(from, b);
        K(row, 9 + b) = -d(from, 6 + b);
      }
  K.middleRows<3>(6) = -K.topRows<3>();  // the force on j
  for (const int turns : {3, 9}) {
    K.middleRows<3>(turns) /= length;
    K.middleCols<3>(turns) /= length;
  }
  return K;
}

namespace {

/// The antisymmetric part of how the force of a bond that has cracked goes with the distance: friction
/// follows the pressure, and not the other way round. That of a bond that does not slip is rounding.
double skew_of_friction(const Bond& b, const PairTangent<9>& t) {
  constexpr double rounding = 1e-12;
  double largest = 0.0;
  for (std::size_t k = 0; k < 3; ++k)
    largest = larger(largest, 0.5 * std::abs(t.d[k][(k + 1) % 3] - t.d[(k + 1) % 3][k]));
  return largest > rounding * b.law->stiffness(b).c_A ? largest : 0.0;
}

}  // namespace

double distance(const Placement& a, const Placement& b, double length) {
  double largest = 0.0;
  const bool cell_moved = a.cell != b.cell;
  for (std::size_t k = 0; cell_moved && k < 3; ++k)
    largest = larger(largest, length * norm(b.cell[k].along - a.cell[k].along) / norm(a.cell[k].along));
  const auto carried = [&](const Vec3d& r) {
    if (!cell_moved) return r;
    const Vec3d s = in_edges(a.cell, r - a.r.values().front());
    return b.r.values().front() + s.x * b.cell[0].along + s.y * b.cell[1].along + s.z * b.cell[2].along;
  };
  for (const ParticleId p : a.r.ids())
    for (const double moved :
         {norm(b.r[p] - carried(a.r[p])), length * norm(rotation_vector(b.q[p] * conjugate(a.q[p])))})
      largest = larger(largest, moved);
  return largest;
}

StaticBody::StaticBody(const Model& model, const StaticStage& stage, State state, double load_factor)
    : model_(model),
      stage_(stage),
      state_(std::move(state)),
      load_factor_(load_factor),
      held_at_(load_factor),
      holds_(holds_of(stage.supports)),
      unknowns_(model.particles(), stage.supports, length_scale(model, state_),
                free_cell(model, stage, length_scale(model, state_))),
      terms_(*this, state_),
      bonded_(model.particles(), false),
      held_rate_(model.particles()),
      stiffness_{Assembly(unknowns_), Assembly(unknowns_), {}, {}, 0.0, false} {
  begin_anew(state_, Anew::at_rest);
  for (CellEdge& e : state_.cell) e = {.along = e.along};
  for (PairMemory& m : state_.contact_history) m.history = {};  // nothing is rubbed at rest
  std::erase_if(state_.contact_history, [](const PairMemory& m) { return m.kept == 0.0; });
  take_hold();
  take_hold_of_cell();
  look_at_grips();
  set_held_rates();
  for (RestTerm* t : terms_.all()) t->take_hold();
  // positions are rounded to eps |r|, unit vectors to eps
  constexpr double eps = std::numeric_limits<double>::epsilon();
  for (const Bond& b : state_.bonds) {
    if (b.broken) continue;
    bonded_[b.i] = bonded_[b.j] = true;
    const double B = angular_scale(b), c_A = b.law->stiffness(b).c_A;
    rounding_of_force_ =
        std::max(rounding_of_force_, eps * (c_A * (norm(state_.r[b.i]) + b.a) + B / unknowns_.length()));
    rounding_of_potential_ += eps * B;
  }
  note_rounding_of_cell();
  const auto any = [this](auto is) {
    return std::any_of(state_.bonds.begin(), state_.bonds.end(),
                       [is](const Bond& b) { return !b.broken && is(b); });
  };
  if (any([](const Bond& b) { return b.law->remembers(); })) state_.bond_history.resize(state_.bonds.size());
  flows_ = any(yields_or_softens);
  if (flows_) accept();
}

void StaticBody::accept() {
  for (RestTerm* t : terms_.all()) t->accept();
  if (!flows()) return;
  accepted_before_ = accepted_.empty() ? state_.bond_history : accepted_;
  accepted_ = state_.bond_history;
  accepted_at_ = placement();
  at_accepted_ = true;
}

void StaticBody::placed() {
  Pulse::place(load_factor_);
  ++placement_number_;
  loaded_.reset();
  for (RestTerm* t : terms_.all()) t->follow();
  if (!grips_.empty()) look_at_grips(), set_held_rates();
  stiffness_.current = false;
  if (!flows()) return;
  at_accepted_ = state_.r == accepted_at_.r && state_.q == accepted_at_.q &&
                 state_.cell == accepted_at_.cell &&
                 (!terms_.heat.changes_bonds() || load_factor_ == accepted_at_.load_factor);
  flow();
}

/// What bonds remember here, after the way from the last accepted balance, taken as straight. It takes no
/// time, so that nothing creeps; bonds that creep do not soften, which alone asks for the rates.
void StaticBody::flow() {
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    if (b.broken || !b.law->remembers()) continue;
    const auto turned = [&](ParticleId p) {
      return rotation_vector(state_.q[p] * conjugate(accepted_at_.q[p]));
    };
    const Vec3d before = between(accepted_at_.r, accepted_at_.cell, b);
    const BondRates<double> way{between(state_, b) - before, turned(b.i), turned(b.j)};
    state_.bond_history[k] =
        at_accepted_ ? accepted_[k]
                     : b.law->advance(b, bond_pose(b, state_), way, creeps(b) ? 0.0 : 1.0, accepted_[k]);
  }
}

const BondHistory& StaticBody::history_before(BondId k) const {
  if (!flows()) return history_of_bond(state_, k);
  return at_accepted_ ? accepted_before_[k] : accepted_[k];
}

double StaticBody::dissipated() const {
  return state_.bond_history.empty() ? 0.0 : dissipated_by_flow(state_);
}

void StaticBody::restore(const Placement& p) {
  state_.r = p.r;
  state_.q = p.q;
  state_.cell = p.cell;
  load_factor_ = p.load_factor;
  placed();
}

Movement StaticBody::movement(ParticleId p, const Vector& x, double load_factor_change) const {
  Movement m = unknowns_.movement(p, x);
  m.shift += load_factor_change * held_rate_[p].shift;
  m.turn += load_factor_change * held_rate_[p].turn;
  return m;
}

void StaticBody::move(const Vector& x, double new_load_factor) {
  const double change = new_load_factor - load_factor_;
  for (const ParticleId p : state_.r.ids()) {
    const Movement m = movement(p, x, change);
    state_.r[p] += m.shift;
    state_.q[p] = normalised(rotation_of((1.0 / unknowns_.length()) * m.turn) * state_.q[p]);
  }
  if (moves_cell()) carry_cell(x, new_load_factor);
  load_factor_ = new_load_factor;
  carry();
  carry_free(x, change);
  placed();
}

void StaticBody::relieve() {
  relief_.resize(0);
  placed();
  if (load_factor_ == 1.0) return;
  relief_ = unbalanced() / (1.0 - load_factor_);
  placed();
}

Vector StaticBody::on_unknowns(const Loads& loads) const {
  Vector x = Vector::Zero(unknowns_.size());
  for (const ParticleId p : loads.F.ids())
    unknowns_.add_load(p, {loads.F[p], loads.M[p] / unknowns_.length()}, x);
  return x;
}

const StaticBody::Loaded& StaticBody::loads_at_hand() const {
  if (loaded_) return *loaded_;
  const std::size_t n = model_.particles();
  Loaded l;
  l.loads = {PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)};
  add_applied(load_factor_, l.loads);
  l.largest = max_norm(on_unknowns(l.loads));
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    const BondLoads<double> f = bond_loads(state_, k);
    l.loads.F[b.i] += f.F, l.loads.F[b.j] -= f.F;
    l.loads.M[b.i] += f.M_ij, l.loads.M[b.j] += f.M_ji;
    if (!b.image_j.is_itself()) add_image(b.image_j, f.F, l);
    for (const double force :
         {norm(f.F), norm(f.M_ij) / unknowns_.length(), norm(f.M_ji) / unknowns_.length()})
      l.largest = larger(l.largest, force);
  }
  for_touching_pairs(model_, state_, [&](ParticleId i, ParticleId j, const Image& of_j, double) {
    const Vec3d F = touch(model_, state_, i, j, of_j).loads.F;
    l.loads.F[i] += F, l.loads.F[j] -= F;
    if (!of_j.is_itself()) add_image(of_j, F, l);
    l.largest = larger(l.largest, norm(F));
  });
  for (const RestTerm* t : terms_.all()) t->add_loads(l);
  l.unbalanced = on_unknowns(l.loads);
  if (has_free_cell()) balance_cell(l);
  if (relief_.size() > 0) l.unbalanced -= (1.0 - load_factor_) * relief_;
  loaded_ = std::move(l);
  return *loaded_;
}

void StaticBody::lay_out(const std::vector<Assembly::Pair>& touching) const {
  std::vector<Assembly::Pair> pairs = touching;
  for (const Bond& b : state_.bonds) {
    if (b.broken) continue;
    pairs.push_back({b.i, b.j});
    if (b.image_j.is_itself() || !has_free_cell()) continue;
    for (const ParticleId p : {b.i, b.j}) pairs.push_back({p, unknowns_.cell_node()});
  }
  for (const RestTerm* t : terms_.all()) t->add_pairs(pairs);
  stiffness_.assembly.lay_out(pairs);
  if (flows()) stiffness_.full.lay_out(pairs);
}

/// Adds the symmetric part of a pair's block, and what held degrees of freedom that move do to free ones.
void StaticBody::add_pair(ParticleId i, ParticleId j, const Image& of_j, const Block& in_world) const {
  if (of_j.is_itself() && stiffness_.assembly.move_as_one(i, j)) return;
  Eigen::Matrix<double, 12, 1> rate;
  for (int k = 0; k < 3; ++k) {
    rate[k] = component(held_rate_[i].shift, k), rate[k + 3] = component(held_rate_[i].turn, k);
    rate[k + 6] = component(held_rate_[j].shift, k), rate[k + 9] = component(held_rate_[j].turn, k);
  }
  if (!rate.isZero(0.0)) {
    const Eigen::Matrix<double, 12, 1> pushed = -in_world * rate;
    unknowns_.add_load(i, {{pushed[0], pushed[1], pushed[2]}, {pushed[3], pushed[4], pushed[5]}},
                       stiffness_.load_direction);
    unknowns_.add_load(j, {{pushed[6], pushed[7], pushed[8]}, {pushed[9], pushed[10], pushed[11]}},
                       stiffness_.load_direction);
  }
  const Block K = stiffness_.assembly.in_axes(i, j, in_world);
  stiffness_.assembly.add(i, j, 0.5 * (K + K.transpose()));
  if (flows()) stiffness_.full.add(i, j, K);
  if (!of_j.is_itself() && moves_cell()) add_image(i, j, of_j, in_world);
}

/// What terms change with the load factor goes to the load direction, what it does to a cell that gives way
/// too.
void StaticBody::add_load_rates() const {
  const std::size_t n = model_.particles();
  LoadSum rates;
  rates.loads = {PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)};
  for (const RestTerm* t : terms_.all()) t->add_load_rates(rates);
  stiffness_.load_direction += on_unknowns(rates.loads);
  for (std::size_t c = 0; has_free_cell() && c < 6; ++c) {
    const int row = unknowns_.of_cell(c);
    if (row == Unknowns::held) continue;
    for (std::size_t a = 0; a < 3; ++a)
      stiffness_.load_direction[row] -=
          dot(rates.of_cell.row[a], cell_row_[c].row[a]) / unknowns_.cell_length();
  }
}

const StaticBody::Stiffness& StaticBody::stiffness_at_hand() const {
  if (stiffness_.current) return stiffness_;
  std::vector<Assembly::Pair> touching;
  std::vector<Image> images;  // of their second particles
  for_touching_pairs(model_, state_, [&](ParticleId i, ParticleId j, const Image& n, double) {
    touching.push_back({i, j});
    images.push_back(n);
  });
  std::vector<Assembly::Pair> to_lay_out = touching;
  for (std::size_t k = 0; has_free_cell() && k < touching.size(); ++k)
    if (!images[k].is_itself())
      for (const ParticleId p : {touching[k].first, touching[k].second})
        to_lay_out.push_back({p, unknowns_.cell_node()});
  Assembly& assembly = stiffness_.assembly;
  const auto is_new = [&](const Assembly::Pair& p) { return !assembly.has(p.first, p.second); };
  if (assembly.version() == 0 || std::any_of(to_lay_out.begin(), to_lay_out.end(), is_new))
    lay_out(to_lay_out);

  assembly.clear();
  stiffness_.friction = 0.0;
  if (flows()) stiffness_.full.clear();
  const std::size_t n = model_.particles();
  Loads with_factor{PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)}, constant = with_factor;
  add_applied(1.0, with_factor);
  add_applied(0.0, constant);
  stiffness_.load_direction = on_unknowns(with_factor) - on_unknowns(constant);
  if (relief_.size() > 0) stiffness_.load_direction += relief_;
  if (has_free_cell()) look_at_mixing();
  if (!terms_.all().empty()) add_load_rates();
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    if (b.broken) continue;
    const PairTangent<9> t = b.law->tangent(b, bond_pose(b, state_), history_before(k));
    add_pair(b.i, b.j, b.image_j, block_of(t, unknowns_.length()));
    if (is_cracked(b)) stiffness_.friction = larger(stiffness_.friction, skew_of_friction(b, t));
  }
  for (std::size_t k = 0; k < touching.size(); ++k) {
    const auto& [i, j] = touching[k];
    add_pair(i, j, images[k], block_of(touch(model_, state_, i, j, images[k])));
  }
  if (has_free_cell()) add_own_of_cell();
  for (const RestTerm* t : terms_.all()) t->add_stiffness(stiffness_);
  add_arms();
  add_followers();
  stiffness_.current = true;
  return stiffness_;
}

void StaticBody::for_image_blocks(
    const std::function<void(ParticleId, ParticleId, const Image&, const Block&)>& visit) const {
  const auto of_pair = [&](ParticleId i, ParticleId j, const Image& n, const Block& in_world) {
    const Block K = stiffness_.assembly.in_axes(i, j, in_world);
    visit(i, j, n, 0.5 * (K + K.transpose()));
  };
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    if (b.broken || b.image_j.is_itself()) continue;
    const PairTangent<9> t = b.law->tangent(b, bond_pose(b, state_), history_before(k));
    of_pair(b.i, b.j, b.image_j, block_of(t, unknowns_.length()));
  }
  for_touching_pairs(model_, state_, [&](ParticleId i, ParticleId j, const Image& n, double) {
    if (!n.is_itself()) of_pair(i, j, n, block_of(touch(model_, state_, i, j, n)));
  });
}

double StaticBody::moment_part() const {
  const Loads applied = moments_at_carriers();
  double largest = 0.0;
  for (const ParticleId p : applied.M.ids()) {
    const Vec3d m = outside_moment(p, applied);
    for (int k = 0; k < 3; ++k) {
      const bool both_free = unknowns_.of(p, 3 + (k + 1) % 3) != Unknowns::held &&
                             unknowns_.of(p, 3 + (k + 2) % 3) != Unknowns::held;
      if (both_free) largest = std::max(largest, 0.5 * std::abs(component(m, k)) / sq(unknowns_.length()));
    }
  }
  for_followers([&](int, int, double K) { largest = std::max(largest, std::abs(K)); });
  for (const RestTerm* t : terms_.all()) largest = std::max(largest, t->largest_skew());
  if (flows()) largest = std::max(largest, friction_part());
  if (!has_free_cell()) return largest;
  constexpr double rounding = 1e-14;  // of the tangent: its rows and columns are summed up differently
  const Stiffness& s = stiffness_at_hand();
  const double of_cell = s.skew.norm();
  return of_cell > rounding * max_norm(s.assembly.matrix().diagonal()) ? std::max(largest, of_cell) : largest;
}

SparseMatrix StaticBody::full_tangent() const {
  if (flows()) return stiffness_at_hand().full.matrix();  // moments from outside are what bonds leave
  SparseMatrix K = tangent();
  const Loads applied = moments_at_carriers();
  for (const ParticleId p : applied.M.ids()) {
    const Vec3d m = (0.5 / sq(unknowns_.length())) * outside_moment(p, applied);
    if (m == Vec3d{}) continue;
    const double S[3][3] = {{0, m.z, -m.y}, {-m.z, 0, m.x}, {m.y, -m.x, 0}};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int row = unknowns_.of(p, 3 + a), column = unknowns_.of(p, 3 + b);
        if (a != b && row != Unknowns::held && column != Unknowns::held) K.coeffRef(row, column) += S[a][b];
      }
  }
  const auto add = [&](int row, int column, double x) { K.coeffRef(row, column) += x; };
  for_followers(add);
  for (const RestTerm* t : terms_.all()) t->for_skew(add);
  add_skew_of_cell(K);
  return K;
}

bool StaticBody::places_are_finite() const {
  for (const ParticleId p : state_.r.ids())
    if (!has_finite_place(state_, p)) return false;
  return true;
}

std::string StaticBody::first_not_finite() const {
  if (has_collapsed()) return "the cell collapses or turns over";
  for (const ParticleId p : state_.r.ids())
    if (!has_finite_place(state_, p))
      return fmt::format("particle {}: its place, ({}, {}, {}), or its orientation is not finite", p.value,
                         state_.r[p].x, state_.r[p].y, state_.r[p].z);
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    const BondPose<double> pose = bond_pose(b, state_);
    const BondLoads<double> f = bond_loads(state_, k);
    const BondEnergy<double> U = bond_energy(state_, k);
    const bool finite_loads = is_finite(f.F) && is_finite(f.M_ij) && is_finite(f.M_ji);
    if (finite_loads && std::isfinite(U.U_L + U.U_B + U.U_T)) continue;
    if (has_lost_its_flow(history_of_bond(state_, k)))
      return fmt::format(
          "bond {} (particles {}, {}): its flow does not bring its loads to their limits, which they are far "
          "beyond",
          k.value, b.i.value, b.j.value);
    return fmt::format("bond {} (particles {}, {}): its {} not finite, its bonded points are {:.3g} apart",
                       k.value, b.i.value, b.j.value, finite_loads ? "energy is" : "loads are",
                       norm(bonded_points(b, pose)));
  }
  std::string found;
  for_touching_pairs(model_, state_, [&](ParticleId i, ParticleId j, const Image& n, double overlap) {
    if (found.empty() && !is_finite(touch(model_, state_, i, j, n).loads.F))
      found = fmt::format("contact of particles {} and {}: its force is not finite, at an overlap of {:.3g}",
                          i.value, j.value, overlap);
  });
  if (!found.empty()) return found;
  if (const auto fault = fault_of_terms()) return *fault;
  const Loads& loads = loads_at_hand().loads;
  for (const ParticleId p : loads.F.ids())
    if (!is_finite(loads.F[p]) || !is_finite(loads.M[p]))
      return fmt::format("particle {}: the sum of its loads is not finite", p.value);
  if (!std::isfinite(energies().total())) return "all particles: the sum of their energies is not finite";
  return {};
}

Energies StaticBody::energies() const {
  Energies e = mutual_energies(model_, state_);
  for (const RestTerm* t : terms_.all()) e.contact += t->energy();
  return e;
}

void StaticBody::break_bond(BondId k, BreakMode mode) {
  Bond& broken = state_.bonds[k];
  broken.mode = mode;
  if (broken.law->crack != nullptr) return leave_faces(k);
  broken.broken = true;
  bonded_[broken.i] = bonded_[broken.j] = false;
  for (const Bond& b : state_.bonds)
    if (!b.broken) bonded_[b.i] = bonded_[b.j] = true;
  placed();
}

/// The bond cracks, and its faces rub from this balance on.
void StaticBody::leave_faces(BondId k) {
  const Bond& b = state_.bonds[k];
  const BondHistory cracked = b.law->crack(b, bond_pose(b, state_), state_.bond_history[k]);
  state_.bond_history[k] = cracked;
  if (!std::exchange(flows_, true)) lay_out({});
  accepted_ = state_.bond_history;
  accept();
  placed();
}

double StaticBody::potential_change(const Placement& from, double energy_from) const {
  const Loads applied = applied_loads(load_factor_);
  double change = potential() - energy_from;
  for (const ParticleId p : state_.r.ids()) {
    const Vec3d turn = rotation_vector(state_.q[p] * conjugate(from.q[p]));
    change -= dot(applied.F[p], state_.r[p] - from.r[p]) + dot(applied.M[p], turn);
  }
  for (const RestTerm* t : terms_.all()) change -= t->work(from, placement(), load_factor_);
  if (has_free_cell()) change -= work_on_cell(from);
  return change - work_of_relief(from, placement(), load_factor_);
}

std::optional<std::string> StaticBody::fault_of_terms() const {
  for (const RestTerm* t : terms_.all())
    if (auto fault = t->fault()) return fault;
  return std::nullopt;
}

double StaticBody::largest_change_of_terms(const Vector& x, double load_factor_change) const {
  double largest = 0.0;
  for (const RestTerm* t : terms_.all()) largest = larger(largest, t->largest_change(x, load_factor_change));
  return largest;
}

double StaticBody::largest_bond_change(const Vector& x, double load_factor_change) const {
  const auto moves = [&](ParticleId p) { return movement(p, x, load_factor_change); };
  double largest = 0.0;
  const Tensor cell = moves_cell() ? cell_change(x, load_factor_change) : Tensor{};
  for (const Vec3d& row : cell.row) largest = larger(largest, norm(row));
  for (const Bond& b : state_.bonds) {
    if (b.broken) continue;
    const Movement of_i = moves(b.i), of_j = moves(b.j);
    Vec3d apart = of_j.shift - of_i.shift;
    if (moves_cell() && !b.image_j.is_itself()) apart += times(cell, image_at_start(b.image_j));
    const double stretch = norm(apart) / span(b, state_);
    const double turn = norm(of_j.turn - of_i.turn) / unknowns_.length();
    largest = larger(larger(largest, stretch), turn);
  }
  for (const ParticleId p : bonded_.ids()) {
    if (bonded_[p]) continue;
    const Movement m = moves(p);
    largest = larger(larger(largest, norm(m.shift) / unknowns_.length()), norm(m.turn) / unknowns_.length());
  }
  return largest;
}

}  // namespace vbond

// What bonds, contacts, terms and loads add up to in a body at rest: the residual, and the tangent with the
// parts of it that are not symmetric.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "vbond/model/touching.hpp"
#include "vbond/statics/detail/body.hpp"

namespace vbond {
namespace {

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

/// The antisymmetric part of how the force of a bond that has cracked goes with the distance: friction
/// follows the pressure, and not the other way round. That of a bond that does not slip is rounding.
double skew_of_friction(const Bond& b, const PairTangent<9>& t) {
  constexpr double rounding = 1e-12;
  double largest = 0.0;
  for (std::size_t k = 0; k < 3; ++k)
    largest = larger(largest, 0.5 * std::abs(t.d[k][(k + 1) % 3] - t.d[(k + 1) % 3][k]));
  return largest > rounding * b.law->stiffness(b).c_A ? largest : 0.0;
}

/// The pairs of which a bond or contact of these two fills the blocks: of one with an image, in a cell that
/// gives way, those with the cell as well.
template <class Visit>
void for_pairs_of(const Unknowns& unknowns, ParticleId i, ParticleId j, const Image& of_j,
                  const Visit& visit) {
  visit(Assembly::Pair{i, j});
  if (!of_j.is_itself() && unknowns.has_cell())
    for (const ParticleId p : {i, j}) visit(Assembly::Pair{p, unknowns.cell_node()});
}

}  // namespace

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
  if (std::any_of(grips_.begin(), grips_.end(), [](const Grip& g) { return is_free_grip(*g.support); }))
    l.inside.resize(n);
  add_applied(load_factor_, l.loads);
  l.largest = max_norm(on_unknowns(l.loads));
  add_bonds(l);
  for_touching([&](ParticleId i, ParticleId j, const Image& of_j, double) {
    push(i, j, of_j, touch(model_, state_, i, j, of_j).loads.F, l);
  });
  for (const RestTerm* t : terms_.all()) t->add_loads(l);
  l.unbalanced = on_unknowns(l.loads);
  if (has_free_cell()) balance_cell(l);
  if (relief_.forces.size() > 0) l.unbalanced -= (1.0 - load_factor_) * relief_.forces;
  loaded_ = std::move(l);
  return *loaded_;
}

double StaticBody::residual() const {
  const Loaded& l = loads_at_hand();
  const double unbalanced = max_norm(l.unbalanced);
  if (has_collapsed() || !std::isfinite(l.largest) || !std::isfinite(unbalanced))
    return std::numeric_limits<double>::quiet_NaN();
  return unbalanced == 0.0 ? 0.0 : unbalanced / l.largest;
}

const StaticBody::Stiffness& StaticBody::stiffness_at_hand() const {
  if (stiffness_.current) return stiffness_;
  clear_stiffness();
  begin_load_direction();
  find_places();
  add_bonds_in_lanes(stiffness_);
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    if (b.broken || place_in_tangent_[k].is_there()) continue;
    const PairTangent<9> t = b.law->tangent(b, bond_pose(b, state_), history_before(k));
    add_pair(b.i, b.j, image_of_j(b), block_of(t, unknowns_.length()));
    if (is_cracked(b)) stiffness_.friction = larger(stiffness_.friction, skew_of_friction(b, t));
  }
  for_touching([&](ParticleId i, ParticleId j, const Image& of_j, double) {
    add_pair(i, j, of_j, block_of(touch(model_, state_, i, j, of_j)));
  });
  if (has_free_cell()) add_own_of_cell();
  for (const RestTerm* t : terms_.all()) t->add_stiffness(stiffness_);
  add_arms();
  add_followers();
  stiffness_.current = true;
  return stiffness_;
}

double StaticBody::residual_beside(const DenseMatrix& columns) const {
  const Vector& g = loads_at_hand().unbalanced;
  const double beside = max_norm(g - columns * (columns.transpose() * g)), all = max_norm(g);
  return all == 0.0 ? residual() : residual() * (beside / all);
}

PairTangent<3> touch(const Model& m, const State& s, ParticleId i, ParticleId j, const Image& of_j) {
  return contact_tangent(touch_forms(m.contact), touch_numbers(m, i, j), between(s, i, j, of_j), m.radius[i],
                         m.radius[j]);
}

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

void StaticBody::lay_out() const {
  std::vector<Assembly::Pair> pairs;
  const auto add = [&pairs](const Assembly::Pair& p) { pairs.push_back(p); };
  for (const Bond& b : state_.bonds)
    if (!b.broken) for_pairs_of(unknowns_, b.i, b.j, image_of_j(b), add);
  const auto add_touching = [&](ParticleId i, ParticleId j, const Image& n, double) {
    for_pairs_of(unknowns_, i, j, n, add);
  };
  // a body that has come to touch itself soon touches at more places: room for these saves factors
  if (stiffness_.assembly.version() == 0)
    for_touching(add_touching);
  else
    touching_.for_each_or_about_to(model_, state_, add_touching);
  for (const RestTerm* t : terms_.all()) t->add_pairs(pairs);
  lay_out_for(std::move(pairs));
}

void StaticBody::lay_out_for(std::vector<Assembly::Pair> pairs) const {
  pattern_ = std::move(pairs);
  stiffness_.assembly.lay_out(pattern_);
  if (flows()) stiffness_.full.lay_out(pattern_);
}

/// All zero, with room for what touches now.
void StaticBody::clear_stiffness() const {
  Assembly& assembly = stiffness_.assembly;
  bool has_room = assembly.version() > 0;
  const auto look = [&](const Assembly::Pair& p) { has_room = has_room && assembly.has(p.first, p.second); };
  for_touching(
      [&](ParticleId i, ParticleId j, const Image& n, double) { for_pairs_of(unknowns_, i, j, n, look); });
  if (!has_room) lay_out();
  assembly.clear();
  if (flows()) stiffness_.full.clear();
  stiffness_.friction = 0.0;
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

DenseMatrix StaticBody::tangent_of(BondId k, const std::vector<int>& unknowns) const {
  const Bond& b = state_.bonds[k];
  Block K = Block::Zero();
  if (!b.broken)
    K += block_of(b.law->tangent(b, bond_pose(b, state_), history_before(k)), unknowns_.length());
  bool touches = false;
  for_touching([&](ParticleId i, ParticleId j, const Image& n, double) {
    touches = touches || (i == b.i && j == b.j && n == image_of_j(b)) ||
              (i == b.j && j == b.i && n == -image_of_j(b));
  });
  if (touches) K += block_of(touch(model_, state_, b.i, b.j, image_of_j(b)));
  K = stiffness_.assembly.in_axes(b.i, b.j, K);
  const auto at = [&](int row) {
    const int u = unknowns_.of(unknowns_.carrier(row < 6 ? b.i : b.j), row % 6);
    return u == Unknowns::held ? Eigen::Index{-1}
                               : std::lower_bound(unknowns.begin(), unknowns.end(), u) - unknowns.begin();
  };
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  DenseMatrix among = DenseMatrix::Zero(size, size);
  if (image_of_j(b).is_itself() && stiffness_.assembly.move_as_one(b.i, b.j)) return among;
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 12; ++column)
      if (at(row) >= 0 && at(column) >= 0)
        among(at(row), at(column)) += 0.5 * (K(row, column) + K(column, row));
  return among;
}

/// What grows with the load factor: loads, the relief, which fades, and what terms change. What the latter do
/// to a cell that gives way is part of it.
void StaticBody::begin_load_direction() const {
  const std::size_t n = model_.particles();
  const Loads zero{PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)};
  LoadSum rates;
  Loads with_factor = zero, constant = zero;
  rates.loads = zero;
  add_applied(1.0, with_factor);
  add_applied(0.0, constant);
  stiffness_.load_direction = on_unknowns(with_factor) - on_unknowns(constant);
  if (relief_.forces.size() > 0) stiffness_.load_direction += relief_.forces;
  if (has_free_cell()) look_at_mixing();
  if (terms_.all().empty()) return;
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

void StaticBody::for_image_blocks(
    const std::function<void(ParticleId, ParticleId, const Image&, const Block&)>& visit) const {
  const auto of_pair = [&](ParticleId i, ParticleId j, const Image& n, const Block& in_world) {
    const Block K = stiffness_.assembly.in_axes(i, j, in_world);
    visit(i, j, n, 0.5 * (K + K.transpose()));
  };
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    if (b.broken || image_of_j(b).is_itself()) continue;
    const PairTangent<9> t = b.law->tangent(b, bond_pose(b, state_), history_before(k));
    of_pair(b.i, b.j, image_of_j(b), block_of(t, unknowns_.length()));
  }
  for_touching([&](ParticleId i, ParticleId j, const Image& n, double) {
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

}  // namespace vbond

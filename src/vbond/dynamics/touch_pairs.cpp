#include "vbond/dynamics/touch_pairs.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "vbond/dynamics/slots.hpp"
#include "vbond/physics/touch_mass.hpp"

namespace vbond {

Touching<double> touching_of(const TouchRow& i, const TouchRow& j, const Vec3d& r_ij, const MotionRow& of_i,
                             const MotionRow& of_j) {
  Touching<double> p = round_bodies<double>(r_ij, {i.R, i.per_m, i.per_Theta}, {j.R, j.per_m, j.per_Theta},
                                            of_j.v - of_i.v, of_i.omega, of_j.omega);
  undamp_if_none_is_free(p);
  return p;
}

TouchHistory<double> touch_history(const SlipRow& slip, const MomentRow& rolling) {
  return {slip.F_t, slip.a, slip.F_d, slip.k_r, rolling.M_r, rolling.M_t};
}

PairHistory numbers_of(const TouchHistory<double>& h) {
  return {h.F_t.x, h.F_t.y, h.F_t.z, h.a, h.F_d.x, h.F_d.y, h.F_d.z, h.k_r, h.M_r.x, h.M_r.y, h.M_r.z, h.M_t};
}

bool holds_on(const TouchForms& forms, const TouchNumbers<double>& numbers, double R, double overlap) {
  return forms.adhesion == AdhesionForm::jkr &&
         overlap > -reach_of_adhesion(numbers.stiffness, numbers.work, R);
}

TouchLosses<double> lost_on_parting(const TouchForms& forms, const TouchNumbers<double>& numbers,
                                    const Touching<double>& p, double dt, const TouchHistory<double>& h) {
  const Vec3d v = p.v - cross(p.l_i * p.w_i + p.l_j * p.w_j, p.n), w = p.w_j - p.w_i;
  TouchLosses<double> lost;
  lost.damping = 0.5 * dt * dot(h.F_d, v);
  lost.friction = slip_energy(forms, numbers, h) + 0.5 * dt * dot(h.F_t, v);
  lost.rolling = rolling_energy(forms, h) + 0.5 * dt * (dot(h.M_r, across(w, p.n)) + h.M_t * dot(w, p.n));
  if (forms.adhesion == AdhesionForm::none) return lost;
  const double before = p.overlap + dot(p.v, p.n) * dt;  // the overlap a step ago, when they still held on
  lost.adhesion = normal_energy(forms, numbers, p.R, before) +
                  0.5 * normal_force(forms, numbers, p.R, before).F * (p.overlap - before);
  return lost;
}

TouchPairs::TouchPairs(const Model& model, const ContactMasses& masses, const Order& order,
                       const StepKernel& kernel)
    : order_(order),
      kernel_(kernel),
      forms_(touch_forms(model.contact)),
      keeps_overlap_(model.contact.keeps_overlap),
      start_(order.known + 1, 0),
      old_start_(start_) {
  double R_max = 0.0;
  for (const double R : model.radius) R_max = std::max(R_max, R);
  for (Row k{0}; k.value < order.known; ++k.value) {
    const ParticleId p = order.particle[k];
    row_.push_back({model.radius[p], 1.0 / masses.of(p), 1.0 / model.inertia[p]});
    if (model.materials.size() > 1) material_.push_back(model.material_of(p));
  }
  materials_ = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(model.materials.size()));
  for (std::uint32_t first = 0; first < materials_; ++first)
    for (std::uint32_t second = 0; second < materials_; ++second) {
      numbers_.push_back(touch_numbers(model.contact, model.materials, first, second));
      if (forms_.adhesion == AdhesionForm::jkr)
        reach_ = std::max(reach_, reach_of_adhesion(numbers_.back().stiffness, numbers_.back().work, R_max));
    }
}

TouchRule TouchPairs::rule() const {
  return {forms_, numbers_.data(), materials_, material_.empty() ? nullptr : material_.data(), row_.data()};
}

TouchTable TouchPairs::table(const OfBlock& block) {
  return {.start = start_.data(),
          .second = second_.data(),
          .slip = slip_.data(),
          .rolling = rolling_.data(),
          .kept = keeps_overlap_ ? kept_.data() : nullptr,
          .first_pair = block.first_pair,
          .first_slot = block.first_slot,
          .load = load_.data(),
          .moment = rolls() ? moment_.data() : nullptr,
          .touching = touching_.data()};
}

const TouchNumbers<double>& TouchPairs::numbers(Row i, Row j) const {
  return numbers_[material_.empty() ? 0 : material_[i.value] * materials_ + material_[j.value]];
}

Touching<double> TouchPairs::touching(Row i, Row j, const Bodies& b) const {
  Touching<double> p =
      touching_of(row_[i.value], row_[j.value], b.between(i, j), b.motion[i.value], b.motion[j.value]);
  const std::size_t k = keeps_overlap_ ? place(std::min(i, j), std::max(i, j)) : pairs();
  if (k < pairs()) p.overlap -= still_kept(kept_[k], p.overlap);
  return p;
}

std::size_t TouchPairs::place(Row i, Row j) const {
  if (j.value >= row_.size()) return pairs();  // of another part
  const auto first = second_.begin() + static_cast<std::ptrdiff_t>(start_[i.value]);
  const auto last = second_.begin() + static_cast<std::ptrdiff_t>(start_[i.value + 1]);
  const auto at = std::lower_bound(first, last, j);
  return at != last && *at == j ? static_cast<std::size_t>(at - second_.begin()) : pairs();
}

void TouchPairs::list(const NeighbourList& near, const Team& team) {
  const std::size_t n = row_.size();
  const auto for_rows = [&](auto work) {
    team.for_parts([&](const Part& part) {
      for (std::size_t i = part.rows.first; i < std::min(part.rows.last, n); ++i) work(i);
    });
  };
  const auto above = [&near](std::size_t i) {  // both lists are sorted
    const std::span<const Row> of_i = near.of(Row{i});
    return of_i.last(
        static_cast<std::size_t>(of_i.end() - std::upper_bound(of_i.begin(), of_i.end(), Row{i})));
  };
  std::swap(start_, old_start_);
  std::swap(second_, old_second_);
  std::swap(slip_, old_slip_);
  std::swap(rolling_, old_rolling_);
  std::swap(kept_, old_kept_);
  start_.assign(n + 1, 0);
  as_second_start_.assign(n + 1, 0);
  for_rows([&](std::size_t i) {
    start_[i + 1] = above(i).size();
    as_second_start_[i + 1] = near.of(Row{i}).size() - above(i).size();
  });
  std::inclusive_scan(start_.begin(), start_.end(), start_.begin());
  std::inclusive_scan(as_second_start_.begin(), as_second_start_.end(), as_second_start_.begin());
  second_.resize(start_[n]);
  slip_.resize(start_[n]);
  if (rolls()) rolling_.resize(start_[n]);
  if (keeps_overlap_) kept_.resize(start_[n]);
  as_second_.resize(start_[n]);
  for_rows([&](std::size_t i) {
    std::size_t k = start_[i], old = old_start_[i];
    for (const Row j : above(i)) {
      while (old < old_start_[i + 1] && old_second_[old] < j) ++old;
      const bool was_near = old < old_start_[i + 1] && old_second_[old] == j;
      slip_[k] = was_near ? old_slip_[old] : SlipRow{};
      if (rolls()) rolling_[k] = was_near ? old_rolling_[old] : MomentRow{};
      if (keeps_overlap_) kept_[k] = was_near ? old_kept_[old] : 0.0;
      second_[k++] = j;
    }
  });
  give_slots(team);
  for_rows([&](std::size_t i) {
    std::size_t e = as_second_start_[i];
    for (const Row j : near.of(Row{i})) {
      if (j.value > i) break;
      as_second_[e++] = of_block_with(j.value).slot(place(j, Row{i}));
    }
  });
}

/// Slots of all parts, one part after the other.
void TouchPairs::give_slots(const Team& team) {
  of_block_.assign(team.blocks(), {});
  std::vector<std::size_t> slots(team.parts().size());
  team.for_parts([&](const Part& part) { slots[part.index] = give_slots(part); });
  std::size_t all = 0;
  for (const Part& part : team.parts()) {
    for (std::size_t b = part.first_block; b < part.last_block; ++b) of_block_[b].first_slot += all;
    all += slots[part.index];
  }
  load_.resize(all);
  if (rolls()) moment_.resize(all);
  touching_.assign(all, 0);
}

/// Slots from 0; returns how many. Blocks that go first keep theirs through the step. All others take turns:
/// those of a block are given to the next ones once its loads have been added everywhere.
std::size_t TouchPairs::give_slots(const Part& part) {
  Slots slots;
  std::vector<std::size_t> last_row(part.last_block - part.first_block);  // that its pairs reach
  for (std::size_t b = part.first_block; b < part.last_block; ++b) {
    OfBlock& block = of_block_[b];
    block.first_pair = start_[std::min(b * block_rows, row_.size())];
    block.pairs = start_[std::min((b + 1) * block_rows, row_.size())] - block.first_pair;
    std::size_t& last = last_row[b - part.first_block] = b * block_rows;
    for (std::size_t k = 0; k < block.pairs; ++k)
      last = std::max<std::size_t>(last, second_[block.first_pair + k].value);
    block.goes_first = last >= part.rows.last;
    if (block.goes_first) block.first_slot = slots.take(block.pairs);
  }
  std::multimap<std::size_t, const OfBlock*> ends;  // by the block that adds its loads last
  for (std::size_t b = part.first_block; b < part.last_block; ++b) {
    OfBlock& block = of_block_[b];
    if (!block.goes_first) {
      block.first_slot = slots.take(block.pairs);
      ends.emplace(last_row[b - part.first_block] / block_rows, &block);
    }
    for (; !ends.empty() && ends.begin()->first <= b; ends.erase(ends.begin()))
      slots.give_back(ends.begin()->second->first_slot, ends.begin()->second->pairs);
  }
  return slots.size();
}

TouchSums TouchPairs::work_out(RowRange rows, const Bodies& b, double dt) {
  return kernel_.touch_pairs(rule(), table(of_block_with(rows.first)), rows, b.pose.data(), b.motion.data(),
                             dt);
}

void TouchPairs::add_loads(RowRange rows, LoadRow* load) {
  kernel_.add_touches(table(of_block_with(rows.first)), {as_second_start_.data(), as_second_.data()}, rows,
                      load);
}

bool TouchPairs::remembers(std::size_t pair) const {
  return slip_[pair] != SlipRow{} || (rolls() && rolling_[pair] != MomentRow{}) ||
         (keeps_overlap_ && kept_[pair] != 0.0);
}

TouchHistory<double> TouchPairs::history(std::size_t pair) const {
  return touch_history(slip_[pair], rolls() ? rolling_[pair] : MomentRow{});
}

double TouchPairs::energy(Row i, Row j, const Bodies& bodies) const {
  const Touching<double> p = touching(i, j, bodies);
  const std::size_t k = place(std::min(i, j), std::max(i, j));
  const TouchHistory<double> h = k < pairs() ? history(k) : TouchHistory<double>{};
  const bool touch = p.overlap > 0.0 || (h.a > 0.0 && holds_on(forms_, numbers(i, j), p.R, p.overlap));
  if (!touch) return 0.0;
  return normal_energy(forms_, numbers(i, j), p.R, p.overlap) + history_energy(forms_, numbers(i, j), h);
}

double TouchPairs::energy(const Bodies& bodies) const {
  double U = 0.0;
  for (std::size_t i = 0; i < row_.size(); ++i)
    for (std::size_t k = start_[i]; k < start_[i + 1]; ++k) U += energy(Row{i}, second_[k], bodies);
  return U;
}

Vec3d TouchPairs::first_force(Row i, Row j, const Bodies& bodies) const {
  const Touching<double> p = touching(i, j, bodies);
  if (!(p.overlap > 0.0)) return {};
  return -normal_force(forms_, numbers(i, j), p.R, p.overlap).F * p.n;
}

void TouchPairs::note_touching(Row i, Row j, const Bodies& bodies) {
  const Touching<double> p = touching(i, j, bodies);
  const std::size_t k = place(std::min(i, j), std::max(i, j));
  if (p.overlap > 0.0 && k < pairs()) slip_[k].a = normal_force(forms_, numbers(i, j), p.R, p.overlap).a;
}

void TouchPairs::keep_overlap(Row i, Row j, double overlap) {
  const std::size_t k = place(std::min(i, j), std::max(i, j));
  if (keeps_overlap_ && k < pairs()) kept_[k] = overlap;
}

std::vector<PairMemory> TouchPairs::collect() const {
  struct Remembering {
    ParticleId i, j;
    Image image_j;
    bool is_turned;    // i stands in the upper one of the two rows
    std::size_t pair;  // here
    std::tuple<ParticleId, ParticleId, Image> place() const { return {i, j, image_j}; }
  };
  std::vector<Remembering> found;  // sorted without what they remember, which is much longer
  for (std::size_t i = 0; i < row_.size(); ++i)
    for (std::size_t k = start_[i]; k < start_[i + 1]; ++k) {
      if (!remembers(k)) continue;
      const ParticleId p = order_.particle[Row{i}], o = order_.particle[second_[k]];
      const Image n = order_.image(second_[k]) - order_.image(Row{i});
      if (p < o || (p == o && n > Image{}))
        found.push_back({p, o, n, false, k});
      else
        found.push_back({o, p, -n, true, k});
    }
  std::sort(found.begin(), found.end(),
            [](const Remembering& a, const Remembering& b) { return a.place() < b.place(); });
  std::vector<PairMemory> memories;
  memories.reserve(found.size());
  for (const Remembering& f : found) {
    const PairHistory h = numbers_of(history(f.pair));
    memories.push_back({f.i, f.j, f.is_turned ? seen_from_the_other(h) : h,
                        keeps_overlap_ ? kept_[f.pair] : 0.0, f.image_j});
  }
  return memories;
}

void TouchPairs::restore(const std::vector<PairMemory>& memories) {
  std::fill(slip_.begin(), slip_.end(), SlipRow{});
  std::fill(rolling_.begin(), rolling_.end(), MomentRow{});
  std::fill(kept_.begin(), kept_.end(), 0.0);
  for (const PairMemory& m : memories) {
    const Row i = order_.row[m.i], j = order_.find(m.j, m.image_j).value_or(Row{row_.size()});
    const std::size_t k = place(std::min(i, j), std::max(i, j));
    if (k >= pairs()) continue;
    const TouchHistory<double> h = touch_history(i < j ? m.history : seen_from_the_other(m.history));
    slip_[k] = {h.F_t, h.a, h.F_d, h.k_r};
    if (rolls()) rolling_[k] = {h.M_r, h.M_t};
    if (keeps_overlap_) kept_[k] = m.kept;
  }
}

}  // namespace vbond

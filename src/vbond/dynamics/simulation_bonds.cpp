// The part of a simulation that bonds change by, and what those that damp take out.
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

/// Energies of bonds near rest are differences of terms of the size of B2, B3 and B4, known to some 1e-16 of
/// them: an energy a thousand roundings large is the least that an error can sensibly be compared with.
double scale_of_rounding(const BodyPart& body) {
  double sum = 0.0;
  for (const Bond& b : body.state.bonds)
    if (body.has(b)) sum += angular_scale(b);
  body.all.sum({&sum, 1});
  return 1e3 * std::numeric_limits<double>::epsilon() * sum;
}

/// Whether a bond that breaks cracks: its faces rub from now on.
bool cracks(const Bond& b) {
  return b.law->crack != nullptr && !is_cracked(b);
}

void take_away(const BondLoads<double>& l, LoadRow& i, LoadRow& j) {
  i.F -= l.F;
  j.F += l.F;
  i.M -= l.M_ij;
  j.M -= l.M_ji;
}

}  // namespace

/// The order of bonds in packs, what is known of them, and what they remember.
void Simulation::arrange_bonds() {
  bonds_.arrange(state_, bodies_.order, all_known(), exchange_);
  if (bonds_.remembers() || !state_.bond_history.empty())  // those that are broken keep theirs
    state_.bond_history.resize(state_.bonds.size());
  const bool others = damping_.is_local();
  damped_.resize(bonds_.damp() ? books_.size() : 0);
  bodies_.damping.resize(bonds_.damp() || others ? bodies_.load.size() : 0);
  bodies_.local_damping.resize(bonds_.damp() && others ? bodies_.load.size() : 0);
}

void Simulation::bonds_changed() {
  arrange_bonds();
  bond_index_ = BondIndex(bodies_.order, state_.bonds, part_bonds_);
  rounding_scale_ = scale_of_rounding(part(Show::bonds));
  contacts_.bonds_changed();
  capsules_.bonds_changed(state_.bonds);
  for (const Bond& b : state_.bonds)
    if (capsules_.any() && capsule_of(b) > 0.0) encounters_.count_capsules(capsule_of(b));
  peak_bonds_.clear();
  if (stage_.stops.peak && stage_.stops.peak->quantity == PeakQuantity::compressive_force)
    peak_bonds_ = bonds_inside(part(Show::bonds), stage_.stops.peak->particles);
  only_elastic_ = has_only_elastic_bonds();
}

void Simulation::make_bonds() {
  if (stage_.bonding.empty()) return;
  const std::vector<Bonding::Pair> pairs = bonding_.find(bodies_.poses(), all_known());
  if (pairs.empty()) return;
  State& s = collected();  // all of it, in all parts
  const std::size_t first = s.bonds.size();
  const bool capsules =
      capsules_.any() || std::any_of(pairs.begin(), pairs.end(), [this](const Bonding::Pair& p) {
        return bonding_.recipe(p.rule).capsule;
      });
  const EnergyBooks before = booked_;
  const double U = capsules ? contact_energy() : 0.0, flowed = capsules ? dissipated_by_flow(s) : 0.0;
  if (contacts_.are_touches() && model_.contact.pairs == ContactPairs::unbonded)
    for (const auto& [rule, i, j, image] : pairs)  // add_bond() books the energy of their repulsion alone
      if (const Order& order = bodies_.order; order.has(i))
        booked_.lose(Loss::bonding, contacts_.energy(order.row[i], order.row_of(j, image), bodies_) -
                                        contact_pair_energy(model_, s, i, j, image));
  s.books = booked_;
  books_ahead_ = true;
  bonding_.make(pairs, s);
  if (leads()) booked_ = s.books;  // all parts have booked the same
  const double flowed_now = capsules ? dissipated_by_flow(s) - flowed : 0.0;  // by their prestrain
  for (std::size_t k = first; k < s.bonds.size(); ++k)
    events_.push_back(event_of(BondEvent::Kind::made, s.bonds[BondId{k}], BondId{k}, s.clock.step));
  if (whole_) take_up_bonds(*whole_, first, bodies_.order, state_, part_bonds_, shared_);
  bonds_changed();
  evaluate_loads();
  if (cell_.any()) cell_.look(team_);
  // a new bond then also changes what others touch
  if (!capsules) return;
  booked_.dissipated = before.dissipated + (leads() ? flowed_now : 0.0), booked_.lost = before.lost;
  booked_.lose(Loss::bonding, U - contact_energy());
}

/// What contacts and terms remember of the steps before.
void Simulation::read_memories() {
  contacts_.restore(state_.contact_history);
  capsules_.restore(state_.fibre_history);
  for (MotionTerm* t : terms_.all()) t->read(state_);
}

/// Whether the state brings along all that evaluate_loads() would leave, in all parts alike. It has no loads
/// of who has just come in. A cell feels images, capsules keep what they do to each other, and pressures what
/// they do to particles.
bool Simulation::brings_all_loads() const {
  if (cell_.any() || capsules_.any() || !stage_.pressures.empty()) return false;
  bool all = true;
  const auto look_at = [this, &all](const Loads& l) {
    all = all && l.F.size() == model_.particles();
    for (Row k{0}; all && k.value < bodies_.order.own; ++k.value)
      all = is_finite(l.F[bodies_.order.particle[k]]);
  };
  look_at(state_.loads);
  if (!bodies_.damping.empty()) look_at(state_.damping);
  if (!bodies_.local_damping.empty()) look_at(state_.local_damping);
  return !exchange_.any(!all);
}

/// Takes up the loads that the state brings along; for elastic bonds they follow from positions.
void Simulation::take_up_loads() {
  if (!brings_all_loads()) {
    const CellEdges cell = state_.cell;  // with what damping did to images in the half step before
    evaluate_loads();
    state_.cell = cell;
    if (cell_.any()) cell_.look_at_drift(team_);
    read_memories();  // with what damped in the half step before
  }
  if (state_.loads.F.size() == model_.particles()) bodies_.spread(state_.loads, bodies_.load);
  if (state_.damping.F.size() == model_.particles() && !bodies_.damping.empty())
    bodies_.spread(state_.damping, bodies_.damping);
  if (state_.local_damping.F.size() == model_.particles() && !bodies_.local_damping.empty())
    bodies_.spread(state_.local_damping, bodies_.local_damping);
  for (MotionTerm* t : terms_.touching()) t->particles_moved(0.0, std::numeric_limits<double>::infinity());
  check_finite();
}

/// A bond that breaks, with what is taken off its particles.
struct Simulation::Broken {
  bool cracked = false;  // its faces rub from now on
  bool parted = false;   // they did, and part: not told as another break
  bool damped = false;
  Image image_j;
  BondEvent event;
  BondLoads<double> loads;    // with its damping, less those of the contact that this makes of them
  BondLoads<double> damping;  // of these
  double released = 0;
  Vec3d r_ij;
};

/// The same, as all parts are told first.
struct Simulation::Breaking {
  BondId bond;  // in the whole body
  bool cracks;
};

/// The bonds that the loads of this step have broken, in the order of bonds: a bond's force ends with the
/// step in which it reached the limit, and so does its share of the energy.
/// Whether there are any.
bool Simulation::break_bonds() {
  std::vector<BreakingBond> here;
  for (std::vector<BreakingBond>& of_part : breaking_) {
    here.insert(here.end(), of_part.begin(), of_part.end());
    of_part.clear();
  }
  add_joints_that_part(here);
  std::vector<Breaking> broken;
  for (const BreakingBond& b : here)
    broken.push_back({part_bonds_.name(b.bond), cracks(state_.bonds[b.bond])});
  broken = exchange_.gather(broken);
  if (broken.empty()) return false;
  std::sort(broken.begin(), broken.end(), [](const auto& a, const auto& b) { return a.bond < b.bond; });
  std::vector<Broken> records;
  for (const Breaking& b : broken) {
    const std::optional<BondId> k = part_bonds_.find(b.bond);
    if (!k)
      broken_elsewhere(b);
    else if (const Broken record = broken_now(*k, here); bodies_.order.has(state_.bonds[*k].i))
      records.push_back(record);
  }
  records = exchange_.gather(records);
  std::sort(records.begin(), records.end(),
            [](const Broken& a, const Broken& b) { return a.event.bond < b.event.bond; });
  for (const Broken& record : records) take_out(record);
  contacts_.list_unbonded(bodies_, all_known());
  exchange_capsules();
  state_.breaks += std::count_if(records.begin(), records.end(), [](const Broken& b) { return !b.parted; });
  if (!bonds_.is_sparse()) return true;
  if (bonds_.remembers()) bonds_.collect(state_.bond_history);
  arrange_bonds();
  return true;
}

/// Sorts what breaks here, with the other cracked cells of joints of which one parts, which are of the same
/// part of the body: their spheres touch from now on.
void Simulation::add_joints_that_part(std::vector<BreakingBond>& broken) const {
  for (std::size_t k = 0, first = broken.size(); k < first; ++k) {
    const Bond& parts = state_.bonds[broken[k].bond];
    if (!is_cracked(parts)) continue;
    for (const BondIndex::Entry e : bond_index_.of(parts.i)) {
      if (!e.is_i) continue;  // those of its first particle are here
      const BondId other = part_bonds_.find(e.bond).value();
      if (const Bond& b = state_.bonds[other];
          is_cracked(b) && b.set == parts.set && b.j == parts.j && image_of_j(b) == image_of_j(parts))
        broken.push_back({other, broken[k].rates});
    }
  }
  std::sort(broken.begin(), broken.end());
  broken.erase(std::unique(broken.begin(), broken.end(),
                           [](const BreakingBond& a, const BreakingBond& b) { return a.bond == b.bond; }),
               broken.end());
}

/// Bonds have broken: their capsules are gone, and what was bonded may touch.
void Simulation::exchange_capsules() {
  if (!capsules_.any()) return;
  const double U = capsules_.energy();
  taken_shares_ = capsules_.shares();
  const std::vector<LoadRow> of_ghosts(bodies_.load.begin() + static_cast<std::ptrdiff_t>(bodies_.order.own),
                                       bodies_.load.end());
  capsules_.take_loads(bodies_.load.data());
  capsules_.bonds_changed(state_.bonds);
  capsules_.refresh();
  exchange_.halo({bodies_.pose, bodies_.motion, &state_.cell});  // that of the step's end
  capsules_.work_out(team_, 0.0);
  capsules_.add_loads({0, bodies_.order.own}, bodies_.load.data());
  std::copy(of_ghosts.begin(), of_ghosts.end(),
            bodies_.load.begin() + static_cast<std::ptrdiff_t>(bodies_.order.own));
  for (const Capsules::Share& s : capsules_.shares()) taken_shares_.push_back({s.row, -s.F, -s.M, s.image});
  std::stable_sort(taken_shares_.begin(), taken_shares_.end(),
                   [](const Capsules::Share& a, const Capsules::Share& b) { return a.row < b.row; });
  if (cell_.any()) cell_.take_out(capsules_.virial(taken_shares_));
  if (leads()) booked_.released += U - capsules_.energy();
}

/// From here on it is broken for all who ask. here: the bonds that this part has found to break.
Simulation::Broken Simulation::broken_now(BondId k, const std::vector<BreakingBond>& here) {
  Bond& b = state_.bonds[k];
  const BondId name = part_bonds_.name(k);
  Broken broken{};
  broken.cracked = cracks(b);
  broken.parted = is_cracked(b);
  broken.damped = is_damped(b);
  broken.image_j = image_of_j(b);
  if (bodies_.order.has(b.i)) {
    const Row i = bodies_.order.row_i(b), j = bodies_.order.row_j(b);
    broken.r_ij = bodies_.between(i, j);
    const BondPose<double> pose = bodies_.bond_pose(b);
    BondHistory history = no_history;
    if (b.law->remembers()) history = state_.bond_history[k] = bonds_.history(k);
    broken.loads = b.law->loads(b, pose, history);
    broken.event = breaking_event(b, name, state_.clock.step, bodies_.pose[i.value].r, pose, history);
    if (broken.damped) {
      const BondRates<double>& rates = std::lower_bound(here.begin(), here.end(), BreakingBond{k, {}})->rates;
      const BondLoads<double>& damping = broken.damping = b.law->damping_loads(b, pose, rates);
      broken.loads = {broken.loads.F + damping.F, broken.loads.M_ij + damping.M_ij,
                      broken.loads.M_ji + damping.M_ji};
    }
    broken.released = broken.event.energy;
    if (broken.cracked) leave_faces(k, pose, broken);
  }
  if (broken.cracked) return broken;
  bonds_.remove(k);
  b.broken = true;
  std::erase(peak_bonds_, k);
  const Contacts::Touch touch = part_pair({name, b.i, b.j, image_of_j(b)});
  broken.loads.F -= touch.force;
  broken.released -= touch.energy;
  return broken;
}

/// A bond that another part works out: nobody here may take the two for bonded any more.
void Simulation::broken_elsewhere(const Breaking& breaks) {
  std::vector<BondEnds>& others = part_bonds_.others;
  const auto at = std::lower_bound(others.begin(), others.end(), breaks.bond,
                                   [](const BondEnds& b, BondId name) { return b.name < name; });
  const bool known = at != others.end() && at->name == breaks.bond;
  if (breaks.cracks) {
    if (known) at->cracked = true;
    return;
  }
  bonds_.remove_elsewhere();
  if (!known) return;
  const BondEnds ends = *at;
  others.erase(at);
  part_pair(ends);
}

/// The bond holds the two no more: what contact makes of them if it was the last, on the bond's first one.
Contacts::Touch Simulation::part_pair(const BondEnds& b) {
  bond_index_.remove(b.name, b.i, b.j);
  if (bond_index_.bonded(b.i, b.j, b.image_j)) return {};
  const Contacts::Touch touch = touch_of_unbonded(b);
  bonding_.unbonded(b.i, b.j, b.image_j);
  return touch;
}

/// The bond cracks: what its faces still carry is not taken off.
void Simulation::leave_faces(BondId k, const BondPose<double>& pose, Broken& broken) {
  const Bond& b = state_.bonds[k];
  const BondHistory history = state_.bond_history[k] = b.law->crack(b, pose, state_.bond_history[k]);
  bonds_.put_history(k, history);
  const BondLoads<double> left = b.law->loads(b, pose, history);
  broken.loads = {broken.loads.F - left.F, broken.loads.M_ij - left.M_ij, broken.loads.M_ji - left.M_ji};
  const BondEnergy<double> U = b.law->energy(b, pose, history);
  broken.released -= U.U_L + U.U_B + U.U_T;
}

/// Lists the two for contact, now that no bond is between them, and returns what contact makes of them, on
/// the bond's first one. They are listed where their contact is worked out: where the first is and an image
/// of the second, or the other way round.
Contacts::Touch Simulation::touch_of_unbonded(const BondEnds& b) {
  const Order& order = bodies_.order;
  const Row i = order.row[b.i], j = order.row[b.j];
  if (b.image_j.is_itself()) return contacts_.unbonded(i, j, bodies_);
  const std::optional<Row> image_of_j = order.find(b.j, b.image_j), image_of_i = order.find(b.i, -b.image_j);
  Contacts::Touch touch;
  if (image_of_j) touch = contacts_.unbonded(i, *image_of_j, bodies_);
  if (image_of_i && !(image_of_j && is_worked_out_here(order, i, *image_of_j)))
    contacts_.unbonded(j, *image_of_i, bodies_);
  return touch;
}

/// Takes it off the particles that are moved here, and tells of it.
void Simulation::take_out(const Broken& broken) {
  const ParticleId i = broken.event.i, j = broken.event.j;
  if (const auto k = part_bonds_.find(broken.event.bond); k && !broken.parted)
    state_.bonds[*k].mode = broken.event.cause.mode;
  const auto take = [&](LargeArray<LoadRow>& load, const BondLoads<double>& loads) {
    take_away(loads, load[bodies_.order.row[i].value], load[bodies_.order.row[j].value]);
    for (const ParticleId p : {i, j})
      if (!bodies_.order.has(p)) load[bodies_.order.row[p].value] = {};
  };
  if (broken.damped) take(bodies_.damping, broken.damping);
  take(bodies_.load, broken.loads);
  taken_.push_back({i, j, broken.loads});
  if (cell_.any()) cell_.take_out(broken.r_ij, broken.image_j, broken.loads.F, broken.damping.F);
  if (bodies_.order.has(i)) booked_.released += broken.released;
  if (!broken.parted) events_.push_back(broken.event);
  survey_.reset();
}

/// The kick with the work that damping does in it: its loads along the mean of the velocities before and
/// after. Local damping acts on what particles move beside the flow of the cell, which stands for the time of
/// the kick.
void Simulation::kick_and_book_damping(const Block& b, Instant from, Instant to, const Tensor& flow) {
  const double h = stage_.dt / 2;
  const auto power_of = [&](const LargeArray<LoadRow>& loads) {
    return loads.empty() ? 0.0 : kernel_.power(b.rows, loads.data(), bodies_.motion.data());
  };
  double twice_all = 0.0, twice_local = power_of(bodies_.local_damping);
  if (bodies_.tops.any() || supports_.hold_any(b)) {  // velocities change by more than these loads
    twice_all = power_of(bodies_.damping);
    kick(b, h);
    books_[b.index].work_supports += supports_.hold_after_kick(b, from, to, h);
    twice_all += power_of(bodies_.damping);
  } else {
    books_[b.index].poison +=
        kernel_.kick_damped(particles_of(b), h, bodies_.inverse.data(), bodies_.load.data(),
                            bodies_.motion.data(), bodies_.damping.data(), twice_all);
  }
  twice_local += power_of(bodies_.local_damping);
  if (!bonds_.damp()) twice_local = twice_all;
  lose(b.index, Loss::local_damping, -0.5 * h * twice_local);
  lose(b.index, Loss::bond_damping, -0.5 * h * (twice_all - twice_local));
  if (!cell_.any() || !damping_.is_local()) return;
  const LargeArray<LoadRow>& loads = bonds_.damp() ? bodies_.local_damping : bodies_.damping;
  for (std::size_t k = b.rows.first; k < std::min(b.rows.last, bodies_.order.own); ++k)
    lose(b.index, Loss::local_damping, h * dot(loads[k].F, vbond::times(flow, bodies_.pose[k].r)));
}

}  // namespace vbond

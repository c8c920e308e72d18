#include "vbond/ranks/ranks.hpp"

#include <mpi.h>

#include <ctime>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

/// Seconds that this rank has worked; waiting for others counts, too.
double seconds_at_work() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// After so many steps the ranks tell each other of failures, and how far particles have gone.
constexpr std::int64_t chunk = 64;

/// Ghosts are listed beyond what may meet by this part of its reach: until two have gone half of that each,
/// no pair is missing.
constexpr double margin = 0.5;
/// A bond longer than at the last redistribution finds its ghost all the same: messages go on to those who
/// were listed then. So this covers rounding alone.
constexpr double beyond_longest = 1.0 + 1e-6;

}  // namespace

Ranks::Ranks() {
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  MPI_Comm here{};
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &here_);
  int lowest = rank_;
  MPI_Allreduce(&rank_, &lowest, 1, MPI_INT, MPI_MIN, here);
  first_is_here_ = lowest == 0;
  MPI_Comm_free(&here);
}

Ranks::~Ranks() {
  if (leads() && agreed_ && !dismissed_) {
    std::int64_t order = end;
    MPI_Bcast(&order, 1, MPI_INT64_T, 0, MPI_COMM_WORLD);
  }
}

std::string Ranks::agree(const std::string& failure) {
  agreed_ = true;
  std::string first = first_failure(failure);
  dismissed_ = !first.empty();
  return first;
}

/// Of those that the ranks have, that of the lowest rank; empty if there is none.
std::string Ranks::first_failure(const std::string& mine) const {
  int rank = mine.empty() ? size_ : rank_, first = 0;
  MPI_Allreduce(&rank, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  return first == size_ ? std::string{} : text_of_rank(first, mine);
}

/// All ranks get the text of that one.
std::string Ranks::text_of_rank(int rank, std::string text) const {
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, rank, MPI_COMM_WORLD);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, rank, MPI_COMM_WORLD);
  return text;
}

/// What rank 0 wants next; others need not know, and answer what it asks until then.
std::int64_t Ranks::follow(std::int64_t wish) {
  MPI_Bcast(&wish, 1, MPI_INT64_T, 0, MPI_COMM_WORLD);
  while (!leads() && (wish == question || wish == look)) {
    if (wish == look)
      look_here({});
    else
      part_->answer(share({}));
    MPI_Bcast(&wish, 1, MPI_INT64_T, 0, MPI_COMM_WORLD);
  }
  if (!leads() && wish == end) throw Dismissed{};
  return wish;
}

/// All ranks get the question of rank 0.
Question Ranks::share(Question q) const {
  struct Head {
    Question::What what;
    std::uint64_t particles;
    double part;
  } head{q.what, q.particles.size(), q.part};
  MPI_Bcast(&head, sizeof head, MPI_BYTE, 0, MPI_COMM_WORLD);
  q.what = head.what, q.part = head.part;
  q.particles.resize(head.particles);
  MPI_Bcast(q.particles.data(), static_cast<int>(q.particles.size() * sizeof(ParticleId)), MPI_BYTE, 0,
            MPI_COMM_WORLD);
  return q;
}

Simulation& Ranks::ask(const Question& q) {
  Simulation& here = part();
  follow(question);
  share(q);
  return here;
}

void Ranks::look_at_parts(const std::string& message) {
  part();
  follow(look);
  look_here(message);
}

/// Nobody goes on before all know who could not write. Any other failure ends the program on all ranks.
void Ranks::look_here(const std::string& message) {
  const std::string of_rank_0 = text_of_rank(0, message);
  part_->learn_ends_of_bonds();
  std::string failure;
  try {
    look_(*part_, of_rank_0);
  } catch (const IoError& e) {
    failure = "on rank " + std::to_string(rank_) + ": " + e.what();
  }
  failure = first_failure(failure);
  if (leads() && !failure.empty()) throw IoError(failure);
}

/// Others must not go on to what they do by themselves, a static stage, as long as rank 0 may ask.
void Ranks::end_stage(State& state) {
  follow(stage_over);
  bring_together(state);
  part_.reset();
}

/// All ranks get the whole state. Rank 0 has kept one for its observers, the others have it in their parts.
void Ranks::bring_together(State& state) {
  if (leads()) {
    part_->give(state);
    part_->give_particles(state, true);
  } else {
    state = std::move(*part_).take_state();
  }
}

void Ranks::wait_for_end() {
  follow(end);
  throw std::logic_error("a rank has come to its end before rank 0");
}

void Ranks::begin(const Model& model, const Stage& stage, State& state, double reach) {
  follow(start);
  model_ = &model;
  stage_ = &stage;
  reach_ = reach;
  order_ = spatial_order(model.r_0);
  part_.reset();
  domains_.reset();
  first_ghost_reach_ = ghost_reach(state);
  unchecked_ = 0;
  domains_ = std::make_unique<Domains>(order_, state.r, work_of(state), first_ghost_reach_);
  take_part(state);
}

/// There is none if it could not be made.
Simulation& Ranks::part() {
  if (!part_) throw std::logic_error("the body diverged as its particles were spread over the ranks anew");
  return *part_;
}

double Ranks::ghost_reach(const State& state) const {
  if (reach_ == std::numeric_limits<double>::infinity()) {  // all are ghosts of all
    double farthest2 = 0.0;
    for (const Vec3d& r : state.r) farthest2 = std::max(farthest2, norm2(r - *state.r.begin()));
    return std::max(1.0, 2.0 * std::sqrt(farthest2)) * beyond_longest;
  }
  double longest2 = 0.0;
  for (const Bond& b : state.bonds)
    if (!b.broken) longest2 = std::max(longest2, norm2(state.r[b.j] - state.r[b.i]));
  return std::max(
      {std::numeric_limits<double>::min(), std::sqrt(longest2) * beyond_longest, reach_ * (1.0 + margin)});
}

/// What each particle costs in a step: by itself, and its bonds.
PerParticle<double> Ranks::work_of(const State& state) const {
  PerParticle<double> work(model_->particles(), static_cast<double>(work_of_particle(*model_)));
  for (const Bond& b : state.bonds)
    if (!b.broken) work[b.i] += 1.0;
  return work;
}

/// A simulation of this rank's part of a body, which all ranks have.
void Ranks::take_part(State& state) {
  const Holding holding = domains_->holding();
  Order order = part_of(order_, holding);
  rows_.clear();
  for (const auto* some : {&holding.own, &holding.ghosts})
    for (const ParticleId p : *some) rows_.push_back(order.row[p].value);
  for (const Bond& b : state.bonds)
    if (!b.broken && order.has(b.i) && !order.knows(b.j))
      throw std::runtime_error("a rank has no ghost of particle " + std::to_string(b.j.value) +
                               ", which its particle " + std::to_string(b.i.value) + " is bonded to");
  own_ = holding.own;
  std::sort(own_.begin(), own_.end());
  const std::unique_ptr<Simulation> before = std::move(part_);
  part_ = std::make_unique<Simulation>(*model_, *stage_, leads() ? state : std::move(state), std::move(order),
                                       *this);
  if (before) part_->take_events(*before);
  room_ = 0.5 * margin * reach_;
  longest_ = part_->longest_bond();
  max({&longest_, 1});
}

StopReason Ranks::advance(std::int64_t most, State& state) {
  const std::int64_t steps = follow(most);
  try {
    const double begun = seconds_at_work() - waited_;
    const StopReason why = step(steps, state);
    worked_ += seconds_at_work() - waited_ - begun;
    std::array<double, 2> work{worked_, worked_};
    sum({&work[0], 1});
    max({&work[1], 1});
    imbalance_ = work[1] * size_ / work[0];
    part_->agree_on_failure();
    part_->give(state);
    return why;
  } catch (const Diverged& e) {  // all ranks together
    if (part_) part_->give(state);
    state.clock.stage_step += e.step - state.clock.step;
    state.clock.step = e.step;
    throw;
  }
}

/// So many steps, or fewer if the stage ends or observers must look.
StopReason Ranks::step(std::int64_t steps, State& state) {
  StopReason why = part_->stop_reason();
  for (std::int64_t n = 0; n < steps && why == StopReason::running && !(n > 0 && part_->is_due()); ++n) {
    if (unchecked_ == chunk || (reach_ > 0.0 && !(room_ > 0.0))) {
      part_->agree_on_failure();
      unchecked_ = 0;
      if (is_far()) redistribute(state);
    }
    part_->step();
    why = part_->stop_reason();
    room_ -= part_->last_way();
    ++unchecked_;
  }
  return why;
}

/// Whether particles are to be spread anew: because ghosts may be missing of what may meet, or else, as bonds
/// keep theirs however far they move, because domains are to be compact, once a particle has gone a quarter
/// of the longest bond. Not where one has gone so far that LAMMPS' box, which is wider than the body by 1e-4
/// of its first size, would lose it by rounding: that body diverges.
bool Ranks::is_far() {
  double way = part_->way_since_begin();
  max({&way, 1});
  const double limit = reach_ > 0.0 && std::isfinite(reach_) ? 0.5 * margin * reach_ : 0.25 * longest_;
  room_ = limit - way;
  return way > limit && way < 1e6 * first_ghost_reach_;
}

void Ranks::redistribute(State& state) {
  bring_together(state);
  domains_->redistribute(state.r, work_of(state), ghost_reach(state));
  const std::vector<ParticleId> before = own_;
  take_part(state);
  std::int64_t come = 0;
  for (const ParticleId p : own_) come += !std::binary_search(before.begin(), before.end(), p);
  MPI_Allreduce(MPI_IN_PLACE, &come, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  migrations_ += come;
  ++redistributions_;
}

/// Counts what is done from here to its end as waiting.
class Ranks::Waiting {
 public:
  explicit Waiting(const Ranks& ranks) : ranks_(ranks), since_(seconds_at_work()) {}
  ~Waiting() { ranks_.waited_ += seconds_at_work() - since_; }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  const Ranks& ranks_;
  double since_;
};

void Ranks::halo(const HaloColumns& columns) {
  const Waiting waiting(*this);
  domains_->halo(rows_, columns);
}

void Ranks::reverse_sum(std::span<LoadRow> load) {
  const Waiting waiting(*this);
  domains_->reverse_sum(rows_, load);
}

void Ranks::sum(std::span<double> numbers) const {
  const Waiting waiting(*this);
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, MPI_SUM,
                MPI_COMM_WORLD);
}

void Ranks::max(std::span<double> numbers) const {
  const Waiting waiting(*this);
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, MPI_MAX,
                MPI_COMM_WORLD);
}

void Ranks::gather_bytes(std::span<const std::byte> mine, bool everyone, const Room& room) const {
  const Waiting waiting(*this);
  std::int64_t total = static_cast<std::int64_t>(mine.size());
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  if (total > std::numeric_limits<int>::max())
    throw std::runtime_error(
        "the body is too large: MPI counts at most 2 GiB in one message; use vbond, which sends none");
  const int count = static_cast<int>(mine.size());
  std::vector<int> counts(static_cast<std::size_t>(size_)), first(counts.size());
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  for (std::size_t k = 1; k < first.size(); ++k) first[k] = first[k - 1] + counts[k - 1];
  const auto size = static_cast<std::size_t>(first.back() + counts.back());
  std::byte* all = everyone || leads() ? room(size) : nullptr;
  if (everyone)
    MPI_Allgatherv(mine.data(), count, MPI_BYTE, all, counts.data(), first.data(), MPI_BYTE, MPI_COMM_WORLD);
  else
    MPI_Gatherv(mine.data(), count, MPI_BYTE, all, counts.data(), first.data(), MPI_BYTE, 0, MPI_COMM_WORLD);
}

}  // namespace vbond

#include "vbond/ranks/ranks.hpp"

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

/// Between these many steps the ranks tell each other of their energies and of failures.
constexpr std::int64_t chunk = 64;

constexpr std::int64_t nobody = std::numeric_limits<std::int64_t>::max();

/// A particle as it is sent to rank 0.
struct Sent {
  std::int64_t particle;
  Motion motion;
};
static_assert(sizeof(Sent) == 14 * sizeof(double));

}  // namespace

Ranks::Ranks() {
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Ranks::~Ranks() {
  if (leads() && agreed_ && !dismissed_) {
    std::int64_t order = end;
    MPI_Bcast(&order, 1, MPI_INT64_T, 0, MPI_COMM_WORLD);
  }
}

std::string Ranks::agree(const std::string& failure) {
  agreed_ = true;
  int mine = failure.empty() ? size_ : rank_, first = 0;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  dismissed_ = first < size_;
  if (first == size_) return {};
  int length = static_cast<int>(failure.size());
  MPI_Bcast(&length, 1, MPI_INT, first, MPI_COMM_WORLD);
  std::string text = failure;
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, first, MPI_COMM_WORLD);
  return text;
}

/// What rank 0 wants next; others need not know.
std::int64_t Ranks::follow(std::int64_t order) {
  MPI_Bcast(&order, 1, MPI_INT64_T, 0, MPI_COMM_WORLD);
  if (!leads() && order == end) throw Dismissed{};
  return order;
}

void Ranks::wait_for_end() {
  follow(end);
  throw std::logic_error("a rank has come to its end before rank 0");
}

void Ranks::begin(const Model& model, const Stage& stage, const State& state) {
  follow(start);
  model_ = &model;
  stage_ = &stage;
  bonds_ = state.bonds;
  breakable_ =
      std::any_of(bonds_.begin(), bonds_.end(), [](const Bond& b) { return !b.broken && can_break(b); });
  share_.reset();
  domains_.reset();
  domains_ = std::make_unique<Domains>(model, state);
  share_out();
  evaluate_between_steps(state.clock.stage_step);
  first_longest_ = share_->longest_bond();
  MPI_Allreduce(MPI_IN_PLACE, &first_longest_, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
}

void Ranks::share_out() {
  share_ = std::make_unique<Share>(*model_, *stage_, bonds_, domains_->holding(bonds_));
  domains_->send_poses(share_->rows(), share_->pose());
}

/// The loads of the bonds.
void Ranks::evaluate(bool in_step) {
  share_->add_bond_loads(in_step);
  domains_->gather_loads(share_->rows(), share_->load());
}

void Ranks::evaluate_between_steps(std::int64_t stage_step) {
  evaluate(false);
  share_->add_applied_loads(stage_step);
}

std::vector<BondId> Ranks::advance(std::int64_t most, bool all_look, State& state) {
  const std::int64_t steps = follow(most);
  bool breaks = false;
  for (std::int64_t left = steps; left > 0 && !breaks; left -= chunk) {
    breaks = step_chunk(std::min(left, chunk), state);
    if (!breaks) redistribute_if_due(state);
  }
  const bool ends = state.clock.stage_step >= steps_in(stage_->stops.duration, stage_->dt);
  collect(all_look || breaks || ends, state);
  return breaks ? take_out_broken(state.clock.stage_step) : std::vector<BondId>{};
}

/// Bonds that break have acted in this step. All ranks are told of them.
std::vector<BondId> Ranks::take_out_broken(std::int64_t stage_step) {
  const std::vector<BondId> mine = share_->broken();
  share_->take_out_broken();
  const int count = static_cast<int>(mine.size());
  std::vector<int> counts(static_cast<std::size_t>(size_)), first(counts.size());
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  for (std::size_t k = 1; k < first.size(); ++k) first[k] = first[k - 1] + counts[k - 1];
  std::vector<BondId> all(static_cast<std::size_t>(first.back() + counts.back()));
  static_assert(sizeof(BondId) == sizeof(std::uint32_t));
  MPI_Allgatherv(mine.data(), count, MPI_UINT32_T, all.data(), counts.data(), first.data(), MPI_UINT32_T,
                 MPI_COMM_WORLD);
  for (const BondId b : all) bonds_[b].broken = true;
  evaluate_between_steps(stage_step);
  return all;
}

/// Whether a bond of any rank breaks in this step.
bool Ranks::any_breaks() const {
  if (!breakable_) return false;
  int any = share_->broken().empty() ? 0 : 1;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  return any != 0;
}

/// So many steps, or fewer if bonds break: returns whether they do. Energies are summed step by step, as the
/// balance error is judged by the largest of all steps.
bool Ranks::step_chunk(std::int64_t steps, State& state) {
  std::vector<StepSums> sums;
  std::int64_t failed = nobody;  // the first step with a load of ours that is not finite
  bool breaks = false;
  for (std::int64_t n = 0; n < steps && !breaks; ++n) {
    share_->move(state.clock.stage_step + n);
    domains_->send_poses(share_->rows(), share_->pose());
    evaluate(true);
    sums.push_back(share_->finish());
    breaks = any_breaks();
    if (sums.back().poison == 0.0 || failed != nobody) continue;
    if (const auto p = share_->without_finite_load()) failed = n, failed_ = *p;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(4 * sums.size()), MPI_DOUBLE, MPI_SUM,
                MPI_COMM_WORLD);
  EnergyBooks& books = state.books;
  for (const StepSums& s : sums) {
    ++state.clock.step;
    ++state.clock.stage_step;
    if (s.poison != 0.0) look_for_failure(sums, failed, state);
    books.lose(Loss::drag, s.dissipated);
    books.work_loads += s.work_loads;
    books.work_supports += s.work_supports;
    books.largest = std::max(books.largest, books.at_start + books.work_loads + books.work_supports);
  }
  return breaks;
}

/// Throws on all ranks, for the first particle of the first step in which one failed.
void Ranks::look_for_failure(const std::vector<StepSums>& sums, std::int64_t failed,
                             const State& state) const {
  const auto at = std::find_if(sums.begin(), sums.end(), [](const StepSums& s) { return s.poison != 0.0; });
  std::int64_t particle = failed == at - sums.begin() ? std::int64_t{failed_.value} : nobody;
  MPI_Allreduce(MPI_IN_PLACE, &particle, 1, MPI_INT64_T, MPI_MIN, MPI_COMM_WORLD);
  if (particle == nobody) return;  // finite, but too large to be added up: a particle fails soon
  throw Diverged(state.clock.step, state.clock.time(), "particle " + std::to_string(particle),
                 "its force or moment is not a finite number",
                 "reduce time.step (or time.fraction); look at the last frame for bonds that closed up");
}

/// Ghosts stay what they are however far they move. But domains are to be compact: so all is listed anew when
/// a particle has gone as far as a quarter of the longest bond. Not where one has gone so far that LAMMPS'
/// box, which is wider than the body by 1e-4 of its first size, would lose it by rounding: that body
/// diverges.
void Ranks::redistribute_if_due(State& state) {
  std::array<double, 2> most{share_->way2(), share_->longest_bond()};
  MPI_Allreduce(MPI_IN_PLACE, most.data(), 2, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  const double longest = std::max(most[1], std::numeric_limits<double>::min());
  const double way = std::sqrt(most[0]);
  if (!(way > 0.25 * longest) || way > 1e6 * first_longest_) return;
  std::vector<Motion> own;
  for (std::size_t k = 0; k < share_->own(); ++k) own.push_back(share_->motion(k));
  domains_->redistribute(own, longest);
  const std::vector<ParticleId> before(share_->particles().begin(),
                                       share_->particles().begin() + static_cast<std::ptrdiff_t>(own.size()));
  share_out();
  evaluate_between_steps(state.clock.stage_step);
  count_migrations(before);
}

void Ranks::count_migrations(std::vector<ParticleId> before) {
  std::sort(before.begin(), before.end());
  std::int64_t come = 0;
  for (std::size_t k = 0; k < share_->own(); ++k)
    come += !std::binary_search(before.begin(), before.end(), share_->particles()[k]);
  MPI_Allreduce(MPI_IN_PLACE, &come, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  migrations_ += come;
}

/// The motion of all particles, on rank 0 or on all.
void Ranks::collect(bool everyone, State& state) const {
  std::vector<Sent> mine;
  for (std::size_t k = 0; k < share_->own(); ++k)
    mine.push_back({std::int64_t{share_->particles()[k].value}, share_->motion(k)});
  MPI_Datatype particle = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(sizeof(Sent), MPI_BYTE, &particle);
  MPI_Type_commit(&particle);
  const int count = static_cast<int>(mine.size());
  std::vector<int> counts(static_cast<std::size_t>(size_)), first(counts.size());
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  for (std::size_t k = 1; k < first.size(); ++k) first[k] = first[k - 1] + counts[k - 1];
  std::vector<Sent> all(everyone || leads() ? model_->particles() : 0);
  if (everyone)
    MPI_Allgatherv(mine.data(), count, particle, all.data(), counts.data(), first.data(), particle,
                   MPI_COMM_WORLD);
  else
    MPI_Gatherv(mine.data(), count, particle, all.data(), counts.data(), first.data(), particle, 0,
                MPI_COMM_WORLD);
  MPI_Type_free(&particle);
  for (const Sent& s : all) {
    const ParticleId p{static_cast<std::size_t>(s.particle)};
    state.r[p] = s.motion.r, state.q[p] = s.motion.q;
    state.v[p] = s.motion.v, state.omega[p] = s.motion.omega;
  }
}

}  // namespace vbond

#include "vbond/ranks/ranks.hpp"

#include <mpi.h>

#include <ctime>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/core/images.hpp"
#include "vbond/dynamics/borders.hpp"
#include "vbond/dynamics/migration.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/ranks/ghosts.hpp"

namespace vbond {
namespace {

/// Seconds that this rank has worked; waiting for others counts, too.
double seconds_at_work() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Ghosts are listed beyond what may meet by this part of its reach: until two have gone half of that each,
/// no pair is missing.
constexpr double margin = 0.5;
/// LAMMPS' box is wider than the body by 1e-4 of its first size: a particle that has gone so many times the
/// length that bonds or contacts reach would be lost by rounding.
constexpr double farthest_found = 1e6;

constexpr const char* too_large =
    "the body is too large: MPI counts at most 2 GiB in one message; use vbond, which sends none";

/// Where domains are cut: a periodic body in its cell, whose edges are straightened out; room: for these
/// places.
const PerParticle<Vec3d>& straightened(const Model& model, const State& state, PerParticle<Vec3d>& room) {
  if (!model.cell.any()) return state.r;
  room = state.r;
  for (Vec3d& r : room) {
    r += to_image(state.cell, image_in_cell(state.cell, model.cell.periodic, {}, r));
    const Vec3d s = in_edges(state.cell, r);
    r = {s.x * norm(state.cell[0].along), s.y * norm(state.cell[1].along), s.z * norm(state.cell[2].along)};
  }
  return room;
}

/// What each particle costs in a step by itself.
PerParticle<double> work_of_particles(const Model& model, const State& state) {
  auto work = PerParticle<double>::alike(state.r, static_cast<double>(work_of_particle(model)));
  for (const ParticleId p : absent(state)) work[p] = 1e-6;  // LAMMPS wants some of each atom
  return work;
}

std::vector<ParticleId> present_of(const Domains& domains, const State& state) {
  std::vector<ParticleId> own = domains.own();
  std::erase_if(own, [&state](ParticleId p) { return is_absent(state, p); });
  return own;
}

/// The same with its bonds.
PerParticle<double> work_of(const Model& model, const State& state) {
  PerParticle<double> work = work_of_particles(model, state);
  for (const Bond& b : state.bonds)
    if (!b.broken) work[b.i] += 1.0;
  return work;
}

}  // namespace

/// Counts what is done from here to its end as waiting.
class Ranks::Waiting {
 public:
  explicit Waiting(const Ranks& ranks)
      : ranks_(ranks), counts_(!std::exchange(ranks.waits_, true)), since_(seconds_at_work()) {}
  ~Waiting() {
    if (!counts_) return;  // it is within another one
    ranks_.waits_ = false;
    ranks_.waited_ += seconds_at_work() - since_;
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  const Ranks& ranks_;
  const bool counts_;
  double since_;
};

Ranks::Ranks() {
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  MPI_Comm here{};
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &here_);
  MPI_Comm_free(&here);
}

double Ranks::imbalance() const {
  const double worked = begun_ < 0.0 ? 0.0 : seconds_at_work() - waited_ - begun_;
  double sum_of_all = worked, most = worked;
  sum({&sum_of_all, 1});
  max({&most, 1});
  return sum_of_all > 0.0 ? most * size_ / sum_of_all : 1.0;
}

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

void Ranks::make_domains(const Model& model, const State& state, const PerParticle<double>& work,
                         double longest) {
  domains_.reset();
  const double size = size_of_domains(state, longest);
  lost_beyond_ = farthest_found * size;
  PerParticle<Vec3d> room;
  domains_ = std::make_unique<Domains>(straightened(model, state, room), work, size);
}

std::vector<ParticleId> Ranks::spread_first(const Model& model, const State& state,
                                            const PerParticle<std::uint32_t>& bonds, double longest) {
  const Waiting waiting(*this);
  const Acquaintance known = acquaintance(model, {}, state);
  reach_ = known.reach, knows_all_ = known.knows_all;
  PerParticle<double> work = work_of_particles(model, state);
  for (const ParticleId p : work.ids()) work[p] += static_cast<double>(bonds[p]);
  make_domains(model, state, work, longest);
  domains_fit_ = true;
  return domains_->own();
}

Share Ranks::spread(const Model& model, const State& state, double reach, bool knows_all) {
  if (begun_ < 0.0) begun_ = seconds_at_work() - waited_;
  const Waiting waiting(*this);
  if (!std::exchange(domains_fit_, false) || reach != reach_ || knows_all != knows_all_) {
    reach_ = reach, knows_all_ = knows_all;
    make_domains(model, state, work_of(model, state), longest_bond(state));
  }
  own_ = present_of(*domains_, state);
  return share_of(model, state);
}

/// Those that it had before. Where bonds alone act they stay.
std::vector<ParticleId> Ranks::redistribute(const Model& model, const State& state) {
  if (!domains_) return own_;
  PerParticle<Vec3d> room;
  domains_->redistribute(straightened(model, state, room), work_of(model, state));
  std::vector<ParticleId> before = std::exchange(own_, present_of(*domains_, state));
  std::int64_t come = 0;
  for (const ParticleId p : own_) come += !std::binary_search(before.begin(), before.end(), p);
  MPI_Allreduce(MPI_IN_PLACE, &come, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  migrations_ += come;
  ++redistributions_;
  return before;
}

Share Ranks::spread_anew(const Model& model, const State& state) {
  const Waiting waiting(*this);
  redistribute(model, state);
  return share_of(model, state);
}

/// The ranks that have these particles. Of those across borders it is known; where any rank has others, they
/// are looked up.
std::vector<int> Ranks::owners_among(std::vector<PlacedParticle> across,
                                     const std::vector<ParticleId>& others, std::size_t particles) const {
  const auto is_before = [](const PlacedParticle& a, ParticleId p) { return a.particle < p; };
  std::sort(across.begin(), across.end(),
            [](const PlacedParticle& a, const PlacedParticle& b) { return a.particle < b.particle; });
  std::vector<int> owners;
  std::vector<ParticleId> elsewhere;
  for (const ParticleId p : others) {
    const auto at = std::lower_bound(across.begin(), across.end(), p, is_before);
    const bool is_across = at != across.end() && at->particle == p;
    owners.push_back(is_across ? at->part : -1);
    if (!is_across) elsewhere.push_back(p);
  }
  if (!any(!elsewhere.empty())) return owners;
  const std::vector<int> found = owners_of(elsewhere, own_, particles, *this);
  auto next = found.begin();
  for (int& owner : owners)
    if (owner < 0) owner = *next++;
  return owners;
}

Share Ranks::migrate(Model& model, State& state, PartHandedOver part) {
  const Waiting waiting(*this);
  const std::vector<ParticleId> before = redistribute(model, state);
  vbond::migrate(before, own_, model, state, part, *this);
  Places among;
  for (const ParticleId p : own_) among.of.push_back(p), among.r.push_back(state.r[p]);
  std::vector<PlacedParticle> across = particles_across_borders(model, state, own_, ghost_reach(), *this);
  for (const PlacedParticle& p : across) among.of.push_back(p.particle), among.r.push_back(p.r);
  std::vector<ImageOf> ghosts = ghosts_of(own_, std::move(among), model, state, ghost_reach(), false);
  const std::vector<ParticleId> others = others_to_know(own_, ghosts, state);
  const std::vector<int> owners = owners_among(std::move(across), others, model.particles());
  know_besides(others, owners, own_, model, state, *this);
  std::vector<int> owners_of_ghosts;
  for (const ImageOf& g : ghosts) {
    const auto at = std::lower_bound(others.begin(), others.end(), g.particle);
    const bool is_other = at != others.end() && *at == g.particle;
    owners_of_ghosts.push_back(is_other ? owners[static_cast<std::size_t>(at - others.begin())] : rank_);
  }
  Share share = share_with(std::move(ghosts), owners_of_ghosts, model, state);
  share.part = std::move(part);
  return share;
}

double Ranks::ghost_reach() const {
  return reach_ * (1.0 + margin);
}

/// Not where bonds alone act, nor where all particles are ghosts and have no images.
bool Ranks::are_spread_anew(const Model& model) const {
  return ghost_reach() > 0.0 && (!knows_all_ || model.cell.any());
}

/// The least that domains can sensibly be as large as.
double Ranks::size_of_domains(const State& state, double longest) const {
  if (!knows_all_) return std::max({std::numeric_limits<double>::min(), longest, ghost_reach()});
  double farthest2 = 0.0;  // all are ghosts of all
  for (const Vec3d& r : state.r) farthest2 = std::max(farthest2, norm2(r - *state.r.begin()));
  return std::max(1.0, 2.0 * std::sqrt(farthest2));
}

/// Particles are to be spread anew where ghosts may be missing of what may meet; else they stay where they
/// are however far they move.
Share Ranks::share_of(const Model& model, const State& state) {
  const double reach = are_spread_anew(model) ? ghost_reach() : 0.0;
  std::vector<ImageOf> ghosts =
      ghosts_of(own_, reach > 0.0 ? present_places(state) : Places{}, model, state, reach, knows_all_);
  std::vector<ParticleId> particles;
  for (const ImageOf& g : ghosts) particles.push_back(g.particle);
  const std::vector<int> owners = owners_of(particles, own_, model.particles(), *this);
  return share_with(std::move(ghosts), owners, model, state);
}

/// The boxes that the particles of other ranks are in.
std::vector<BoundingBox> Ranks::boxes_of_others(const State& state) const {
  BoundingBox mine;
  for (const ParticleId p : own_) mine.add(state.r[p]);
  std::vector<BoundingBox> boxes = gather(std::vector<BoundingBox>{mine});
  boxes.erase(boxes.begin() + rank_);
  return boxes;
}

Share Ranks::share_with(std::vector<ImageOf> ghosts, std::vector<int> owners, const Model& model,
                        const State& state) {
  std::vector<ParticleId> known = own_;
  for (const ImageOf& g : ghosts) known.push_back(g.particle);
  const Order order = knows_all_ ? spatial_order(model.r_0) : spatial_order(model.r_0, known);
  put_in_rows(order, ghosts, owners);
  halo_.finish();
  halo_ = Halo(ghosts, owners, *this);
  std::vector<ParticleId> early = halo_.sent();
  add_bonded_to_ghosts(own_, state, early);
  Share share{.order = part_of(order, {.own = own_,
                                       .early = std::move(early),
                                       .ghosts = std::move(ghosts),
                                       .ghost_bonds_last = true,
                                       .others_in_one_row = !knows_all_}),
              .farthest = std::numeric_limits<double>::infinity(),
              .lost_beyond = lost_beyond_};
  halo_.take_rows(share.order);
  if (are_spread_anew(model)) {
    share.farthest = 0.5 * margin * reach_;
    if (!model.cell.any()) share.others = boxes_of_others(state);
  } else {
    domains_.reset();  // LAMMPS makes room
  }
  return share;
}

void Ranks::begin_halo(const HaloColumns& columns) {
  const Waiting waiting(*this);
  halo_.begin_update(columns);
}

void Ranks::end_halo(const HaloColumns& columns) {
  const Waiting waiting(*this);
  halo_.end_update(columns);
}

void Ranks::reverse_sum(std::span<LoadRow> load) {
  const Waiting waiting(*this);
  halo_.reverse_sum(load);
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

/// How many bytes each rank sends, and where they begin among those of all.
struct Ranks::Counts {
  std::vector<int> of_rank, first;
  std::size_t all = 0;
};

Ranks::Counts Ranks::counts(std::size_t mine) const {
  const auto size = static_cast<std::size_t>(size_);
  std::vector<std::int64_t> of_all(size);
  const auto bytes = static_cast<std::int64_t>(mine);
  MPI_Allgather(&bytes, 1, MPI_INT64_T, of_all.data(), 1, MPI_INT64_T, MPI_COMM_WORLD);
  if (std::accumulate(of_all.begin(), of_all.end(), std::int64_t{0}) > std::numeric_limits<int>::max())
    throw std::runtime_error(too_large);
  Counts counts;
  for (const std::int64_t n : of_all) {
    counts.of_rank.push_back(static_cast<int>(n));
    counts.first.push_back(static_cast<int>(counts.all));
    counts.all += static_cast<std::size_t>(n);
  }
  return counts;
}

void Ranks::gather_bytes(std::span<const std::byte> mine, const Room& room) const {
  const Waiting waiting(*this);
  const Counts n = counts(mine.size());
  MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), MPI_BYTE, room(n.all), n.of_rank.data(),
                 n.first.data(), MPI_BYTE, MPI_COMM_WORLD);
}

std::vector<std::size_t> Ranks::swap_bytes(std::span<const std::byte> mine,
                                           const std::vector<std::size_t>& sizes, const Room& room) const {
  const Waiting waiting(*this);
  const auto in_ints = [](const std::vector<std::size_t>& n) {
    if (std::accumulate(n.begin(), n.end(), std::size_t{0}) > std::numeric_limits<int>::max())
      throw std::runtime_error(too_large);
    return std::vector<int>(n.begin(), n.end());
  };
  const auto first = [](const std::vector<int>& n) {
    std::vector<int> places(n.size(), 0);
    std::partial_sum(n.begin(), n.end() - 1, places.begin() + 1);
    return places;
  };
  std::vector<std::size_t> come(sizes.size());
  MPI_Alltoall(sizes.data(), sizeof(std::size_t), MPI_BYTE, come.data(), sizeof(std::size_t), MPI_BYTE,
               MPI_COMM_WORLD);
  const std::vector<int> out = in_ints(sizes), in = in_ints(come);
  const std::vector<int> out_first = first(out), in_first = first(in);
  MPI_Alltoallv(mine.data(), out.data(), out_first.data(), MPI_BYTE,
                room(std::accumulate(come.begin(), come.end(), std::size_t{0})), in.data(), in_first.data(),
                MPI_BYTE, MPI_COMM_WORLD);
  return come;
}

void Ranks::send_bytes_to_leader(std::span<const std::byte> mine, const Room& room) const {
  const Waiting waiting(*this);
  const Counts n = counts(mine.size());
  MPI_Gatherv(mine.data(), static_cast<int>(mine.size()), MPI_BYTE, leads() ? room(n.all) : nullptr,
              n.of_rank.data(), n.first.data(), MPI_BYTE, 0, MPI_COMM_WORLD);
}

/// Nobody goes on before all know who could not.
void Ranks::together(const std::function<void()>& work) const {
  const Waiting waiting(*this);
  std::exception_ptr mine;
  std::string told;
  try {
    work();
  } catch (const std::runtime_error& e) {
    mine = std::current_exception();
    told = "on rank " + std::to_string(rank_) + ": " + e.what();
  }
  const std::string first = first_failure(told);
  if (first.empty()) return;
  has_failed_together_ = true;
  if (mine) std::rethrow_exception(mine);
  throw IoError(first);
}

}  // namespace vbond

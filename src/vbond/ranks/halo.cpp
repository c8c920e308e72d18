#include "vbond/ranks/halo.hpp"

#include <mpi.h>

#include <algorithm>
#include <type_traits>
#include <utility>

namespace vbond {
namespace {

constexpr std::size_t pose_numbers = 7, motion_numbers = 6, load_numbers = 6;

void put(const Vec3d& x, double*& to) {
  *to++ = x.x, *to++ = x.y, *to++ = x.z;
}
void put(const Quatd& q, double*& to) {
  *to++ = q.w, *to++ = q.x, *to++ = q.y, *to++ = q.z;
}
Vec3d take_vector(const double*& from) {
  from += 3;
  return {from[-3], from[-2], from[-1]};
}
Quatd take_quaternion(const double*& from) {
  from += 4;
  return {from[-4], from[-3], from[-2], from[-1]};
}

/// What each rank has for this one, from what this one has for each.
template <class T>
std::vector<std::vector<T>> all_to_all(const std::vector<std::vector<T>>& mine) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t ranks = mine.size();
  std::vector<int> out(ranks), in(ranks), out_first(ranks), in_first(ranks);
  std::vector<T> sent, received;
  for (std::size_t k = 0; k < ranks; ++k) {
    out[k] = static_cast<int>(mine[k].size() * sizeof(T));
    out_first[k] = static_cast<int>(sent.size() * sizeof(T));
    sent.insert(sent.end(), mine[k].begin(), mine[k].end());
  }
  MPI_Alltoall(out.data(), 1, MPI_INT, in.data(), 1, MPI_INT, MPI_COMM_WORLD);
  for (std::size_t k = 1; k < ranks; ++k) in_first[k] = in_first[k - 1] + in[k - 1];
  received.resize(static_cast<std::size_t>(in_first.back() + in.back()) / sizeof(T));
  MPI_Alltoallv(sent.data(), out.data(), out_first.data(), MPI_BYTE, received.data(), in.data(),
                in_first.data(), MPI_BYTE, MPI_COMM_WORLD);
  std::vector<std::vector<T>> of_ranks(ranks);
  auto next = received.begin();
  for (std::size_t k = 0; k < ranks; ++k) {
    const auto last = next + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(in[k]) / sizeof(T));
    of_ranks[k].assign(next, last);
    next = last;
  }
  return of_ranks;
}

/// Calls visit(ghost, rank) with the rank that has its particle, for all ghosts. No rank knows this of all
/// particles: each keeps a list of a share of their numbers, in which the others look up what they need.
template <class Visit>
void with_owners(const std::vector<ParticleId>& own, const std::vector<ImageOf>& ghosts,
                 std::size_t particles, std::size_t ranks, Visit visit) {
  const std::size_t share = std::max<std::size_t>(1, (particles + ranks - 1) / ranks);
  const auto keeper = [share](ParticleId p) { return p.value / share; };
  std::vector<std::vector<ParticleId>> has(ranks), asks(ranks);
  for (const ParticleId p : own) has[keeper(p)].push_back(p);
  for (const ImageOf& ghost : ghosts) asks[keeper(ghost.particle)].push_back(ghost.particle);
  std::vector<int> owner(share, 0);
  const std::vector<std::vector<ParticleId>> told = all_to_all(has), asked = all_to_all(asks);
  for (std::size_t rank = 0; rank < ranks; ++rank)
    for (const ParticleId p : told[rank]) owner[p.value % share] = static_cast<int>(rank);
  std::vector<std::vector<int>> answers(ranks);
  for (std::size_t rank = 0; rank < ranks; ++rank)
    for (const ParticleId p : asked[rank]) answers[rank].push_back(owner[p.value % share]);
  answers = all_to_all(answers);
  std::vector<std::size_t> next(ranks, 0);
  for (const ImageOf& ghost : ghosts) {
    const std::size_t at = keeper(ghost.particle);
    visit(ghost, static_cast<std::size_t>(answers[at][next[at]++]));
  }
}

}  // namespace

Halo::Halo(const std::vector<ParticleId>& own, const std::vector<ImageOf>& ghosts, std::size_t particles,
           const Exchange& ranks)
    : rank_(ranks.rank()) {
  const auto size = static_cast<std::size_t>(ranks.ranks());
  std::vector<std::vector<ImageOf>> from(size);
  std::vector<std::vector<ParticleId>> asked_for(size);
  with_owners(own, ghosts, particles, size, [&](const ImageOf& ghost, std::size_t rank) {
    from[rank].push_back(ghost);
    asked_for[rank].push_back(ghost.particle);
  });
  std::vector<std::vector<ParticleId>> asked_by = all_to_all(asked_for);
  for (std::size_t k = 0; k < size; ++k)
    if (!from[k].empty() || !asked_by[k].empty())
      neighbours_.push_back(
          {static_cast<int>(k), std::move(asked_by[k]), std::move(from[k]), {}, {}, {}, {}});
}

std::vector<ParticleId> Halo::sent() const {
  std::vector<ParticleId> all;
  for (const Neighbour& n : neighbours_) all.insert(all.end(), n.sent.begin(), n.sent.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

void Halo::take_rows(const Order& order) {
  for (Neighbour& n : neighbours_) {
    n.sent_rows.clear(), n.ghost_rows.clear();
    for (const ParticleId p : n.sent) n.sent_rows.push_back(order.row[p].value);
    for (const ImageOf& g : n.ghosts) n.ghost_rows.push_back(order.row_of(g.particle, g.image).value);
  }
}

/// `in` of all neighbours has the length of what comes.
void Halo::send_and_receive() {
  std::vector<MPI_Request> requests;
  for (Neighbour& n : neighbours_) {
    if (n.rank == rank_)
      std::swap(n.in, n.out);
    else if (!n.in.empty())
      MPI_Irecv(n.in.data(), static_cast<int>(n.in.size()), MPI_DOUBLE, n.rank, 0, MPI_COMM_WORLD,
                &requests.emplace_back());
  }
  for (Neighbour& n : neighbours_)
    if (n.rank != rank_ && !n.out.empty())
      MPI_Isend(n.out.data(), static_cast<int>(n.out.size()), MPI_DOUBLE, n.rank, 0, MPI_COMM_WORLD,
                &requests.emplace_back());
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

void Halo::update_ghosts(const HaloColumns& columns) {
  const bool motion = !columns.motion.empty();
  const std::size_t numbers = pose_numbers + (motion ? motion_numbers : 0);
  for (Neighbour& n : neighbours_) {
    n.out.resize(n.sent_rows.size() * numbers);
    n.in.resize(n.ghost_rows.size() * numbers);
    double* to = n.out.data();
    for (const std::size_t row : n.sent_rows) {
      put(columns.pose[row].r, to), put(columns.pose[row].q, to);
      if (motion) put(columns.motion[row].v, to), put(columns.motion[row].omega, to);
    }
  }
  send_and_receive();
  for (const Neighbour& n : neighbours_) {
    const double* from = n.in.data();
    for (std::size_t k = 0; k < n.ghost_rows.size(); ++k) {
      const std::size_t row = n.ghost_rows[k];
      columns.pose[row].r = take_vector(from), columns.pose[row].q = take_quaternion(from);
      if (motion) columns.motion[row].v = take_vector(from), columns.motion[row].omega = take_vector(from);
      columns.carry(row, n.ghosts[k].image);
    }
  }
}

void Halo::reverse_sum(std::span<LoadRow> load) {
  for (Neighbour& n : neighbours_) {
    n.out.resize(n.ghost_rows.size() * load_numbers);
    n.in.resize(n.sent_rows.size() * load_numbers);
    double* to = n.out.data();
    for (const std::size_t row : n.ghost_rows) put(load[row].F, to), put(load[row].M, to), load[row] = {};
  }
  send_and_receive();
  for (const Neighbour& n : neighbours_) {
    const double* from = n.in.data();
    for (const std::size_t row : n.sent_rows) {
      load[row].F += take_vector(from);
      load[row].M += take_vector(from);
    }
  }
}

}  // namespace vbond

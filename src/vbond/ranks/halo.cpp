#include "vbond/ranks/halo.hpp"

#include <mpi.h>

#include <algorithm>
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

}  // namespace

Halo::Halo(const std::vector<ImageOf>& ghosts, const std::vector<int>& owners, const Communicator& ranks)
    : rank_(ranks.rank()) {
  const auto size = static_cast<std::size_t>(ranks.ranks());
  std::vector<std::vector<ImageOf>> from(size);
  std::vector<std::vector<ParticleId>> asked_for(size);
  for (std::size_t k = 0; k < ghosts.size(); ++k) {
    const auto rank = static_cast<std::size_t>(owners[k]);
    from[rank].push_back(ghosts[k]);
    asked_for[rank].push_back(ghosts[k].particle);
  }
  std::vector<std::vector<ParticleId>> asked_by = ranks.swap(asked_for);
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

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

/// Numbers that this rank and its neighbours exchange, one message each way. What is sent waits in `out`
/// until the neighbour fetches it, which may be late: nobody waits for that before `out` is filled anew.
class Halo::Mail {
 public:
  struct Box {
    int rank = 0;
    std::vector<double> out, in;
  };
  Mail(int tag, const std::vector<Neighbour>& neighbours) : tag_(tag) {
    for (const Neighbour& n : neighbours) boxes.push_back({n.rank, {}, {}});
  }
  std::vector<Box> boxes;  ///< of each neighbour

  void wait_until_sent();
  /// Where to put so many numbers for a neighbour, which sends that many.
  double* room(std::size_t neighbour, std::size_t sent, std::size_t received) {
    boxes[neighbour].out.resize(sent), boxes[neighbour].in.resize(received);
    return boxes[neighbour].out.data();
  }
  void send(int this_rank);
  void wait_until_received();

 private:
  int tag_;
  std::vector<MPI_Request> sends_, receives_;
};

void Halo::Mail::wait_until_sent() {
  MPI_Waitall(static_cast<int>(sends_.size()), sends_.data(), MPI_STATUSES_IGNORE);
  sends_.clear();
}

void Halo::Mail::send(int this_rank) {
  for (Box& b : boxes) {
    if (b.rank == this_rank)
      std::swap(b.in, b.out);
    else if (!b.in.empty())
      MPI_Irecv(b.in.data(), static_cast<int>(b.in.size()), MPI_DOUBLE, b.rank, tag_, MPI_COMM_WORLD,
                &receives_.emplace_back());
  }
  for (const Box& b : boxes)
    if (b.rank != this_rank && !b.out.empty())
      MPI_Isend(b.out.data(), static_cast<int>(b.out.size()), MPI_DOUBLE, b.rank, tag_, MPI_COMM_WORLD,
                &sends_.emplace_back());
}

void Halo::Mail::wait_until_received() {
  MPI_Waitall(static_cast<int>(receives_.size()), receives_.data(), MPI_STATUSES_IGNORE);
  receives_.clear();
}

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
      neighbours_.push_back({static_cast<int>(k), std::move(asked_by[k]), std::move(from[k]), {}, {}});
  poses_ = std::make_shared<Mail>(0, neighbours_);
  loads_ = std::make_shared<Mail>(1, neighbours_);
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

void Halo::finish() {
  for (const auto& mail : {poses_, loads_})
    if (mail) mail->wait_until_sent();
}

void Halo::begin_update(const HaloColumns& columns) {
  const bool motion = !columns.motion.empty();
  const std::size_t numbers = pose_numbers + (motion ? motion_numbers : 0);
  poses_->wait_until_sent();
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    const Neighbour& n = neighbours_[k];
    double* to = poses_->room(k, n.sent_rows.size() * numbers, n.ghost_rows.size() * numbers);
    for (const std::size_t row : n.sent_rows) {
      put(columns.pose[row].r, to), put(columns.pose[row].q, to);
      if (motion) put(columns.motion[row].v, to), put(columns.motion[row].omega, to);
    }
  }
  poses_->send(rank_);
}

void Halo::end_update(const HaloColumns& columns) {
  const bool motion = !columns.motion.empty();
  poses_->wait_until_received();
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    const Neighbour& n = neighbours_[k];
    const double* from = poses_->boxes[k].in.data();
    for (std::size_t g = 0; g < n.ghost_rows.size(); ++g) {
      const std::size_t row = n.ghost_rows[g];
      columns.pose[row].r = take_vector(from), columns.pose[row].q = take_quaternion(from);
      if (motion) columns.motion[row].v = take_vector(from), columns.motion[row].omega = take_vector(from);
      columns.carry(row, n.ghosts[g].image);
    }
  }
}

void Halo::reverse_sum(std::span<LoadRow> load) {
  loads_->wait_until_sent();
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    const Neighbour& n = neighbours_[k];
    double* to = loads_->room(k, n.ghost_rows.size() * load_numbers, n.sent_rows.size() * load_numbers);
    for (const std::size_t row : n.ghost_rows) put(load[row].F, to), put(load[row].M, to), load[row] = {};
  }
  loads_->send(rank_);
  loads_->wait_until_received();
  for (std::size_t k = 0; k < neighbours_.size(); ++k) {
    const double* from = loads_->boxes[k].in.data();
    for (const std::size_t row : neighbours_[k].sent_rows) {
      load[row].F += take_vector(from);
      load[row].M += take_vector(from);
    }
  }
}

}  // namespace vbond

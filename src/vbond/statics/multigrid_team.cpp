#include "vbond/statics/detail/multigrid_team.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "vbond/statics/detail/one_blas_thread.hpp"
#include "vbond/statics/multigrid_ranks.hpp"

namespace vbond {
namespace {

int team = 1;                                     // processes
std::function<void(const std::string&)> end_all;  // of them

MPI_Comm processes() {
  return team == 1 ? PETSC_COMM_SELF : MPI_COMM_WORLD;
}

int rank() {
  int rank = 0;
  if (team > 1) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

/// What the first process asks the others to do with one of the preconditioners.
enum class Ask : int { end, make, apply, drop };
struct Order {
  Ask what = Ask::end;
  int id = 0;
};

Order told(Order order) {
  std::array<int, 2> numbers{static_cast<int>(order.what), order.id};
  MPI_Bcast(numbers.data(), 2, MPI_INT, 0, MPI_COMM_WORLD);
  return {static_cast<Ask>(numbers[0]), numbers[1]};
}
void tell(Order order) {
  if (team > 1) told(order);
}

/// Does what all do together. Where one cannot, the others would wait for it for ever.
template <class Work>
void together(const Work& work) {
  if (team == 1) return work();
  std::string why;
  try {
    return work();
  } catch (const std::bad_alloc&) {
    why = "no memory is left";
  } catch (const std::exception& e) {
    why = e.what();
  }
  end_all(fmt::format("multigrid: on rank {}: {}", rank(), why));
}

PetscInt first_block_of(int part, PetscInt blocks) {
  return static_cast<PetscInt>(std::int64_t{blocks} * part / team);
}

template <class T>
MPI_Datatype type_of();
template <>
MPI_Datatype type_of<double>() {
  return MPI_DOUBLE;
}
template <>
MPI_Datatype type_of<PetscInt>() {
  return MPIU_INT;
}

/// Calls pass(data, n) for all numbers, as many at a time as one message may have.
template <class T, class Pass>
void in_messages(T* data, std::size_t size, const Pass& pass) {
  constexpr std::size_t most = std::size_t{1} << 26;
  for (std::size_t first = 0; first < size; first += most)
    pass(data + first, static_cast<int>(std::min(most, size - first)));
}

template <class T>
void send(const std::vector<T>& numbers, int to) {
  const auto size = static_cast<unsigned long>(numbers.size());
  MPI_Send(&size, 1, MPI_UNSIGNED_LONG, to, 0, MPI_COMM_WORLD);
  in_messages(numbers.data(), numbers.size(),
              [to](const T* data, int n) { MPI_Send(data, n, type_of<T>(), to, 0, MPI_COMM_WORLD); });
}

template <class T>
std::vector<T> received() {
  unsigned long size = 0;
  MPI_Recv(&size, 1, MPI_UNSIGNED_LONG, 0, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  std::vector<T> numbers(size);
  in_messages(numbers.data(), numbers.size(), [](T* data, int n) {
    MPI_Recv(data, n, type_of<T>(), 0, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  });
  return numbers;
}

void send(const BlockRows& rows, int to) {
  send(std::vector<PetscInt>{rows.all}, to);
  send(rows.begin, to), send(rows.column, to), send(rows.value, to);
  send(std::vector<double>(rows.motions.data(), rows.motions.data() + rows.motions.size()), to);
}

BlockRows received_rows() {
  BlockRows rows;
  rows.all = received<PetscInt>()[0];
  rows.begin = received<PetscInt>(), rows.column = received<PetscInt>(), rows.value = received<double>();
  const std::vector<double> motions = received<double>();
  rows.motions = Eigen::Map<const DenseMatrix>(motions.data(), rows.size(), multigrid_block);
  return rows;
}

/// How many rows each part has, and where they begin.
struct Shares {
  std::vector<int> size, first;
  explicit Shares(PetscInt blocks) {
    for (int part = 0; part < team; ++part) {
      const PetscInt begin = first_block_of(part, blocks), end = first_block_of(part + 1, blocks);
      size.push_back(multigrid_block * (end - begin)), first.push_back(multigrid_block * begin);
    }
  }
};

/// What one that serves has of a preconditioner.
struct Served {
  MultigridPart part;
  PetscInt rows = 0;

  void make() {
    BlockRows given = received_rows();
    rows = given.size();
    part.make(processes(), std::move(given));
  }
  void apply() const {
    std::vector<double> b(static_cast<std::size_t>(rows)), x(b.size());
    MPI_Scatterv(nullptr, nullptr, nullptr, MPI_DOUBLE, b.data(), rows, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    part.apply(b.data(), x.data());
    MPI_Gatherv(x.data(), rows, MPI_DOUBLE, nullptr, nullptr, nullptr, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  }
};

void serve() {
  const OneBlasThread alone;
  std::map<int, Served> served;
  for (Order order = told({}); order.what != Ask::end; order = told({}))
    together([&] {
      if (order.what == Ask::make) served[order.id].make();
      if (order.what == Ask::apply) served[order.id].apply();
      if (order.what == Ask::drop) served.erase(order.id);
    });
}

}  // namespace

bool begin_multigrid_ranks(std::function<void(const std::string&)> ends) {
  end_all = std::move(ends);
  MPI_Comm_size(MPI_COMM_WORLD, &team);
  if (rank() == 0) return true;
  serve();
  return false;
}

void end_multigrid_ranks() {
  tell({Ask::end});
  team = 1;
}

MultigridTeam::MultigridTeam() {
  static int last = 0;
  id_ = ++last;
}

MultigridTeam::~MultigridTeam() {
  if (blocks_ > 0) tell({Ask::drop, id_});
}

void MultigridTeam::make(PetscInt blocks, const Rows& rows) {
  const OneBlasThread alone;
  blocks_ = blocks;
  tell({Ask::make, id_});
  together([&] {
    const auto of_part = [&](int part) {
      return rows(first_block_of(part, blocks), first_block_of(part + 1, blocks));
    };
    for (int part = team - 1; part > 0; --part) send(of_part(part), part);
    own_.make(processes(), of_part(0));
  });
}

void MultigridTeam::apply(const double* b, double* x) const {
  const OneBlasThread alone;
  if (team == 1) return own_.apply(b, x);
  tell({Ask::apply, id_});
  together([&] {
    const Shares shares(blocks_);
    std::vector<double> own_b(static_cast<std::size_t>(shares.size[0])), own_x(own_b.size());
    MPI_Scatterv(b, shares.size.data(), shares.first.data(), MPI_DOUBLE, own_b.data(), shares.size[0],
                 MPI_DOUBLE, 0, MPI_COMM_WORLD);
    own_.apply(own_b.data(), own_x.data());
    MPI_Gatherv(own_x.data(), shares.size[0], MPI_DOUBLE, x, shares.size.data(), shares.first.data(),
                MPI_DOUBLE, 0, MPI_COMM_WORLD);
  });
}

}  // namespace vbond

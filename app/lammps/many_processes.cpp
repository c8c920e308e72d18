// vbond-lammps: runs of vbond on many ranks. It links LAMMPS and so is under LAMMPS' licence, GPL-2.
#include "processes.hpp"

#include <fmt/core.h>
#include <mpi.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "commands.hpp"
#include "failure.hpp"
#include "refusals.hpp"
#include "vbond/core/error.hpp"
#include "vbond/ranks/ranks.hpp"

namespace vbond::app {
namespace {

/// What is freed goes back to the machine, which ranks share, for others to have. Left to itself glibc keeps
/// up to 32 MiB of each block, and set-up makes and frees many of these.
void give_memory_back() {
#ifdef __GLIBC__
  constexpr int from = 1 << 20;  // bytes; a step makes no blocks
  mallopt(M_MMAP_THRESHOLD, from);
#endif
}

/// Messages between ranks of one machine of up to 32 KiB, as small bodies have, go without a word before
/// them: Open MPI by itself asks first beyond 4 KiB. What the user has set stands.
void send_small_messages_at_once() {
  setenv("OMPI_MCA_btl_vader_eager_limit", "32768", 0);
}

/// The ranks of MPI. Rank 0 leads: the others are not heard, and do not hear signals.
class MpiRanks : public Processes {
 public:
  MpiRanks(int& argc, char**& argv) {
    give_memory_back();
    send_small_messages_at_once();
    MPI_Init(&argc, &argv);
    ranks_.emplace();
    if (ranks_->leads()) return;
    own_voice_ = fdopen(dup(STDERR_FILENO), "w");
    for (std::FILE* stream : {stdout, stderr})
      if (std::freopen("/dev/null", "w", stream) == nullptr) MPI_Abort(MPI_COMM_WORLD, failed);
    for (const int s : {SIGINT, SIGTERM, SIGHUP}) std::signal(s, SIG_IGN);  // rank 0 writes a checkpoint
  }
  ~MpiRanks() override {
    ranks_.reset();
    MPI_Finalize();
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  Partition* partition() override { return &*ranks_; }
  bool may_start_programs() const override { return false; }
  RanksHere here() const override { return {ranks_->on_this_machine(), ranks_->ranks()}; }
  std::string text_of_leader(const std::string& text) const override { return ranks_->text_of_leader(text); }

  int run(const std::function<int()>& work) override {
    try {
      const int status = work();
      return ranks_->leads() ? status : done;
    } catch (...) {
      const Failure failure = failure_under_way();
      if (!has_begun_ && !(have_met_ && failure.unforeseen))  // else the others may be at something else
        why_not(failure.text);
      else if (failure.unforeseen || (failure.status != failed && !all_know_of_it()))
        end_all(failure);
      if (ranks_->leads()) throw;
      return done;
    }
  }

  void meet() override {
    if (const std::string first = ranks_->first_failure({}); !first.empty()) {
      has_begun_ = none_begins_ = true;
      throw IoError("on another rank: " + first);
    }
    have_met_ = true;
  }
  void begin_together(const Case& c) override {
    refuse_beyond_ranks(c);
    if (const std::string first = why_not({}); !first.empty()) throw IoError("on another rank: " + first);
  }

  std::string remarks() const override {
    const double imbalance = ranks_->imbalance();
    return fmt::format(
        "{} times a particle went to another rank; particles were spread anew {} times\n"
        "the rank with the most work worked {:.2f} times as long as the mean\n",
        ranks_->migrations(), ranks_->redistributions(), imbalance);
  }

 private:
  /// What stands in the way of the first rank that cannot begin.
  std::string why_not(const std::string& mine) {
    has_begun_ = true;
    const std::string first = ranks_->first_failure(mine);
    none_begins_ = !first.empty();
    return first;
  }
  bool all_know_of_it() const { return none_begins_ || ranks_->has_failed_together(); }

  /// Others may wait for this rank for ever.
  [[noreturn]] void end_all(const Failure& failure) const {
    std::FILE* const voice = own_voice_ != nullptr ? own_voice_ : stderr;
    std::fprintf(voice, "%s\n", failure.text.c_str());
    std::fflush(voice);
    MPI_Abort(MPI_COMM_WORLD, failure.status);
    std::terminate();
  }

  std::optional<Ranks> ranks_;
  std::FILE* own_voice_ = nullptr;  // of one that does not lead
  bool have_met_ = false, has_begun_ = false, none_begins_ = false;
};

}  // namespace

const char* const program_name = "vbond-lammps";
const char* const program_note =
    "\nIt links LAMMPS (https://www.lammps.org), so this program is under the GNU General Public License, "
    "version 2;\nvbond's own sources stay under the licence of vbond.";

const bool has_ranks = true;

std::unique_ptr<Processes> start_processes(int& argc, char**& argv) {
  return std::make_unique<MpiRanks>(argc, argv);
}

}  // namespace vbond::app

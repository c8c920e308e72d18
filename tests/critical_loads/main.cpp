// The campaign that proves critical loads: random slender bodies, judged by a reference of its own. See
// reference.hpp and judge.hpp. Exit status 1 if anything was missed, wrong or aborted, or if more than 0.5 %
// gave up or stopped short or 2 % have no reference; 2 if a case is without a record.
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <fstream>
#include <new>
#include <thread>

#include "case_file.hpp"
#include "child.hpp"
#include "records.hpp"
#include "shells.hpp"
#include "table.hpp"

namespace vbond::campaign {
namespace {

struct Options {
  unsigned seed = 1;
  int first = 0, cases = 2000, jobs = static_cast<int>(std::thread::hardware_concurrency());
  double seconds = 0;
  std::vector<int> only;
  int number(int k) const { return only.empty() ? first + k : only[static_cast<std::size_t>(k)]; }
  bool verbose = false, perfect = false, of_shells = false;
  std::string dump, case_file, records;
  int count = 6;
};

/// Takes cases until there are none left; one line of JSON each.
void work(const Options& o, std::atomic<int>& next, int to) {
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - start;
    const int k = next.fetch_add(1);
    if (k >= o.cases || (o.seconds > 0 && gone.count() > o.seconds)) return;
    const CaseRecord record = o.of_shells ? run_shell(random_shell(o.seed, o.number(k)))
                                          : run_case(random_case(o.seed, o.number(k)));
    const std::string line = nlohmann::json(record).dump() + "\n";
    for (std::size_t done = 0; done < line.size();) {
      const ssize_t n = write(to, line.data() + done, line.size() - done);
      if (n <= 0) return;
      done += static_cast<std::size_t>(n);
    }
  }
}

/// Lines of a worker as they come.
class Lines {
 public:
  explicit Lines(int from) : from_(from) {}
  int descriptor() const { return from_; }
  /// False at the end.
  template <class F>
  bool read_some(F&& each) {
    char buffer[65536];
    const ssize_t n = read(from_, buffer, sizeof buffer);
    if (n <= 0) return false;
    text_.append(buffer, static_cast<std::size_t>(n));
    for (std::size_t end; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1))
      each(text_.substr(0, end));
    return true;
  }

 private:
  int from_;
  std::string text_;
};

std::vector<Lines> start_workers(const Options& o, std::atomic<int>& next) {
  std::vector<Lines> workers;
  for (int k = 0; k < std::max(1, o.jobs); ++k) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) {
      close(ends[0]);
      work(o, next, ends[1]);
      _exit(0);
    }
    close(ends[1]);
    workers.emplace_back(ends[0]);
  }
  return workers;
}

std::vector<CaseRecord> run_all(const Options& o) {
  void* shared =
      mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::bad_alloc();
  auto& next = *new (shared) std::atomic<int>(0);
  std::vector<Lines> workers = start_workers(o, next);
  std::vector<CaseRecord> records;
  std::ofstream kept;
  if (!o.records.empty()) kept.open(o.records);
  const auto take = [&](const std::string& line) {
    if (kept.is_open()) kept << line << std::endl;
    records.push_back(nlohmann::json::parse(line).get<CaseRecord>());
    if (o.verbose) print_case(records.back()), std::fflush(stdout);
  };
  while (!workers.empty()) {
    std::vector<pollfd> waiting;
    for (const Lines& w : workers) waiting.push_back({w.descriptor(), POLLIN, 0});
    poll(waiting.data(), waiting.size(), -1);
    for (std::size_t k = workers.size(); k-- > 0;)
      if (waiting[k].revents != 0 && !workers[k].read_some(take))
        workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(k));
  }
  while (wait(nullptr) > 0) continue;
  return records;
}

/// The case as two files for `vbond run`: NAME-buckling.toml and NAME-path.toml.
void dump(const Options& o, int number) {
  if (o.of_shells) {
    std::ofstream(o.dump + "-buckling.toml") << random_shell(o.seed, number).text;
    return;
  }
  RandomCase c = random_case(o.seed, number);
  if (o.perfect) c.plan = perfect(c.plan);
  const testing::Specimen s = specimen_of(c.plan);
  const StaticStage buckling = buckling_stage_of(c);
  const Reference reference = find_reference(s.model, buckling, s.state, {c.count, 0, false, 6000});
  std::ofstream(o.dump + "-buckling.toml") << to_toml(c.plan, buckling);
  std::ofstream(o.dump + "-path.toml") << to_toml(c.plan, path_stage_of(c, reference));
}

int run(const Options& o) {
  if (!o.case_file.empty()) return print_reference_of(o.case_file, o.count);
  if (!o.dump.empty()) {
    dump(o, o.number(0));
    return 0;
  }
  const auto start = std::chrono::steady_clock::now();
  const std::vector<CaseRecord> records = run_all(o);
  const int status = print_table(records);
  if (o.seconds == 0 && static_cast<int>(records.size()) != o.cases) {
    fmt::print(stderr, "{} of {} cases have no record: a worker ended early\n",
               o.cases - static_cast<int>(records.size()), o.cases);
    return 2;
  }
  const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - start;
  fmt::print("seed {}, {} cases from {}, {} jobs, {:.0f} s\n", o.seed, records.size(), o.first, o.jobs,
             gone.count());
  return status;
}

}  // namespace
}  // namespace vbond::campaign

int main(int argc, char** argv) {
  vbond::campaign::Options o;
  CLI::App app("Critical loads of random slender bodies, held against a reference of its own");
  app.add_option("--seed", o.seed, "of all cases");
  app.add_option("--cases", o.cases, "how many")->capture_default_str();
  CLI::Option* shells = app.add_option("--shells", o.cases, "so many thin shells instead");
  app.add_option("--first", o.first, "number of the first case");
  app.add_option("--only", o.only, "these cases alone, in full");
  app.add_option("--seconds", o.seconds, "begin no case after so long; 0: no limit");
  app.add_option("--jobs", o.jobs, "processes at a time")->capture_default_str();
  app.add_flag("--verbose", o.verbose, "print every case");
  app.add_option("--records", o.records, "keep one line of JSON per case in this file");
  app.add_option("--dump", o.dump, "write the case of --only as NAME-buckling.toml and NAME-path.toml");
  app.add_flag("--perfect", o.perfect, "--dump writes the body without its imperfection");
  app.add_option("--reference-of", o.case_file, "print the reference of a case file's first stage");
  app.add_option("--count", o.count, "critical loads wanted of --reference-of")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  o.of_shells = shells->count() > 0;
  if (!o.only.empty()) o.cases = static_cast<int>(o.only.size()), o.verbose = true;
  try {
    return vbond::campaign::run(o);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  }
}

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "inputs.hpp"
#include "test_command.hpp"
#include "vbond/core/error.hpp"
#include "vbond/labtest/made_test.hpp"
#include "vbond/observe/files.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// Beside the case of a test: what its run would have printed.
constexpr const char* test_log = "log.txt";

/// A standard stream goes to a file while this lives.
class Redirected {
 public:
  Redirected(std::FILE* stream, const fs::path& file) : stream_(stream) {
    std::fflush(stream_);
    kept_ = dup(fileno(stream_));
    const int to = kept_ < 0 ? -1 : open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (to < 0) return;  // then the run prints
    dup2(to, fileno(stream_));
    close(to);
  }
  ~Redirected() {
    std::fflush(stream_);
    if (kept_ < 0) return;
    dup2(kept_, fileno(stream_));
    close(kept_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

 private:
  std::FILE* stream_;
  int kept_ = -1;
};

/// Takes away what has been written of a test that is refused before its run begins.
void discard(const fs::path& folder, bool one_of_several) {
  std::error_code e;
  fs::remove_all(folder / inputs_folder, e), fs::remove(folder / test_log, e);
  fs::remove(folder / "test.toml", e), fs::remove(folder, e);
  if (one_of_several) fs::remove(folder.parent_path(), e);  // if it is empty
}

/// Mistakes of the made case, which is not kept, at the case that it was made of.
CaseError as_of(const fs::path& case_file, const CaseError& of_test) {
  std::vector<Problem> problems = of_test.problems();
  for (Problem& p : problems) {
    p.what = "in the case of the test, " + p.what;
    p.place = {case_file.string(), 0, 0};
  }
  return CaseError(std::move(problems));
}

/// Runs the made case as `vbond run` does. What is refused before it begins leaves nothing.
int run_made(const RunOptions& options, const fs::path& folder, Prints prints, bool one_of_several) {
  RunOptions made = options;
  made.case_file = folder / "test.toml";
  made.changes.clear();
  made.folder = folder / "run";
  const auto has_begun = [&] {
    std::error_code e;
    return fs::exists(folder / "run", e);
  };
  try {
    std::optional<Redirected> out, err;
    if (prints == Prints::failures) out.emplace(stdout, "/dev/null");
    if (prints == Prints::nothing)
      out.emplace(stdout, folder / test_log), err.emplace(stderr, folder / test_log);
    return run(made);
  } catch (const CaseError& e) {
    if (has_begun()) throw;
    discard(folder, one_of_several);
    throw as_of(options.case_file, e);
  } catch (...) {
    if (has_begun() && prints == Prints::nothing) throw;
    if (has_begun())
      say("the run of the test has failed: no result; the case is " + (folder / "test.toml").string() +
              ", its run " + (folder / "run").string() + "\n",
          stderr);
    else
      discard(folder, one_of_several);
    throw;
  }
}

}  // namespace

int write_and_run(const RunOptions& options, Case c, const labtest::MadeTest& made, const TestText& text,
                  const fs::path& folder, bool one_of_several) {
  make_folder(folder);
  const Case written = keep_inputs(c, folder, {});
  replace_file(folder / "test.toml", labtest::case_text(written, made, text.title, text.command));
  return run_made(options, folder, text.prints, one_of_several);
}

}  // namespace vbond::app

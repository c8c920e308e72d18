#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/printable.hpp"

namespace vbond {

/// Where in a case file something stands; line 0 means "no single place".
struct SourcePlace {
  std::string file;
  std::uint32_t line = 0, column = 0;
};

/// One mistake in a user's input: where, what, the rule it breaks, and a way out.
struct Problem {
  SourcePlace place;
  std::string what;      ///< e.g. "bonds[0].nu = 0.5"
  std::string rule;      ///< e.g. "must satisfy -1 < nu < 0.5: ..."
  std::string way_out;   ///< e.g. "use nu <= 0.49, or theory = ..."
  std::size_t more = 0;  ///< how many others of its kind are not told, see Problems
};

/// Renders problems as `file:line:column: what`, then rule and way out indented by two blanks, and the number
/// of others of its kind.
std::string to_text(const std::vector<Problem>& problems);

/// Wrong user input, all of it at once. Thrown only in case/ and setup/. Exit status 2.
class CaseError : public std::runtime_error {
 public:
  explicit CaseError(std::vector<Problem> problems)
      : std::runtime_error(to_text(problems)), problems_(std::move(problems)) {}
  explicit CaseError(Problem problem) : CaseError(std::vector<Problem>{std::move(problem)}) {}
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// The run went unphysical; nothing written before is lost. Exit status 1.
class Diverged : public std::runtime_error {
 public:
  /// subject: e.g. "bond 17 (particles 4, 9)"; finding: what is wrong, with its value.
  Diverged(std::int64_t at_step, double at_time, const std::string& subject, const std::string& finding,
           const std::string& advice)
      : std::runtime_error(
            printable("step " + std::to_string(at_step) + ": " + subject + ": " + finding + "\n  " + advice)),
        step(at_step),
        time(at_time) {}
  std::int64_t step;
  double time;
};

/// A static stage found no balance, or no answer about it; what was found before is kept. Exit status 1.
class NoEquilibrium : public std::runtime_error {
 public:
  /// finding: what stood in the way, naming the load factor reached or the degrees of freedom.
  NoEquilibrium(const std::string& stage, const std::string& finding, const std::string& advice)
      : std::runtime_error(printable("stage \"" + stage + "\": " + finding + "\n  " + advice)) {}
  /// Of several stages: their texts.
  explicit NoEquilibrium(const std::string& texts) : std::runtime_error(texts) {}
};

/// Eigenvalues could not be found: no matrix near by can be factored, or iteration does not end.
class NoConvergence : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file or folder could not be read or written. Exit status 3.
class IoError : public std::runtime_error {
 public:
  explicit IoError(const std::string& text) : std::runtime_error(printable(text)) {}
};

}  // namespace vbond

#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cases.hpp"
#include "reference.hpp"

namespace vbond::campaign {

/// What became of a stage, held against the reference.
enum class Verdict : std::uint8_t {
  right,
  missed,    ///< a critical load is not told of, although the search claims to have gone beyond it
  wrong,     ///< one is told of that is not there, or it is off, or of the wrong kind
  short_of,  ///< it says that it stopped before, and did
  gave_up,   ///< NoEquilibrium
  aborted,   ///< another exception, a crash, no end
  no_reference
};
inline constexpr int verdicts = 7;
const char* name_of(Verdict v);

/// What a stage answered.
struct Answer {
  std::string failure;  ///< "gave up", "aborted" or none
  std::string message;  ///< of the failure
  std::string ended;
  std::vector<ReferencePoint>
      loads;  ///< of buckling all, of a path the first special point; errors are gaps told
  double searched_to = 0;
  int factors = 0;
  double seconds = 0;
};

struct Judgement {
  Verdict verdict = Verdict::right;
  std::string why;  ///< of anything but right; of right, what lets it pass
};

/// A critical load is right if it is within 1e-6 of the reference, or four times the error of the reference,
/// which is what rounding of the tangent lets be known: 8 eps max |K_ii| over |d eigenvalue / d load factor|.
///
/// Of a body with an imperfection of less than 1e-4 of its thickness the branches that cross in the perfect
/// body pass each other by less than a step can see. There an answer is right, too, if it is that of the path
/// seen from a thousand times nearer, or if its first load is the perfect body's to within
/// 0.1 sqrt(imperfection), 1e-3 at most: Koiter's laws, in which critical loads change as the power 1/2 or
/// 2/3.
///
/// A load that was told with a gap is right if it is within three times that of a load of the body; what is
/// told after it is not judged. If it is within as much of one of the perfect body, or if the body's own path
/// turns by 0.3 rad within as much of it, it is a remark: the answer without it must be right.
///
/// Other bodies have branches that nearly meet as well, without an imperfection that anybody has made. Where
/// the reference had to look closer than a hundred thousandth of its step to see two branches pass each
/// other, an answer within 1e-4 of there is right, too, and what is told after it is not judged. Such cases
/// are counted.
struct Tolerance {
  double least = 1e-6;
};

Judgement judge_buckling(const Answer& answer, const Reference& reference, int count,
                         const Tolerance& tolerance);
Judgement judge_path(const Answer& answer, const Reference& reference, const Tolerance& tolerance);

/// A path may end at its first special point, or at its first limit point.
enum class Until : std::uint8_t { end, first_special_point, first_limit_point };
/// Runs a stage.
Answer answer_of_stage(const Model& model, const State& state, const StaticStage& stage, Until until);
/// The same, or some like it, in a process of its own that may crash or take too long.
Answer answer_in_child(const std::function<Answer()>& ask, int seconds);

/// All about one case, as it is handed from process to process.
struct CaseRecord {
  int number = 0;
  std::string kind, what;
  Reference reference;
  Answer buckling, path;
  Judgement of_buckling, of_path;
  double reference_seconds = 0;
};

/// Runs buckling, reference and path of a case, each in a process of its own that may crash or hang.
CaseRecord run_case(const RandomCase& c);

/// The path stage of a case: its step and its end are taken from the reference.
StaticStage path_stage_of(const RandomCase& c, const Reference& reference);
StaticStage buckling_stage_of(const RandomCase& c);

}  // namespace vbond::campaign

// Records as JSON, to hand them from process to process.
#include "records.hpp"

namespace vbond::campaign {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReferencePoint, kind, load_factor, error, regained, beyond_range)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Reference::Turning, load_factor, turned)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Reference, points, searched_to, unstable_at_start, ended, undecided, nodes,
                                   passings, turning)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Answer, failure, message, ended, loads, searched_to, factors, seconds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Judgement, verdict, why)

nlohmann::json json_of(const Reference& r) {
  return r;
}
nlohmann::json json_of(const Answer& a) {
  return a;
}
Reference reference_of(const nlohmann::json& j) {
  return j.get<Reference>();
}
Answer answer_of(const nlohmann::json& j) {
  return j.get<Answer>();
}

void to_json(nlohmann::json& j, const CaseRecord& r) {
  j = {{"number", r.number},
       {"kind", r.kind},
       {"what", r.what},
       {"reference", json_of(r.reference)},
       {"buckling", json_of(r.buckling)},
       {"path", json_of(r.path)},
       {"of_buckling", nlohmann::json(r.of_buckling)},
       {"of_path", nlohmann::json(r.of_path)},
       {"reference_seconds", r.reference_seconds}};
}

void from_json(const nlohmann::json& j, CaseRecord& r) {
  r = {j.at("number"),
       j.at("kind"),
       j.at("what"),
       reference_of(j.at("reference")),
       answer_of(j.at("buckling")),
       answer_of(j.at("path")),
       j.at("of_buckling").get<Judgement>(),
       j.at("of_path").get<Judgement>(),
       j.at("reference_seconds")};
}

}  // namespace vbond::campaign

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <map>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "vbond/case/calibration.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"

namespace vbond::python {
namespace {

SharedCase parse(const std::string& text, const std::filesystem::path& file,
                 const std::vector<std::string>& changes, bool places) {
  try {
    return std::make_shared<Case>(parse_case(text, file, changes, SetTwice::last_wins));
  } catch (const CaseError& e) {
    if (places) throw;
    throw without_places(e);
  }
}

py::dict calibrate(const std::map<std::string, std::string>& given) {
  CalibrateOptions o;
  const std::map<std::string, std::string*> fields{{"E", &o.E},
                                                   {"nu", &o.nu},
                                                   {"length", &o.length},
                                                   {"diameter", &o.diameter},
                                                   {"inner_diameter", &o.inner_diameter},
                                                   {"side", &o.side},
                                                   {"A", &o.A},
                                                   {"J", &o.J},
                                                   {"J_p", &o.J_p},
                                                   {"kappa", &o.kappa},
                                                   {"thickness", &o.thickness},
                                                   {"theory", &o.theory}};
  for (const auto& [name, value] : given) *fields.at(name) = value;
  py::dict theories;
  for (const CalibratedTheory& t : calibration(o).theories) {
    if (!t.left_out.empty()) continue;
    using namespace py::literals;
    py::dict theory("c_A"_a = t.c.c_A, "c_D"_a = t.c.c_D, "c_B"_a = t.c.c_B, "c_T"_a = t.c.c_T);
    for (const auto& [law, coefficients] : t.laws) {
      py::dict of_law;
      for (const auto& [name, value] : coefficients) of_law[py::str(name)] = value;
      theory[py::str(law)] = of_law;
    }
    theories[py::str(t.name)] = theory;
  }
  return theories;
}

}  // namespace

CaseError without_places(const CaseError& e) {
  std::vector<Problem> problems = e.problems();
  for (Problem& p : problems)
    if (p.place.line > 0) p.place = {};
  return CaseError(std::move(problems));
}

void bind_cases(py::module_& m) {
  using namespace py::literals;
  py::class_<Case, std::shared_ptr<Case>>(m, "CheckedCase")
      .def_readonly("title", &Case::title)
      .def("to_toml", [](const Case& c) { return to_toml(c); });
  m.def(
      "read_case",
      [](const std::filesystem::path& file, const std::vector<std::string>& changes) {
        return std::make_shared<Case>(read_case(file, changes));
      },
      "file"_a, "changes"_a);
  m.def(
      "parse_case",
      [](const std::string& text, const std::filesystem::path& file, const std::vector<std::string>& changes,
         bool places) { return std::const_pointer_cast<Case>(parse(text, file, changes, places)); },
      "text"_a, "file"_a, "changes"_a, "places"_a);
  m.def("calibrate", &calibrate, "given"_a);
  m.def("list_keys", [] {
    py::list keys;
    for (const KeyEntry& k : list_keys())
      keys.append(py::dict("path"_a = k.path, "type"_a = k.type, "default"_a = k.default_text,
                           "meaning"_a = k.meaning, "condition"_a = k.condition));
    return keys;
  });
}

}  // namespace vbond::python

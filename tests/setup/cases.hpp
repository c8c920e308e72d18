#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>

#include "vbond/core/near_pairs.hpp"
#include "vbond/setup/build.hpp"

/// Cases put together by hand, as the reader of case files would make them.
namespace vbond::test {

/// The paper's parameters of rod and shell: Bernoulli-Euler, d/a = 0.2, nu = 0.2, c_A = 1 at a = 1.
inline BondRecipe paper_recipe() {
  TheoryParameters theory;
  theory.section = circle(0.2);
  theory.material = {1.0 / theory.section.A, 0.2};
  BondRecipe recipe;
  recipe.parameters = theory;
  return recipe;
}

template <class Shape>
SpecimenSpec specimen(Shape shape, const std::string& name = "body") {
  SpecimenSpec spec;
  spec.place = {"case.toml", 3, 1};
  spec.name = name;
  spec.shape = std::move(shape);
  spec.radius = 0.4;
  spec.mass = 1.0;
  return spec;
}

inline BondSpec bonds_within(double distance) {
  BondSpec bonds;
  bonds.place = {"case.toml", 10, 1};
  bonds.name = "bonds";
  bonds.between = {Placed<std::string>{"all", {"case.toml", 11, 1}},
                   Placed<std::string>{"all", {"case.toml", 11, 9}}};
  bonds.select = {WithinDistance{distance}, {"case.toml", 12, 1}};
  bonds.recipe = paper_recipe();
  return bonds;
}

inline StageSpec stage(const std::string& name = "run") {
  StageSpec s;
  s.place = {"case.toml", 20, 1};
  s.name = name;
  s.duration = {100.0, true};
  return s;
}

template <class Shape>
Case case_of(Shape shape) {
  Case c;
  c.file = "case.toml";
  c.specimens.push_back(specimen(std::move(shape)));
  c.stages.push_back(stage());
  return c;
}

/// The paper's rod of N = 10: radius 0.4 makes its inertia 0.064.
inline Case paper_rod() {
  Case c = case_of(RodSpecimen{10, 1.0, {}, {1, 0, 0}});
  c.bonds.push_back(bonds_within(1.1));
  return c;
}

inline std::string text_of_error(const Case& c) {
  try {
    build(c);
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

inline std::string text_of_stage_error(const Case& c) {
  Built b = build(c);
  try {
    build_stage(c, b.model, 0, b.state);
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

/// Number of neighbours within `distance` of each particle.
inline std::vector<int> coordination(const Model& model, double distance) {
  std::vector<int> n(model.particles(), 0);
  for_near_pairs(model.r_0.values(), distance, [&](std::size_t i, std::size_t j, double) { ++n[i], ++n[j]; });
  return n;
}

inline double nearest_distance(const Model& model, double within) {
  double least = INFINITY;
  for_near_pairs(model.r_0.values(), within,
                 [&](std::size_t, std::size_t, double d2) { least = std::min(least, std::sqrt(d2)); });
  return least;
}

inline std::vector<std::size_t> numbers(const Model& model, const std::string& group) {
  std::vector<std::size_t> found;
  const Group* g = model.find_group(group);
  if (g == nullptr) ADD_FAILURE() << "no group " << group;
  if (g != nullptr)
    for (const ParticleId p : g->particles) found.push_back(p.value);
  return found;
}

/// A text file that exists as long as this object.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "-" + name)) {
    std::ofstream(path_) << text;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace vbond::test

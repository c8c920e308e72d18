#pragma once
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/case/value.hpp"

/// Codecs of values that one or two keys have.
namespace vbond::keys {

/// A time, or "exact".
struct StepCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path,
            std::variant<CaseTime, ExactStep>& out) const;
  std::string write(const std::variant<CaseTime, ExactStep>& step) const;
  std::string type() const { return TimeCodec{}.type() + ", or \"exact\""; }
  std::string schema() const { return any_of({TimeCodec{}.schema(), enum_schema({"exact"})}); }
  std::string example(UnitSystem u) const { return TimeCodec{}.example(u); }
};

/// A volume, or how to work it out.
struct StressVolumeCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path,
            std::variant<double, StressVolume>& out) const;
  std::string write(const std::variant<double, StressVolume>& x) const;
  std::string type() const { return positive(volume).type() + ", \"box\" or \"spheres\""; }
  std::string schema() const { return any_of({positive(volume).schema(), enum_schema({"box", "spheres"})}); }
  std::string example(UnitSystem) const { return "\"box\""; }
};

/// [[t, factor], ...]: increasing times of one kind; zero is of any kind.
struct TimeTableCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path,
            std::vector<std::pair<CaseTime, double>>& out) const;
  std::string write(const std::vector<std::pair<CaseTime, double>>& points) const;
  std::string type() const { return "list of [time, factor]"; }
  std::string schema() const { return list_schema(list_schema(any_number.schema(), 2, 2), 1); }
  std::string example(UnitSystem) const { return "[[0, 0.0], [\"10 T0\", 1.0]]"; }
};

/// What a support holds: names of degrees of freedom, and directions of translations.
struct FixCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, SupportSpec& out) const;
  std::string write(const SupportSpec& s) const;
  std::string type() const { return "list of " + join(names(), "\"") + " or " + direction_vector.type(); }
  std::string schema() const {
    return list_schema(any_of({enum_schema(names()), direction_vector.schema()}), 0);
  }
  std::string example(UnitSystem) const { return "[\"x\"]"; }

 private:
  static const std::vector<std::string>& names();
};

/// Where a bond is fastened: "centres", "surfaces", a distance, or one for each end.
struct AttachCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, BondRecipe& out) const;
  std::string write(const BondRecipe& r) const;
  std::string type() const { return "\"centres\", \"surfaces\", \"neck\", length >= 0, or [R_i, R_j]"; }
  std::string schema() const {
    return any_of({enum_schema({"centres", "surfaces", "neck"}), from_zero.schema(),
                   list_schema(from_zero.schema(), 2, 2)});
  }
  std::string example(UnitSystem) const { return "\"centres\""; }
};

}  // namespace vbond::keys

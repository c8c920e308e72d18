#include "vbond/case/special_values.hpp"

#include <array>

#include "vbond/case/value_lists.hpp"

namespace vbond::keys {

const std::vector<std::string>& FixCodec::names() {
  static const std::vector<std::string> all{"x", "y", "z", "rx", "ry", "rz"};
  return all;
}

bool FixCodec::read(const Node& n, ReadContext& in, const std::string& path, SupportSpec& out) const {
  const auto* items = std::get_if<NodeList>(&n.value);
  if (!items) return refuse_subset(n, in, path, names());
  NodeList words;
  std::vector<Vec3d> along;
  bool good = true;
  for (std::size_t k = 0; k < items->size(); ++k) {
    const Node& item = (*items)[k];
    if (!std::holds_alternative<NodeList>(item.value)) {
      words.push_back(item);
      continue;
    }
    Vec3d direction;
    good = direction_vector.read(item, in, path + "[" + std::to_string(k) + "]", direction) && good;
    along.push_back(direction);
  }
  Node named = n;
  named.value = std::move(words);
  if (!SubsetCodec<6>{names()}.read(named, in, path, out.held) || !good) return false;
  out.along = std::move(along);
  return true;
}

std::string FixCodec::write(const SupportSpec& s) const {
  std::string text = SubsetCodec<6>{names()}.write(s.held);
  for (const Vec3d& d : s.along)
    text.insert(text.size() - 1, (text.size() > 2 ? ", " : "") + direction_vector.write(d));
  return text;
}

bool StepCodec::read(const Node& n, ReadContext& in, const std::string& path,
                     std::variant<CaseTime, ExactStep>& out) const {
  const auto* word = std::get_if<std::string>(&n.value);
  if (!word || word->find_first_of("0123456789") != std::string::npos)
    return TimeCodec{}.read(n, in, path, out.emplace<CaseTime>());
  std::size_t index = 0;
  if (!read_word(n, in, path, {"exact"}, index)) return false;
  out = ExactStep{};
  return true;
}

std::string StepCodec::write(const std::variant<CaseTime, ExactStep>& step) const {
  const auto* given = std::get_if<CaseTime>(&step);
  return given ? TimeCodec{}.write(*given) : "\"exact\"";
}

bool StressVolumeCodec::read(const Node& n, ReadContext& in, const std::string& path,
                             std::variant<double, StressVolume>& out) const {
  const auto* word = std::get_if<std::string>(&n.value);
  if (!word || word->find_first_of("0123456789") != std::string::npos)
    return positive(volume).read(n, in, path, out.emplace<double>());
  std::size_t index = 0;
  if (!read_word(n, in, path, {"box", "spheres"}, index)) return false;
  out = index == 0 ? StressVolume::box : StressVolume::spheres;
  return true;
}

std::string StressVolumeCodec::write(const std::variant<double, StressVolume>& x) const {
  if (const double* given = std::get_if<double>(&x)) return positive(volume).write(*given);
  return std::get<StressVolume>(x) == StressVolume::box ? "\"box\"" : "\"spheres\"";
}

bool TimeTableCodec::read(const Node& n, ReadContext& in, const std::string& path,
                          std::vector<std::pair<CaseTime, double>>& out) const {
  const auto* rows = std::get_if<NodeList>(&n.value);
  if (!rows) return in.refuse_kind(n, path, type(), example(in.units));
  std::vector<std::pair<CaseTime, double>> points;
  bool good = true;
  for (std::size_t k = 0; k < rows->size(); ++k) {
    const Node& row = (*rows)[k];
    const std::string at = path + "[" + std::to_string(k) + "]";
    const auto* pair = std::get_if<NodeList>(&row.value);
    if (!pair) {
      good = in.refuse_kind(row, at, "[time, factor]", "[\"10 T0\", 1.0]");
    } else if (pair->size() != 2) {
      good = refuse_length(row, in, at, pair->size(), 2, "[\"10 T0\", 1.0]");
    } else {
      std::pair<CaseTime, double> p;
      const bool time_good = TimeCodec{from_zero}.read((*pair)[0], in, at + "[0]", p.first);
      good = number(pure).read((*pair)[1], in, at + "[1]", p.second) && time_good && good;
      points.push_back(p);
    }
  }
  if (!good) return false;
  if (points.empty()) return in.refuse(n, path, "must have at least one point", "write " + example(in.units));
  for (std::size_t k = 1; k < points.size(); ++k) {
    const CaseTime& a = points[k - 1].first;
    const CaseTime& b = points[k].first;
    const bool zero = (k == 1 && a.value == 0.0) || b.value == 0.0;
    if (a.in_T_0 != b.in_T_0 && !zero)
      return in.refuse((*rows)[k], path, "times must be all bare numbers or all multiples of T0",
                       "write every time as \"10 T0\" or none");
    if (b.value <= a.value)
      return in.refuse((*rows)[k], path, "the times of a table must increase",
                       "sort the rows by their time; a jump takes two times that are nearly the same");
  }
  const bool in_T_0 = points.back().first.in_T_0;
  for (auto& p : points)
    if (p.first.value == 0.0) p.first.in_T_0 = in_T_0;  // zero is zero in any unit
  out = std::move(points);
  return true;
}

std::string TimeTableCodec::write(const std::vector<std::pair<CaseTime, double>>& points) const {
  if (points.empty()) return {};
  std::string text = "[";
  for (const auto& [t, factor] : points)
    text += (text.size() > 1 ? ", [" : "[") + TimeCodec{}.write(t) + ", " + number_text(factor) + "]";
  return text + "]";
}

bool AttachCodec::read(const Node& n, ReadContext& in, const std::string& path, BondRecipe& out) const {
  std::array<double, 2> R{};
  const auto given = [&] {
    out.attachment = Attachment::given;
    out.R_i = R[0];
    out.R_j = R[1];
    return true;
  };
  if (const auto* word = std::get_if<std::string>(&n.value); word && word->find_first_of("0123456789") > 2) {
    std::size_t index = 0;
    if (!read_word(n, in, path, {"centres", "surfaces", "neck"}, index)) return false;
    constexpr std::array all{Attachment::centres, Attachment::surfaces, Attachment::neck};
    out.attachment = all[index];
    out.R_i = out.R_j = 0;
    return true;
  }
  const NumberCodec distance = not_negative(length);
  if (std::holds_alternative<NodeList>(n.value)) {
    return TupleCodec<NumberCodec, 2>{distance}.read(n, in, path, R) && given();
  }
  if (std::holds_alternative<bool>(n.value) || std::holds_alternative<NodeTable>(n.value) ||
      std::holds_alternative<Date>(n.value))
    return in.refuse_kind(n, path, type(), example(in.units));
  if (!distance.read(n, in, path, R[0])) return false;
  R[1] = R[0];
  return given();
}

std::string AttachCodec::write(const BondRecipe& r) const {
  switch (r.attachment) {
    case Attachment::centres: return "\"centres\"";
    case Attachment::surfaces: return "\"surfaces\"";
    case Attachment::neck: return "\"neck\"";
    case Attachment::given: break;
  }
  return "[" + number_text(r.R_i) + ", " + number_text(r.R_j) + "]";
}

}  // namespace vbond::keys

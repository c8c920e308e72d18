#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "vbond/case/keys.hpp"
#include "vbond/physics/top.hpp"

namespace vbond::keys {

// ---- distributions of lengths -------------------------------------------------------------------

namespace {

void describe_cut_off(Table& t, std::optional<double>& min, std::optional<double>& max) {
  t.key("min", min, positive(length), default_is("the least that can be made"),
        "what is smaller is not drawn; the others keep their ratios");
  t.key("max", max, positive(length), default_is("none"), "what is larger is not drawn");
  t.check(!min || !max || *min < *max, {"min", "max"}, "min must be smaller than max", "exchange them");
}

}  // namespace

void describe(Table& t, SizeSpec& s) {
  const std::vector<std::string> forms{"uniform", "normal", "lognormal", "table"};
  t.alternatives(s.form, t.exactly_one(forms, s.form.index()), forms);
}

void describe(Table& t, UniformSizes& s) {
  t.table("uniform", required, "all between two bounds are equally frequent", [&s](Table& u) {
    u.key("min", s.min, positive(length), required, "the smallest");
    u.key("max", s.max, positive(length), required, "the largest");
    u.check(s.min <= s.max, {"min", "max"}, "min may not be larger than max", "exchange them");
  });
}

void describe(Table& t, NormalSizes& s) {
  t.table("normal", required, "Gauss's distribution", [&s](Table& u) {
    u.key("mean", s.mean, positive(length), required, "before the distribution is cut off");
    u.key("deviation", s.deviation, positive(length), required, "the standard deviation, likewise");
    describe_cut_off(u, s.min, s.max);
  });
}

void describe(Table& t, LognormalSizes& s) {
  t.table("lognormal", required, "the logarithm has Gauss's distribution", [&s](Table& u) {
    u.key("median", s.median, positive(length), required, "half of all are smaller");
    u.key("deviation", s.deviation, positive(pure), required, "standard deviation of the natural logarithm");
    describe_cut_off(u, s.min, s.max);
  });
}

void describe(Table& t, SizeTable& s) {
  t.table("table", required, "a few values, each with its share", [&s](Table& u) {
    u.key("values", s.values, list_of(positive(length), 1), required, "the values");
    u.key("shares", s.shares, list_of(not_negative(pure), 1), required,
          "how much there is of each, in any unit");
    u.key("by", s.by, ChoiceCodec<ShareOf>{{"number", "size"}, {ShareOf::number, ShareOf::size}}, optional,
          "what is shared: the number, or the sum of the values, as in distributions weighted by length");
    u.check(s.values.size() == s.shares.size(), {"shares", "values"}, "every value has one share",
            "give as many shares as values");
    u.check(std::accumulate(s.shares.begin(), s.shares.end(), 0.0) > 0.0, {"shares"},
            "one share at least must be above 0", "correct them");
  });
}

// ---- fibres -------------------------------------------------------------------------------------

namespace {

/// Keys of a region that has a corner and an opposite one.
void describe_corners(Table& t, FibreBox& b) {
  t.key("min", b.min, vector_of(length), required, "corner with the least coordinates");
  t.key("max", b.max, vector_of(length), required, "corner with the largest coordinates");
  t.check(b.min.x < b.max.x && b.min.y < b.max.y && b.min.z < b.max.z, {"min", "max"},
          "every coordinate of min must be smaller than that of max", "exchange them");
}

void describe_vessel(Table& t, FibresSpecimen& s) {
  const auto box = [&t](const char* name, std::optional<FibreBox>& b, const char* doc) {
    t.table(
        name, default_is("the [cell] of the case"), doc,
        [&b](Table& u) { describe_corners(u, b ? *b : b.emplace()); }, b.has_value());
  };
  box("box", s.box, "the fibres are in this box as a whole, with their radius");
  box("layer", s.layer,
      "a box in which the middles of the fibres are; along z they are in it as a whole, sideways they stick "
      "out");
  t.check(!(s.box && s.layer), {"layer", "box"}, "only one of box and layer may be given",
          "keep one of them; without any the fibres fill the [cell] of the case and go through its faces");
}

void describe_orientation(Table& t, FibresSpecimen& s) {
  using enum FibreOrientation;
  const std::vector<std::string> names{"isotropic", "planar", "tensor"};
  t.key("orientation", s.orientation, ChoiceCodec<FibreOrientation>{names, {isotropic, planar, tensor}},
        optional,
        "directions p from the first to the last particle of the fibres: even over all, even in a plane, or "
        "angular central Gaussian with a given mean of p p");
  t.when(s.orientation == planar, "orientation = \"planar\"", [&] {
    t.key("normal", s.normal, direction_vector, optional, "of the plane; its length does not matter");
  });
  t.when(s.orientation == tensor, "orientation = \"tensor\"", [&] {
    t.key("orientation_tensor", s.tensor, tuple_of<6>(number(pure)), required,
          "the mean of p p: xx, yy, zz, xy, xz, yz; its trace is 1");
  });
  if (s.orientation != tensor) return;
  const auto& a = s.tensor;
  t.check(std::abs(a[0] + a[1] + a[2] - 1.0) <= 1e-6, {"orientation_tensor"},
          "xx + yy + zz must be 1: p is a unit vector", "divide all six by their trace");
  const auto principal = principal_inertia({a[0], a[1], a[2], a[3], a[4], a[5]});
  t.check(
      principal && least_of(principal->moments) > -1e-9, {"orientation_tensor"},
      "no principal value may be negative: it is the mean of a square",
      "correct it; aligned along x is [1, 0, 0, 0, 0, 0], even in the plane of x and y [0.5, 0.5, 0, 0, 0, "
      "0]");
}

void describe_curl(Table& t, FibresSpecimen& s) {
  t.key("curl", s.curl, NumberCodec{pure, {0.2, 1.0, false, false}}, default_is("1: straight"),
        "distance of the ends over the length along the fibre, which is an arc");
  t.key("curvature", s.curvature, not_negative(wave_number), default_is("0: straight"),
        "instead of curl: one over the radius of the arc");
  t.check(!(s.curl && s.curvature), {"curvature", "curl"}, "only one of curl and curvature may be given",
          "keep one of them");
}

/// The least and the largest length that the user names.
struct NamedLengths {
  double least = 0, largest = 0;
};
NamedLengths named_lengths(const FibresSpecimen& s) {
  if (s.length) return {*s.length, *s.length};
  if (!s.lengths) return {INFINITY, 0.0};
  const auto in_form = [](const auto& form) -> NamedLengths {
    if constexpr (requires { form.values; }) {
      if (form.values.empty()) return {INFINITY, 0.0};
      const auto [least, largest] = std::minmax_element(form.values.begin(), form.values.end());
      return {*least, *largest};
    } else if constexpr (requires { form.median; }) {
      return {form.min.value_or(INFINITY), form.max.value_or(form.median)};
    } else if constexpr (requires { form.mean; }) {
      return {form.min.value_or(INFINITY), form.max.value_or(form.mean)};
    } else {
      return {form.min, form.max};
    }
  };
  return std::visit(in_form, s.lengths->form);
}

}  // namespace

void describe(Table& t, FibresSpecimen& s) {
  t.key("fibres", s.fibres, CountCodec{1}, default_is("exactly one of fibres and volume_share"),
        "number of fibres");
  t.key("volume_share", s.volume_share, NumberCodec{pure, {0.0, 1.0, true, true}},
        default_is("exactly one of fibres and volume_share"),
        "instead: sum of pi/4 diameter^2 length over the volume of cell, box or layer");
  t.locate(s.amount, s.volume_share ? "volume_share" : "fibres");
  t.check(s.fibres.has_value() != s.volume_share.has_value(), {"volume_share", "fibres", "kind"},
          "exactly one of fibres and volume_share is required", "give one of them");
  t.key("length", s.length, positive(length), default_is("exactly one of length and lengths"),
        "of all fibres, from the first particle to the last along the fibre");
  t.table("lengths", s.lengths, "instead of length: how lengths are distributed");
  t.check(s.length.has_value() != s.lengths.has_value(), {"lengths", "length", "kind"},
          "exactly one of length and lengths is required", "give one of them");
  t.key("diameter", s.diameter, positive(length), required,
        "of the fibres; the radius of their particles is half of it");
  t.key("spacing", s.spacing, positive(length), required,
        "distance of neighbours along a fibre, as nearly as a whole number of bonds allows");
  t.key("gap", s.gap, not_negative(length), optional,
        "least distance of the surfaces of two fibres, as cylinders with round ends");
  describe_curl(t, s);
  describe_orientation(t, s);
  describe_vessel(t, s);
  t.key("seed", s.seed, seed_number, optional, "of all that is drawn at random");
  const bool spaced = s.spacing > 0.0;  // else that is told
  t.check(!spaced || s.spacing >= s.diameter, {"spacing", "diameter"}, "must be at least the diameter",
          "take fewer particles: neighbours of neighbours would touch");
  const NamedLengths named = named_lengths(s);
  t.check(named.least >= s.spacing, {"length", "lengths", "spacing"},
          "no fibre may be shorter than the spacing: it has one bond at least", "use a smaller spacing");
  t.check(!spaced || static_cast<double>(s.fibres.value_or(1)) * (named.largest / s.spacing + 1.0) <=
                         static_cast<double>(most_particles),
          {"fibres", "length", "lengths"}, "must not make more than 1e8 particles", "take fewer fibres");
}

}  // namespace vbond::keys

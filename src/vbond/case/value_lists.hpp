#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "vbond/case/value.hpp"

/// Codecs of lists, and of values that may be absent or know their place.
namespace vbond::keys {

template <class T>
struct IsWrapped : std::false_type {};
template <class T>
struct IsWrapped<std::optional<T>> : std::true_type {};
template <class T>
struct IsWrapped<Placed<T>> : std::true_type {};

/// Reads through std::optional and Placed, which is filled with the place of the value.
template <class Codec, class T>
bool read_value(const Codec& codec, const Node& n, ReadContext& in, const std::string& path, T& out) {
  if constexpr (IsWrapped<T>::value) {
    T wrapped;
    if constexpr (requires { wrapped.place; }) {
      wrapped.place = in.place(n);
      if (!read_value(codec, n, in, path, wrapped.value)) return false;
    } else {
      wrapped.emplace();
      if (!read_value(codec, n, in, path, *wrapped)) return false;
    }
    out = std::move(wrapped);
    return true;
  } else {
    return codec.read(n, in, path, out);
  }
}

/// Writes through std::optional and Placed; empty text if there is no value.
template <class Codec, class T>
std::string write_value(const Codec& codec, const T& x) {
  if constexpr (IsWrapped<T>::value) {
    if constexpr (requires { x.place; })
      return write_value(codec, x.value);
    else
      return x ? write_value(codec, *x) : std::string{};
  } else {
    return codec.write(x);
  }
}

/// Reads each of as many elements as there are.
template <class Codec, class Items>
bool read_items(const Codec& element, const NodeList& items, ReadContext& in, const std::string& path,
                Items& out) {
  bool good = true;
  for (std::size_t k = 0; k < items.size(); ++k)
    good = read_value(element, items[k], in, path + "[" + std::to_string(k) + "]", out[k]) && good;
  return good;
}
template <class Codec, class Items>
std::string write_items(const Codec& element, const Items& items) {
  std::string text = "[";
  for (const auto& item : items) text += (text.size() > 1 ? ", " : "") + write_value(element, item);
  return text + "]";
}

/// A list of any length from `min` on.
template <class Codec>
struct ListCodec {
  Codec element;
  std::size_t min = 0;

  template <class T>
  bool read(const Node& n, ReadContext& in, const std::string& path, std::vector<T>& out) const {
    const auto* items = std::get_if<NodeList>(&n.value);
    if (!items) return in.refuse_kind(n, path, type(), example(in.units));
    if (items->size() < min)
      return in.refuse(n, path, "must have at least " + std::to_string(min) + " element",
                       such_as(path, example(in.units)));
    std::vector<T> found(items->size());
    if (!read_items(element, *items, in, path, found)) return false;
    out = std::move(found);
    return true;
  }
  template <class T>
  std::string write(const std::vector<T>& items) const {
    return write_items(element, items);
  }
  std::string type() const { return "list of " + element.type(); }
  std::string schema() const { return list_schema(element.schema(), min); }
  std::string example(UnitSystem u) const { return "[" + element.example(u) + "]"; }
};
template <class Codec>
ListCodec<Codec> list_of(const Codec& element, std::size_t min = 0) {
  return {element, min};
}

/// A list of exactly N.
template <class Codec, std::size_t N>
struct TupleCodec {
  Codec element;

  template <class T>
  bool read(const Node& n, ReadContext& in, const std::string& path, std::array<T, N>& out) const {
    const auto* items = std::get_if<NodeList>(&n.value);
    if (!items) return in.refuse_kind(n, path, type(), example(in.units));
    if (items->size() != N) return refuse_length(n, in, path, items->size(), N, example(in.units));
    std::array<T, N> found{};
    if (!read_items(element, *items, in, path, found)) return false;
    out = std::move(found);
    return true;
  }
  template <class T>
  std::string write(const std::array<T, N>& items) const {
    return write_items(element, items);
  }
  std::string type() const { return std::to_string(N) + " x " + element.type(); }
  std::string schema() const { return list_schema(element.schema(), N, N); }
  /// Numbers from 0 on differ: they are those of particles.
  std::string example_of(std::size_t k, UnitSystem u) const {
    if constexpr (std::is_same_v<Codec, CountCodec>)
      if (element.min == 0) return std::to_string(k);
    return element.example(u);
  }
  std::string example(UnitSystem u) const {
    std::string text = "[";
    for (std::size_t k = 0; k < N; ++k) text += (k > 0 ? ", " : "") + example_of(k, u);
    return text + "]";
  }
};
template <std::size_t N, class Codec>
TupleCodec<Codec, N> tuple_of(const Codec& element) {
  return {element};
}

}  // namespace vbond::keys

#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace vbond {

/// Some of the ids 0 .. whole - 1, and how many of them come before each: a quarter of a byte for each id of
/// the whole.
template <class IdType>
class IdSet {
 public:
  /// some: in any order, and any number of times.
  IdSet(std::size_t whole, const std::vector<IdType>& some)
      : IdSet(of(whole, [&some](const auto& add) {
          for (const IdType id : some) add(id);
        })) {}
  /// Those with which for_some calls the function that it gets, likewise.
  template <class ForSome>
  static IdSet of(std::size_t whole, const ForSome& for_some) {
    IdSet set(whole);
    for_some([&set](IdType id) { set.words_[id.value / 64].bits |= bit(id); });
    for (Word& w : set.words_) {
      w.before = static_cast<std::uint32_t>(set.size_);
      set.size_ += static_cast<std::size_t>(std::popcount(w.bits));
    }
    return set;
  }

  std::size_t whole() const { return whole_; }
  std::size_t size() const { return size_; }
  bool has(IdType id) const { return id.value < whole_ && (words_[id.value / 64].bits & bit(id)) != 0; }
  /// How many of them are lower than this one, which must be one of them: else std::logic_error.
  std::size_t place(IdType id) const {
    if (!has(id)) refuse(id);
    const Word& w = words_[id.value / 64];
    return w.before + static_cast<std::size_t>(std::popcount(w.bits & (bit(id) - 1)));
  }
  /// In increasing order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t k = 0; k < words_.size(); ++k)
      for (std::uint64_t left = words_[k].bits; left != 0; left &= left - 1)
        visit(IdType{64 * k + static_cast<std::size_t>(std::countr_zero(left))});
  }
  friend bool operator==(const IdSet&, const IdSet&) = default;

 private:
  struct Word {
    std::uint64_t bits = 0;
    std::uint32_t before = 0;  // in the words below
    friend bool operator==(const Word&, const Word&) = default;
  };
  explicit IdSet(std::size_t whole) : words_((whole + 63) / 64), whole_(whole) {}
  static std::uint64_t bit(IdType id) { return std::uint64_t{1} << (id.value % 64); }
  [[noreturn]] void refuse(IdType id) const {
    throw std::logic_error("number " + std::to_string(id.value) + " is not among the " +
                           std::to_string(size_) + " of " + std::to_string(whole_) + " that are known here");
  }

  std::vector<Word> words_;
  std::size_t whole_, size_ = 0;
};

}  // namespace vbond

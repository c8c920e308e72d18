#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

namespace vbond {

/// Processes that share a body, as one of them sees the others. All call these functions in the same order,
/// and wait for each other. As it stands, of one process, which has nobody to wait for; those of several
/// override all that is virtual.
class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  /// Numbers become the sum, or the largest, of those of all processes.
  virtual void sum(std::span<double> /*numbers*/) const {}
  virtual void max(std::span<double> /*numbers*/) const {}
  /// Counts become the sum of those of all processes, some at a time.
  void sum_counts(std::span<std::uint32_t> counts) const;
  /// How many processes there are, and which of them this is, from 0.
  virtual int ranks() const { return 1; }
  virtual int rank() const { return 0; }
  /// Whether this process does what one of them must do for all.
  bool leads() const { return rank() == 0; }
  /// What all processes have, in their order. room(n) is where n bytes of it go.
  using Room = std::function<std::byte*(std::size_t)>;
  virtual void gather_bytes(std::span<const std::byte> mine, const Room& room) const;
  /// The same, for the process that leads alone: the others send, and are not asked for room.
  virtual void send_bytes_to_leader(std::span<const std::byte> mine, const Room& room) const {
    gather_bytes(mine, room);
  }

  /// What all processes have for this one, in their order; and how many bytes each. `mine` is for the first
  /// process so many of these bytes, for the next one the following, and so on.
  virtual std::vector<std::size_t> swap_bytes(std::span<const std::byte> mine,
                                              const std::vector<std::size_t>& sizes, const Room& room) const;

  /// mine[k] goes to process k. What each of them has for this one.
  template <class T>
  std::vector<std::vector<T>> swap(const std::vector<std::vector<T>>& mine) const {
    std::vector<T> out, in;
    std::vector<std::size_t> sizes;
    for (const std::vector<T>& m : mine) {
      out.insert(out.end(), m.begin(), m.end());
      sizes.push_back(m.size() * sizeof(T));
    }
    sizes = swap_bytes(bytes_of(out), sizes, room_in(in));
    std::vector<std::vector<T>> of_each;
    auto next = in.begin();
    for (const std::size_t size : sizes) {
      const auto last = next + static_cast<std::ptrdiff_t>(size / sizeof(T));
      of_each.emplace_back(next, last);
      next = last;
    }
    return of_each;
  }
  template <class T>
  std::vector<T> gather(const std::vector<T>& mine) const {
    std::vector<T> all;
    gather_bytes(bytes_of(mine), room_in(all));
    return all;
  }
  /// Nothing on those that do not lead.
  template <class T>
  std::vector<T> send_to_leader(const std::vector<T>& mine) const {
    std::vector<T> all;
    send_bytes_to_leader(bytes_of(mine), room_in(all));
    return all;
  }
  /// Calls take(one) for each of what all processes have, some of each at a time.
  template <class T, class Take>
  void tell_all(const std::vector<T>& mine, Take take) const {
    constexpr std::size_t at_once = 1 << 16;
    for (std::size_t next = 0; any(next < mine.size()); next = std::min(next + at_once, mine.size())) {
      const auto first = mine.begin() + static_cast<std::ptrdiff_t>(next);
      const auto size = static_cast<std::ptrdiff_t>(std::min(at_once, mine.size() - next));
      for (const T& one : gather(std::vector<T>(first, first + size))) take(one);
    }
  }
  bool any(bool here) const {
    double number = here ? 1.0 : 0.0;
    max({&number, 1});
    return number != 0.0;
  }
  /// What the process that leads says, on all of them.
  bool leader_says(bool here) const { return any(leads() && here); }

  /// Does work that some processes may fail at alone, such as writing: if it throws std::runtime_error on
  /// some, the others throw IoError with what the first of these says. Any other exception ends the program.
  virtual void together(const std::function<void()>& work) const { work(); }
  /// After so many steps of a body in motion they tell each other of failures and interruptions; who looks
  /// more often has them wait for that look alone.
  virtual std::int64_t steps_between_meetings() const { return 1; }

 private:
  template <class T>
  static std::span<const std::byte> bytes_of(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(std::span(values));
  }
  template <class T>
  static Room room_in(std::vector<T>& all) {
    return [&all](std::size_t bytes) {
      all.resize(bytes / sizeof(T));
      return std::as_writable_bytes(std::span(all)).data();
    };
  }
};

/// The one process of a body that is not shared.
const Communicator& alone();

}  // namespace vbond

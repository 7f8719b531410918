#pragma once
// The ranks of a run: processes, or in tests threads, that share its particles. Every sum, extremum and decision over all
// particles goes through here, in the order of the ranks, so that all ranks get the same bits of it.
//
// Each function but `together`'s body is collective: all ranks call it, in the same order and with as many values. Whether
// a rank calls one may therefore depend on such results only, never on what this rank alone knows.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <span>

#include "odpd/core/index.h"

namespace odpd {

class Communicator {
 public:
  /// One rank, where all of it costs nothing.
  static const Communicator& alone();

  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }

  double sum(double x) const;
  std::int64_t sum(std::int64_t x) const;
  /// Entry by entry, in place.
  void sum(std::span<double> x) const;
  void sum(std::span<float> x) const;

  double smallest(double x) const;
  double largest(double x) const;
  std::int64_t smallest(std::int64_t x) const;
  std::int64_t largest(std::int64_t x) const;

  /// It holds on some rank; on all of them.
  bool any(bool x) const;
  bool all(bool x) const { return !any(!x); }

  /// Calls body(), which may throw on some ranks but calls nothing collective. Where it threw on any, all ranks throw the
  /// error of the first of those, so that none waits for ever. Keeps ConfigError, SolverError with its cause, BlowUpError
  /// and BondTooLongError with their particle, IoError and std::bad_alloc apart; others become std::runtime_error.
  template <class Body>
  void together(const Body& body) const {
    if (size_ == 1) return body();
    std::exception_ptr failure;
    try {
      body();
    } catch (...) {
      failure = std::current_exception();
    }
    agree(failure);
  }

 protected:
  Communicator(int rank, int size) : rank_(rank), size_(size) {}

 private:
  /// all[r * mine.size() ...] = what rank r gave; all.size() = size() * mine.size().
  virtual void gather(std::span<const std::byte> mine, std::span<std::byte> all) const = 0;
  /// Throws on all ranks the failure of the first that has one.
  void agree(const std::exception_ptr& failure) const;
  template <class T, class Join>
  T reduce(T x, const Join& join) const;
  template <class T>
  void add_up(std::span<T> x) const;

  int rank_, size_;
};

/// The entries [first, last) of a list that belong to this rank. Each entry belongs to one of the ranks; without any, to
/// this one.
struct Share {
  const Communicator* ranks = &Communicator::alone();
  std::int64_t first = 0, last = std::numeric_limits<std::int64_t>::max();

  /// Runs of n entries, as equal as they get, in the order of the ranks.
  static Share of(const Communicator& ranks, std::int64_t n) {
    return {&ranks, n * ranks.rank() / ranks.size(), n * (ranks.rank() + 1) / ranks.size()};
  }
  bool alone() const { return ranks->size() == 1; }
  bool owns(std::int64_t k) const { return first <= k && k < last; }
  bool owns(std::size_t k) const { return owns(static_cast<std::int64_t>(k)); }
  /// Where the run ends in a list of n entries.
  std::int64_t end(std::int64_t n) const { return std::min(last, n); }

  /// Entries of all ranks, where this one's list has n.
  std::int64_t count(std::int64_t n) const { return ranks->sum(end(n) - first); }

  // Over x of `width` numbers per entry; the same bits on any thread count and all ranks.
  double dot(std::span<const double> a, std::span<const double> b, int width) const;
  double sum(std::span<const double> x, int width = 1) const;
  double norm(std::span<const double> x, int width) const;
  /// Those of this rank.
  template <class T>
  std::span<T> part(std::span<T> x, int width) const {
    const auto w = static_cast<std::int64_t>(width);
    const std::int64_t n = static_cast<std::int64_t>(x.size()) / w;
    return x.subspan(index(std::min(first, n) * w), index((end(n) - std::min(first, n)) * w));
  }
};

}  // namespace odpd

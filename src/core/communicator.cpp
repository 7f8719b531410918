#include "odpd/core/communicator.h"

#include <cmath>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

class OneRank : public Communicator {
 public:
  OneRank() : Communicator(0, 1) {}

 private:
  void gather(std::span<const std::byte> mine, std::span<std::byte> all) const override {
    std::copy(mine.begin(), mine.end(), all.begin());
  }
};

enum class Failure : std::int64_t { none, config, solver, blow_up, bond, io, memory, other };

// An error in numbers and a text, as it travels.
struct Verdict {
  Failure kind = Failure::none;
  std::int64_t detail = 0;  // cause of a SolverError, particle of a BlowUpError
  std::string text = {};
};

Verdict verdict_of(const std::exception_ptr& failure) {
  if (failure == nullptr) return {};
  try {
    std::rethrow_exception(failure);
  } catch (const BondTooLongError& e) {
    return {Failure::bond, e.particle(), e.what()};
  } catch (const BlowUpError& e) {
    return {Failure::blow_up, e.particle(), e.what()};
  } catch (const SolverError& e) {
    return {Failure::solver, static_cast<std::int64_t>(e.cause()), e.what()};
  } catch (const ConfigError& e) {
    return {Failure::config, 0, e.what()};
  } catch (const IoError& e) {
    return {Failure::io, 0, e.what()};
  } catch (const std::bad_alloc& e) {
    return {Failure::memory, 0, e.what()};
  } catch (const std::exception& e) {
    return {Failure::other, 0, e.what()};
  } catch (...) {
    return {Failure::other, 0, "something that is no error was thrown"};
  }
}

[[noreturn]] void raise(const Verdict& v) {
  switch (v.kind) {
    case Failure::bond:
      throw BondTooLongError(v.text, v.detail);
    case Failure::blow_up:
      throw BlowUpError(v.text, v.detail);
    case Failure::solver:
      throw SolverError(v.text, static_cast<SolverError::Cause>(v.detail));
    case Failure::config:
      throw ConfigError(v.text);
    case Failure::io:
      throw IoError(v.text);
    case Failure::memory:
      throw std::bad_alloc();
    default:
      throw std::runtime_error(v.text);
  }
}

}  // namespace

const Communicator& Communicator::alone() {
  static const OneRank one;
  return one;
}

template <class T, class Join>
T Communicator::reduce(T x, const Join& join) const {
  if (size_ == 1) return x;
  std::vector<T> all(index(size_));
  gather(std::as_bytes(std::span(&x, 1)), std::as_writable_bytes(std::span(all)));
  T result = all.front();
  for (std::size_t r = 1; r < all.size(); ++r) result = join(result, all[r]);
  return result;
}

template <class T>
void Communicator::add_up(std::span<T> x) const {
  if (size_ == 1) return;
  std::vector<T> all(x.size() * index(size_));
  gather(std::as_bytes(x), std::as_writable_bytes(std::span(all)));
  std::copy_n(all.begin(), x.size(), x.begin());
  for (std::size_t k = x.size(); k < all.size(); ++k) x[k % x.size()] += all[k];
}

double Communicator::sum(double x) const {
  return reduce(x, [](double a, double b) { return a + b; });
}
std::int64_t Communicator::sum(std::int64_t x) const {
  return reduce(x, [](std::int64_t a, std::int64_t b) { return a + b; });
}
void Communicator::sum(std::span<double> x) const { add_up(x); }
void Communicator::sum(std::span<float> x) const { add_up(x); }

double Communicator::smallest(double x) const {
  return reduce(x, [](double a, double b) { return std::min(a, b); });
}
double Communicator::largest(double x) const {
  return reduce(x, [](double a, double b) { return std::max(a, b); });
}
std::int64_t Communicator::smallest(std::int64_t x) const {
  return reduce(x, [](std::int64_t a, std::int64_t b) { return std::min(a, b); });
}
std::int64_t Communicator::largest(std::int64_t x) const {
  return reduce(x, [](std::int64_t a, std::int64_t b) { return std::max(a, b); });
}

bool Communicator::any(bool x) const { return largest(std::int64_t{x ? 1 : 0}) != 0; }

void Communicator::agree(const std::exception_ptr& failure) const {
  const Verdict mine = verdict_of(failure);
  const std::int64_t first =
      smallest(mine.kind == Failure::none ? std::int64_t{size_} : std::int64_t{rank_});
  if (first == size_) return;
  // The others add nothing to what the first says.
  const bool speaks = first == rank_;
  Verdict agreed;
  agreed.kind = static_cast<Failure>(sum(speaks ? static_cast<std::int64_t>(mine.kind) : 0));
  agreed.detail = sum(speaks ? mine.detail : 0);
  const std::int64_t length = sum(speaks ? std::ssize(mine.text) : std::int64_t{0});
  std::string text = speaks ? mine.text : std::string(index(length), ' ');
  std::string all(text.size() * index(size_), ' ');
  gather(std::as_bytes(std::span(text)), std::as_writable_bytes(std::span(all)));
  agreed.text = all.substr(index(first * length), text.size());
  raise(agreed);
}

double Share::dot(std::span<const double> a, std::span<const double> b, int width) const {
  return ranks->sum(fixed_dot(part(a, width), part(b, width)));
}

double Share::sum(std::span<const double> x, int width) const {
  return ranks->sum(fixed_sum(part(x, width)));
}

double Share::norm(std::span<const double> x, int width) const {
  return std::sqrt(dot(x, x, width));
}

}  // namespace odpd

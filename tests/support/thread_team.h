#pragma once
// Ranks as threads of one process. A rank that waits for a sum in which another takes no part, because that one has left, waits for
// one of another size or does not come in time, gets an error instead of waiting for ever; so do all ranks after it.
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "odpd/core/communicator.h"

namespace support {

/// The ranks did not call the same reductions.
class RanksDisagree : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ThreadTeam {
 public:
  using Body = std::function<void(const odpd::Communicator&)>;

  /// Runs body(communicator of the rank) on `size` threads and returns when all have ended. Throws what the first rank that
  /// failed for a reason of its own threw, else RanksDisagree where ranks disagreed. Threads of OpenMP must be set to 1.
  static void run(int size, const Body& body,
                  std::chrono::seconds patience = std::chrono::seconds(60)) {
    ThreadTeam team(size, patience);
    std::vector<std::exception_ptr> failure(static_cast<std::size_t>(size));
    std::vector<std::thread> threads;
    for (int r = 0; r < size; ++r)
      threads.emplace_back([&, r] {
        const Rank rank(team, r);
        try {
          body(rank);
        } catch (...) {
          failure[static_cast<std::size_t>(r)] = std::current_exception();
        }
        team.leave();
      });
    for (std::thread& thread : threads) thread.join();
    std::exception_ptr disagreement;
    for (const std::exception_ptr& f : failure) {
      if (f == nullptr) continue;
      try {
        std::rethrow_exception(f);
      } catch (const RanksDisagree&) {
        if (disagreement == nullptr) disagreement = f;
      }
    }
    if (disagreement != nullptr) std::rethrow_exception(disagreement);
  }

 private:
  class Rank : public odpd::Communicator {
   public:
    Rank(ThreadTeam& team, int rank)
        : odpd::Communicator(rank, static_cast<int>(team.given_.size())), team_(team) {}

   private:
    void gather(std::span<const std::byte> mine, std::span<std::byte> all) const override {
      team_.given_[static_cast<std::size_t>(rank())] = mine;
      team_.meet();
      for (std::size_t r = 0; r < team_.given_.size(); ++r) {
        const auto given = team_.given_[r];
        if (given.size() != mine.size()) team_.quarrel("ranks reduce different numbers of values");
        if (!given.empty()) std::memcpy(all.data() + r * mine.size(), given.data(), given.size());
      }
      team_.meet();  // nobody goes on while others read
    }
    ThreadTeam& team_;
  };

  ThreadTeam(int size, std::chrono::seconds patience)
      : given_(static_cast<std::size_t>(size)), patience_(patience) {}

  void meet() {
    std::unique_lock lock(mutex_);
    if (broken_.empty() && left_ > 0) broken_ = "a rank ended while others wait for it";
    const std::int64_t round = round_;
    if (broken_.empty() && ++here_ == given_.size()) {
      here_ = 0;
      ++round_;
      changed_.notify_all();
      return;
    }
    const bool met =
        changed_.wait_for(lock, patience_, [&] { return round_ != round || !broken_.empty(); });
    if (met && round_ != round) return;
    if (broken_.empty()) broken_ = "ranks waited in vain for others";
    changed_.notify_all();
    throw RanksDisagree(broken_);
  }
  void quarrel(const std::string& why) {
    const std::lock_guard lock(mutex_);
    if (broken_.empty()) broken_ = why;
    changed_.notify_all();
    throw RanksDisagree(broken_);
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    ++left_;
    if (here_ > 0 && broken_.empty()) broken_ = "a rank ended while others wait for it";
    changed_.notify_all();
  }

  std::vector<std::span<const std::byte>> given_;
  std::chrono::seconds patience_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t here_ = 0, left_ = 0;
  std::int64_t round_ = 0;
  std::string broken_;
};

}  // namespace support

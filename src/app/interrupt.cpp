#include "odpd/app/interrupt.h"

#include <unistd.h>

#include <csignal>

namespace odpd {

namespace {

volatile std::sig_atomic_t signals_seen = 0;

extern "C" void on_signal(int) {
  signals_seen = signals_seen + 1;
  if (signals_seen > 1) _exit(130);
}

}  // namespace

void catch_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

void let_large_writes_fail() { std::signal(SIGXFSZ, SIG_IGN); }

bool interrupted() { return signals_seen > 0; }

}  // namespace odpd

#include "odpd/app/info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>
#include <unistd.h>

#include <fstream>

#include "odpd/core/isa.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/solvers/solver.h"
#include "odpd/version.h"

namespace odpd {

namespace {

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

double memory_gibibytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<double>(sysconf(_SC_PAGE_SIZE)) / 1073741824.0;
}

}  // namespace

std::string info_text() {
  std::string out = fmt::format("odpd {}\n", ODPD_VERSION);
  out += fmt::format("  build         {} with {}, PETSc {}\n", ODPD_BUILD_TYPE, ODPD_COMPILER,
                     ODPD_WITH_PETSC ? "on" : "off");
  out += fmt::format(
      "  instructions  kernels {} (ODPD_ISA), the rest {} without fused multiply-add\n",
      isa_name(isa()),
      ODPD_NATIVE ? "those of the machine it was compiled on (-march=native)" : "x86-64 baseline");
  out += fmt::format("  solvers       {}\n", fmt::join(available_solvers(), ", "));
  out += fmt::format("  integrators   {}\n", fmt::join(integrator_names(), ", "));
  out += fmt::format("  machine       {}\n", machine_text());
  return out;
}

std::string machine_text() {
  return fmt::format("{}, {} processors, {:.1f} GiB", processor(), omp_get_num_procs(),
                     memory_gibibytes());
}

}  // namespace odpd

#include "odpd/app/info.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>
#include <unistd.h>

#include <fstream>

#include "odpd/core/isa.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/io/file.h"
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

std::uint64_t hash_of(const std::string& file, std::uint64_t hash) {
  for (const char c : read_file(file))  // FNV-1a
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return hash;
}

}  // namespace

const std::string& build_identity() {
  static const std::string identity = [] {
    const std::uint64_t hash = hash_of("/proc/self/exe", 14695981039346656037u);
    // The library may be a file of its own.
    Dl_info library{};
    const bool found = ::dladdr(reinterpret_cast<const void*>(&info_text), &library) != 0;
    return fmt::format("{:016x}", found ? hash_of(library.dli_fname, hash) : hash);
  }();
  return identity;
}

std::string info_text() {
  std::string out = fmt::format("odpd {}\n", ODPD_VERSION);
  out += fmt::format("  build         {} with {}, PETSc {}, identity {}\n", ODPD_BUILD_TYPE,
                     ODPD_COMPILER, ODPD_WITH_PETSC ? "on" : "off", build_identity());
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

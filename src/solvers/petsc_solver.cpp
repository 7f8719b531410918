// PETSc's KSP on the assembled matrix, in one process.
#include <cblas.h>
#include <fmt/format.h>
#include <petscksp.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/timer.h"
#include "odpd/solvers/assembled_solver.h"
#include "odpd/solvers/backends.h"
#include "odpd/solvers/petsc_options.h"

namespace odpd {

namespace {

constexpr const char* prefix = "odpd_";
constexpr const char* remedy =
    "change solver.petsc_options (another -pc_type), or choose solver.name = \"pcg\"";

// ---- PETSc itself

/// The first message of the error that is under way.
std::string& error_message() {
  thread_local std::string message;
  return message;
}

PetscErrorCode keep_message(MPI_Comm, int, const char*, const char*, PetscErrorCode code,
                            PetscErrorType type, const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) error_message() = message == nullptr ? "" : message;
  return code;
}

std::string take_message(PetscErrorCode code) {
  std::string message = error_message();
  error_message().clear();
  return message.empty() ? fmt::format("error code {}", static_cast<int>(code)) : message;
}

/// Of calls that can fail only by what the user asked for.
void check_options(PetscErrorCode code) {
  if (code != 0) throw ConfigError("solver.petsc_options: " + take_message(code));
}

void check(PetscErrorCode code) {
  if (code == PETSC_ERR_ARG_UNKNOWN_TYPE) check_options(code);  // read late: a level's or a block's
  if (code != 0) throw SolverError("petsc: " + take_message(code) + ": " + remedy);
}

bool petsc_runs() {
  PetscBool started = PETSC_FALSE;
  PetscBool ended = PETSC_FALSE;
  PetscInitialized(&started);
  PetscFinalized(&ended);
  return started == PETSC_TRUE && ended == PETSC_FALSE;
}

/// Starts PETSc on first use, unless the program around us has; whoever starts it ends it, at exit.
void require_petsc() {
  if (petsc_runs()) return;
  PetscBool ended = PETSC_FALSE;
  PetscFinalized(&ended);
  if (ended == PETSC_TRUE) throw SolverError("petsc: PETSc was already shut down");
  PetscOptionsSetValue(nullptr, "-no_signal_handler", "true");
  PetscOptionsSetValue(nullptr, "-skip_petscrc", "true");
  if (PetscInitializeNoArguments() != 0) throw SolverError("petsc: PETSc does not start");
  openblas_set_num_threads(1);
  std::atexit([] {
    if (petsc_runs()) PetscFinalize();
  });
}

/// While it lives, the user's options are in PETSc's database under our prefix, so that solvers of
/// different options live together, and PETSc's errors are kept for `check` instead of printed.
class Entry {
 public:
  Entry(const std::vector<PetscOption>& options, std::set<std::string>& used)
      : options_(options), used_(used) {
    require_petsc();
    PetscPushErrorHandler(keep_message, nullptr);
    for (const PetscOption& o : options_) {
      PetscOptionsSetValue(nullptr, fmt::format("-{}{}", prefix, o.name).c_str(),
                           o.value.empty() ? nullptr : o.value.c_str());
    }
  }
  ~Entry() {
    for (const PetscOption& o : options_) {
      PetscBool used = PETSC_FALSE;
      PetscOptionsUsed(nullptr, (prefix + o.name).c_str(), &used);
      if (used == PETSC_TRUE) used_.insert(o.name);
      PetscOptionsClearValue(nullptr, fmt::format("-{}{}", prefix, o.name).c_str());
    }
    PetscPopErrorHandler();
  }

 private:
  const std::vector<PetscOption>& options_;
  std::set<std::string>& used_;
};

// ---- The matrix

/// ICC wants the symmetric storage, node-wise methods the blocks; GAMG fails on anything but AIJ.
const char* matrix_type(const std::string& pc_type) {
  if (pc_type == PCICC) return MATSEQSBAIJ;
  if (pc_type == PCPBJACOBI || pc_type == PCHYPRE) return MATSEQBAIJ;
  return MATSEQAIJ;
}

void preallocate(const BlockCsr& a, Mat matrix) {
  std::vector<PetscInt> all(index(a.rows));
  std::vector<PetscInt> upper(index(a.rows));
  for (std::int32_t row = 0; row < a.rows; ++row) {
    const auto begin = a.column.begin() + a.start[index(row)];
    const auto end = a.column.begin() + a.start[index(row) + 1];
    all[index(row)] = static_cast<PetscInt>(end - begin);
    upper[index(row)] = static_cast<PetscInt>(end - std::lower_bound(begin, end, row));
  }
  check(MatXAIJSetPreallocation(matrix, a.block, all.data(), nullptr, upper.data(), nullptr));
}

void fill(const BlockCsr& a, Mat matrix) {
  const std::size_t b = index(a.block);
  std::vector<PetscScalar> values;
  std::vector<PetscInt> columns;
  for (std::int32_t row = 0; row < a.rows; ++row) {
    const std::size_t begin = index(a.start[index(row)]);
    const std::size_t count = index(a.start[index(row) + 1]) - begin;
    columns.assign(&a.column[begin], &a.column[begin] + count);
    // PETSc wants the rows of the whole row of blocks one after the other.
    values.resize(count * b * b);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < b; ++i) {
        std::copy_n(&a.value[((begin + k) * b + i) * b], b, &values[(i * count + k) * b]);
      }
    }
    const PetscInt block_row = row;
    check(MatSetValuesBlocked(matrix, 1, &block_row, static_cast<PetscInt>(count), columns.data(),
                              values.data(), INSERT_VALUES));
  }
  check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

/// The normalised translations.
MatNullSpace translations(const System& system) {
  const Translations t = system.translations();
  const double one = 1.0 / std::sqrt(t.squares(index(system.size())));
  std::vector<::Vec> modes(index(t.components));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    ::Vec& mode = modes[k];
    check(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(system.size()), &mode));
    check(VecSetBlockSize(mode, t.block));
    check(VecSet(mode, 0.0));
    PetscScalar* entries = nullptr;
    check(VecGetArray(mode, &entries));
    std::vector<double> unit(modes.size(), 0.0);
    unit[k] = one;
    t.add(unit, {entries, index(system.size())});
    check(VecRestoreArray(mode, &entries));
  }
  MatNullSpace space = nullptr;
  check(MatNullSpaceCreate(PETSC_COMM_SELF, PETSC_FALSE, t.components, modes.data(), &space));
  for (::Vec& mode : modes) check(VecDestroy(&mode));
  return space;
}

/// What the coarse levels of a multigrid must hold: the rigid motions that the box allows. Rotations are left out where the
/// unknowns are not velocities alone.
MatNullSpace near_null_space(const System& system) {
  const std::span<const double> positions = system.positions();
  const bool rotates = !positions.empty() && system.periodic_directions() == 0 &&
                       system.block_size() == system.space_dimension() && system.block_size() > 1;
  if (!rotates) return translations(system);
  ::Vec points = nullptr;
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, system.space_dimension(),
                              static_cast<PetscInt>(positions.size()), positions.data(), &points));
  MatNullSpace space = nullptr;
  check(MatNullSpaceCreateRigidBody(points, &space));
  check(VecDestroy(&points));
  return space;
}

std::int64_t bytes_of(Mat matrix) {
  MatInfo info{};
  if (matrix == nullptr || MatGetInfo(matrix, MAT_LOCAL, &info) != 0) return 0;
  // Some matrix types do not count their memory: then values and column indices.
  return static_cast<std::int64_t>(std::max(info.memory, 12.0 * info.nz_used));
}

// ---- The solver

class PetscSolver : public AssembledSolver {
 public:
  explicit PetscSolver(const SolverOptions& options)
      : AssembledSolver(options), user_(parse_petsc_options(options.petsc_options)) {}
  ~PetscSolver() override { destroy(); }

 private:
  void set_up_matrix(const BlockCsr& a) override;
  void make_matrix(const BlockCsr& a);
  void make_ksp();
  void set_up_ksp();
  void attach_null_spaces();
  Attempt attempt_free(std::span<const double> b, std::span<double> x, double tolerance) override;
  Attempt outcome();
  void reject_unused();
  std::int64_t backend_bytes() const override { return bytes_; }
  std::int64_t estimate_bytes();
  void destroy();

  std::vector<PetscOption> user_;
  std::set<std::string> used_;
  bool options_checked_ = false;
  std::int64_t bytes_ = 0;
  Mat matrix_ = nullptr;
  KSP ksp_ = nullptr;
  ::Vec load_ = nullptr;  // the caller's arrays are placed into these two
  ::Vec solution_ = nullptr;
};

void PetscSolver::destroy() {
  if (!petsc_runs()) return;
  KSPDestroy(&ksp_);
  MatDestroy(&matrix_);
  VecDestroy(&load_);
  VecDestroy(&solution_);
}

void PetscSolver::set_up_matrix(const BlockCsr& a) {
  if (system_->size() > std::numeric_limits<PetscInt>::max())
    throw SolverError(
        "petsc: more unknowns than PETSc's indices hold: choose solver.name = \"pcg\"");
  const Entry entry(user_, used_);
  destroy();
  const Stopwatch watch;
  make_matrix(a);
  assembly_seconds_ += watch.seconds();
  const PetscInt size = static_cast<PetscInt>(system_->size());
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, a.block, size, nullptr, &load_));
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, a.block, size, nullptr, &solution_));
  attach_null_spaces();
  make_ksp();
  set_up_ksp();
  bytes_ = estimate_bytes();
}

void PetscSolver::make_matrix(const BlockCsr& a) {
  const PetscInt size = static_cast<PetscInt>(system_->size());
  check(MatCreate(PETSC_COMM_SELF, &matrix_));
  check(MatSetSizes(matrix_, size, size, size, size));
  check(MatSetBlockSize(matrix_, a.block));
  check(MatSetOptionsPrefix(matrix_, prefix));
  check(MatSetType(matrix_, matrix_type(petsc_option(user_, "pc_type", PCICC))));
  check_options(MatSetFromOptions(matrix_));
  preallocate(a, matrix_);
  PetscBool upper_only = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix_), MATSEQSBAIJ, &upper_only));
  if (upper_only == PETSC_TRUE)
    check(MatSetOption(matrix_, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  fill(a, matrix_);
  check(MatSetOption(matrix_, MAT_SYMMETRIC, PETSC_TRUE));
  if (!null_translations_) check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
}

void PetscSolver::attach_null_spaces() {
  const std::string pc_type = petsc_option(user_, "pc_type", PCICC);
  if (pc_type == PCGAMG || pc_type == PCHYPRE) {
    MatNullSpace near = near_null_space(*system_);
    check(MatSetNearNullSpace(matrix_, near));
    check(MatNullSpaceDestroy(&near));
  }
  if (null_translations_) {
    MatNullSpace null = translations(*system_);
    check(MatSetNullSpace(matrix_, null));
    check(MatNullSpaceDestroy(&null));
  }
}

void PetscSolver::make_ksp() {
  check(KSPCreate(PETSC_COMM_SELF, &ksp_));
  check(KSPSetOptionsPrefix(ksp_, prefix));
  check(KSPSetOperators(ksp_, matrix_, matrix_));
  check(KSPSetType(ksp_, KSPCG));
  PC pc = nullptr;
  check(KSPGetPC(ksp_, &pc));
  check_options(PCSetType(pc, petsc_option(user_, "pc_type", PCICC).c_str()));
  // The last pivot of a singular matrix is rounding.
  if (null_translations_) check(PCFactorSetShiftType(pc, MAT_SHIFT_POSITIVE_DEFINITE));
  check(KSPSetNormType(ksp_, KSP_NORM_UNPRECONDITIONED));
  check_options(KSPSetFromOptions(ksp_));
  PetscBool direct = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ksp_), KSPPREONLY, &direct));
  if (direct == PETSC_TRUE) check(KSPSetNormType(ksp_, KSP_NORM_NONE));
  check(KSPSetInitialGuessNonzero(ksp_, direct == PETSC_TRUE ? PETSC_FALSE : PETSC_TRUE));
}

void PetscSolver::set_up_ksp() {
  PetscErrorCode code = KSPSetUp(ksp_);
  if (code ==
      PETSC_ERR_SUP) {  // a method without the unpreconditioned norm; ours is checked anyway
    check(KSPSetNormType(ksp_, KSP_NORM_DEFAULT));
    code = KSPSetUp(ksp_);
  }
  check(code);
  check(KSPSetUpOnBlocks(ksp_));
}

Solver::Attempt PetscSolver::attempt_free(std::span<const double> b, std::span<double> x,
                                          double tolerance) {
  Attempt result;
  {
    const Entry entry(user_, used_);
    const std::int64_t most =
        std::min<std::int64_t>(iterations_left_, std::numeric_limits<PetscInt>::max());
    check(KSPSetTolerances(ksp_, tolerance, PETSC_DEFAULT, PETSC_DEFAULT,
                           static_cast<PetscInt>(most)));
    check(VecPlaceArray(load_, b.data()));
    check(VecPlaceArray(solution_, x.data()));
    const PetscErrorCode code = KSPSolve(ksp_, load_, solution_);
    check(VecResetArray(load_));
    check(VecResetArray(solution_));
    check(code);
    result = outcome();
  }
  reject_unused();
  return result;
}

Solver::Attempt PetscSolver::outcome() {
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  PC pc = nullptr;
  PCFailedReason cause = PC_NOERROR;
  check(KSPGetConvergedReason(ksp_, &reason));
  check(KSPGetIterationNumber(ksp_, &iterations));
  check(KSPGetPC(ksp_, &pc));
  check(PCGetFailedReason(pc, &cause));
  Attempt result{reason > 0, iterations, ""};
  if (reason == KSP_DIVERGED_INDEFINITE_MAT) {
    result.failure = not_definite;
  } else if (reason == KSP_DIVERGED_INDEFINITE_PC) {
    result.failure = fmt::format(
        "the preconditioner is not positive definite, perhaps because the matrix is not: {}, or "
        "add -pc_factor_shift_type positive_definite",
        remedy);
  } else if (!result.ok && reason != KSP_DIVERGED_ITS) {
    const char* detail = cause > PC_NOERROR ? PCFailedReasons[cause] : "no cause given";
    result.failure =
        fmt::format("KSP stopped with {} ({}): {}", KSPConvergedReasons[reason], detail, remedy);
  }
  return result;
}

/// PETSc takes a misspelt option for somebody else's: after the first solve all must be used.
void PetscSolver::reject_unused() {
  if (options_checked_) return;
  for (const PetscOption& o : user_) {
    if (!used_.contains(o.name)) {
      throw ConfigError(fmt::format(
          "solver.petsc_options: PETSc did not use -{}: correct its name, or remove it", o.name));
    }
  }
  options_checked_ = true;
}

/// Matrix, preconditioner as far as PETSc tells, and work vectors.
std::int64_t PetscSolver::estimate_bytes() {
  const std::string type = petsc_option(user_, "pc_type", PCICC);
  const std::int64_t matrix = bytes_of(matrix_);
  const std::int64_t vectors = 6 * system_->size() * static_cast<std::int64_t>(sizeof(double));
  PC pc = nullptr;
  check(KSPGetPC(ksp_, &pc));
  if (type == PCICC || type == PCILU || type == PCLU || type == PCCHOLESKY) {
    Mat factor = nullptr;
    check(PCFactorGetMatrix(pc, &factor));
    return matrix + vectors + bytes_of(factor);
  }
  if (type == PCGAMG) {
    PetscReal grids = 1.0;
    PetscReal operators = 1.0;
    check(PCMGGetGridComplexity(pc, &grids, &operators));
    return vectors + static_cast<std::int64_t>(operators * static_cast<double>(matrix));
  }
  const bool copies = type == PCHYPRE || type == PCBJACOBI;
  return vectors + (copies ? 2 : 1) * matrix;
}

}  // namespace

std::unique_ptr<Solver> make_petsc(const SolverOptions& options) {
  return std::make_unique<PetscSolver>(options);
}

}  // namespace odpd

// What several tests need, GoogleTest included.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <ostream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/flows/flow.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/scenes/euler_zeitlin_scenes.h"
#include "isosyrk/scenes/scene_list.h"
#include "isosyrk/simulation/run.h"
#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk::testing {

/// Largest entry of |A - B|.
double largest_difference(const Matrix& A, const Matrix& B);

/// How far answers of 50 steps may lie apart that are the same but for what the iteration leaves:
/// steps * tolerance / (1 - contraction), where sweeps contract by 0.5 a sweep at most (n <= 49,
/// h = 0.1), is 50 * 1e-13 / 0.5.
constexpr double coincidence = 1e-11;

/// n x n, entries uniform in the unit square, from a fixed seed.
Matrix random_matrix(Index n, unsigned seed);

/// Random skew-Hermitian, spectral norm 1.
Matrix random_skew_hermitian(Index n, unsigned seed);

/// W with `otherwise` in place of the entries (r, c) that are not wanted.
template <class Wanted>
Matrix entries_of(Matrix W, const Wanted& wanted, Complex otherwise = 0.0) {
  for (Index r = 0; r < W.rows(); ++r) {
    for (Index c = 0; c < W.cols(); ++c) {
      if (!wanted(r, c)) W(r, c) = otherwise;
    }
  }
  return W;
}

/// A B as the definition reads, in extended precision.
Matrix exact_product(const Matrix& A, const Matrix& B);

// exp(A), A^-1, the product of some matrices, and AB - BA: Eigen's. A source that has them itself
// takes seconds longer to compile.
Matrix exponential(const Matrix& A);
Matrix inverse(const Matrix& A);
Matrix product(std::initializer_list<Matrix> factors);
Matrix commutator(const Matrix& A, const Matrix& B);

/// A matrix from tests/data, in columns i,j,re,im.
Matrix read_reference(const std::string& file, Index n);

/// A one-step method applied until T = steps * h, which must converge throughout.
Matrix integrated(Integrator& integrator, const Matrix& W0, double h, long steps);

/// A flow that outlives its integrators, as one on the stack of a test does.
SharedFlow lent(const Flow& flow);

/// A step of a run from W, which past steps predict if they ended at W.  W is advanced if the step
/// converged.
StepReport continued(Integrator& integrator, Matrix& W, double h);

/// By what n x n matrices are multiplied where a test does not choose: small ones by OpenBLAS,
/// large ones by Eigen, since the kernels that OpenBLAS picks are eight times slower on some
/// processors.
ProductBackend products_of_tests(Index n);

/// The integrator of an entry, with these products.  The flow must outlive it.
std::unique_ptr<Integrator> made(const IntegratorEntry& entry, const Flow& flow,
                                 const IterationOptions& options = {});

/// The names of integrators() that the recorded studies are about.  These have all that an entry
/// can have; a method that is added to the list need not.
std::vector<std::string> recorded_integrators();

/// The entry, and that of its fast form if there is one.
std::vector<IntegratorEntry> forms_of(const IntegratorEntry& entry);

/// Whether a method is made for a flow.  elp4 and elp6 need J = I and a self-adjoint B; elp2, the
/// Magnus methods, those of Bogfjellmo and Marthinsen and those with a projection need J = I; a
/// frame needs Euler-Zeitlin; all others take any.
bool takes(const IntegratorEntry& entry, const Flow& flow);

/// The entries of integrators() that have a fast form.
std::vector<IntegratorEntry> fast_integrators();

/// Names a test whose parameter is (n, method) by its method.
inline std::string name_of_method(
    const ::testing::TestParamInfo<std::tuple<Index, IntegratorEntry>>& tested) {
  return ::testing::PrintToString(std::get<1>(tested.param));
}

/// A scene of the list with a size at which it is tested.
struct SceneCase {
  std::string name;
  SceneParameters parameters;
};
void PrintTo(const SceneCase& scene, std::ostream* out);

/// Every scene of the list, for the tests that go through them all.
const std::vector<SceneCase>& tested_scenes();

/// The formulation with the Gauss tableau of s stages, OpenBLAS products, tolerance 1e-13.
std::unique_ptr<Integrator> gauss(Formulation formulation, const Flow& flow, int s,
                                  double tolerance = 1e-13);

/// A formulation with a number of stages.
struct Method {
  Formulation formulation;
  int s;
};
void PrintTo(const Method& method, std::ostream* out);

/// Every formulation with 1 to `most_stages` stages.
std::vector<Method> methods(int most_stages);

/// The order seen in runs over `time` in these numbers of steps that end with errors error(h,
/// count): the least-squares slope of log(error) against log(h) over the last five points, which
/// show it best.  The first error below plateau(count) and those after it are left out; `least`
/// points or more must be left.
double observed_order(double time, const std::vector<long>& counts,
                      const std::function<double(double h, long count)>& error,
                      const std::function<double(long count)>& plateau, std::size_t least = 3);

/// Radau IIA with two stages, order 3: not symplectic.
Tableau radau_iia();

/// Whether the padding of the rows of X is 0.
template <class Real>
bool fill_is_zero(const SplitMatrixOf<Real>& X) {
  const Index n = X.size(), row = X.stride() / 2;
  // Column 2 r for the real parts of row r, column 2 r + 1 for the imaginary ones.
  return X.entries().reshaped(row, 2 * n).bottomRows(row - n).isZero(0);
}

/// Whether the calling thread reads and writes denormal numbers of both precisions, or 0 for all.
bool keeps_denormals();
bool flushes_denormals();

/// Expects the call to throw an Error whose message is one line with this part.
template <class Error = std::invalid_argument, class Call>
void expect_refused(const Call& call, const std::string& part) {
  try {
    call();
    ADD_FAILURE() << "accepted; expected: " << part;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
}

/// A test with a new folder, which goes when it ends.
class WithFolder : public ::testing::Test {
 protected:
  WithFolder();
  ~WithFolder() override { std::filesystem::remove_all(folder_); }
  /// Writes a file in the folder, and the folders above it.
  std::filesystem::path write(const std::filesystem::path& file, const std::string& contents) const;

  const std::filesystem::path folder_;
};

/// The spin matrices S_x, S_y, S_z of size n, written out.
std::array<Matrix, 3> spin_matrices(Index n);

/// J = [[0, I], [-I, 0]] of size 2k.
Matrix symplectic_J(Index k);
/// J = diag(1 (p times), -1 (q times)).
Matrix indefinite_J(Index p, Index q);

/// How far a step is from a Poisson map: ‖DΦ Π(W₀) DΦᵀ - Π(W₁)‖ / ‖Π(W₁)‖ for the step Φ as a map
/// of g, differentiated by central differences, with the Poisson tensor Π(W)(α, β) = -tr(W [α, β])
/// in a basis of g and the pairing -tr(AB).  In real matrices if the flow is real.
double poisson_map_defect(Integrator& integrator, const Matrix& W0, double h);

/// A flow with any B, and without a Hamiltonian.
class FlowOf final : public Flow {
 public:
  using Generator = std::function<void(const Matrix& W, Matrix& B)>;
  FlowOf(const QuadraticAlgebra& algebra, Generator generator,
         isosyrk::Generator kind = isosyrk::Generator::of_algebra, bool self_adjoint = false)
      : Flow(algebra, kind), generator_(std::move(generator)), self_adjoint_(self_adjoint) {}
  void generator(const Matrix& W, Matrix& B) const override { generator_(W, B); }
  double hamiltonian(const Matrix&) const override { return 0.0; }
  bool has_self_adjoint_generator() const override { return self_adjoint_; }

 private:
  Generator generator_;
  bool self_adjoint_;
};

/// A rigid-body-like flow on any J-quadratic algebra with J† = ±J:  B(W) = D W D with
/// D = J⁻¹ D† J, which maps g to g and is the gradient of H(W) = ½ Re tr(W D W D).
class ConjugationFlow final : public Flow {
 public:
  ConjugationFlow(const QuadraticAlgebra& algebra, unsigned seed);
  void generator(const Matrix& W, Matrix& B) const override;
  double hamiltonian(const Matrix& W) const override;
  /// An element of g of Frobenius norm 1.
  Matrix element(unsigned seed) const;

 private:
  Matrix D_;
};

}  // namespace isosyrk::testing

namespace isosyrk {

/// How GoogleTest names an entry in its reports.
inline void PrintTo(const IntegratorEntry& entry, std::ostream* out) { *out << entry.name; }

}  // namespace isosyrk

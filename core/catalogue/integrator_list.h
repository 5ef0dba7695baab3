// The list of integrators.  Tests, benchmarks, tables and charts run over it.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isosyrk/catalogue/family.h"
#include "isosyrk/integrators/formulation.h"

namespace isosyrk {

/// Structure that an integrator keeps, to the tolerance of its iteration unless said otherwise. For
/// each property a test checks that it holds if true, and that it fails if false.
struct Properties {
  bool isospectral;  ///< keeps the spectrum of W
  bool lie_poisson;  ///< the step is a Poisson map
  bool symmetric;    ///< step(-h) inverts step(h)
  /// Keeps the spectrum to rounding at any tolerance: its update conjugates W by what is unitary to
  /// rounding, or projects W.
  bool spectrum_at_any_tolerance = false;
};

struct FastOptions;  // fast/fast_options.h

/// Makes the published form of an integrator for a flow.
using MakePublished = std::function<std::unique_ptr<Integrator>(
    const SharedFlow&, const IterationOptions&, ProductBackend)>;
/// Makes its fast form.  Throws std::invalid_argument for a flow without B in split-complex storage
/// and for options out of range.
using MakeFast = std::function<std::unique_ptr<Integrator>(const SharedFlow&, const FastOptions&)>;

/// One entry of the list.  A published form alone is enough; name, stages, order, `keeps` and
/// `make` must be given.  What a method is stands in the fields, so that nobody reads its name.
struct IntegratorEntry {
  std::string name;
  Family family = Family::other;
  std::optional<Formulation> formulation = {};  ///< of the Gauss method or the composition, if any
  bool projected = false;  ///< with a projection onto the spectrum (integrators/projected.h)
  /// The entry outside the frame, or the one that a control changes; empty if it is no variant.
  std::string variant_of = {};
  int stages;
  int order;
  Properties keeps;
  bool is_explicit = false;  ///< no iteration
  MakePublished make;
  MakeFast make_fast = {};  ///< empty if there is no fast form
  /// Largest h‖ad_B‖₂ at which the step is stable for a constant generator.  In a longer step
  /// perturbations grow, whatever the tolerance.
  double stability_limit = std::numeric_limits<double>::infinity();
  /// Largest h that linear theory allows (integrators/step_limits.h), in units of t, from the
  /// eigenvalues of -iB(W₀) in ascending order.  Empty if linear theory sets no limit.
  std::function<double(const RealVector&)> linear_limit = {};
  /// True if the list has it in the co-rotating frame too.  For methods that keep the angular
  /// momentum, which turns the frame, or hardly change it.
  bool in_frame = false;
  /// True if it solves in the co-rotating frame (flows/co_rotating_frame.h).  Both limits above are
  /// then about the generator B' of that frame.
  bool co_rotating = false;
  bool is_fast = false;  ///< true if `make` makes the fast form, as that of a fast_entry()

  /// Returns the name of the method whatever its frame, of a control that of the listed one.
  const std::string& method() const { return variant_of.empty() ? name : variant_of; }
  bool has_fast_form() const { return static_cast<bool>(make_fast); }
};

/// Returns the entry of the Gauss method with s stages in a formulation.  Throws
/// std::invalid_argument unless 1 <= s <= max_stages.
IntegratorEntry gauss_entry(Formulation formulation, int s);

/// Returns the entry of a method in the co-rotating frame, for Euler-Zeitlin, with the suffix
/// "_frame".  It has a fast form if the method has one.
IntegratorEntry frame_entry(const IntegratorEntry& method);

/// Returns the entry of a control that is not in the list: `algebra` with its update formed as
/// B W̃ - W̃ B, which loses skew-Hermiticity.  Throws std::invalid_argument unless
/// 2 <= s <= max_stages.
IntegratorEntry two_products_entry(int s);

/// Returns the list of published integrators and controls.
const std::vector<IntegratorEntry>& integrators();
/// Returns the entry with this name: of the list, or of a control: two_products_entry(2 or 3), and
/// the compositions with their substeps in another formulation, "yoshida4_group",
/// "yoshida4_cotangent" and so on.  Throws std::invalid_argument, naming the names of the list, for
/// another.
const IntegratorEntry& integrator_entry(std::string_view name);

}  // namespace isosyrk

#include "isosyrk/integrators/flow_requirements.h"

#include <fmt/format.h>

#include <stdexcept>

namespace isosyrk {

void require_identity_J(const Flow& flow, std::string_view method) {
  if (flow.algebra().is_skew_hermitian()) return;
  throw std::invalid_argument(
      fmt::format("{}: for flows of skew-Hermitian matrices (J = I) only", method));
}

void require_self_adjoint_generator(const Flow& flow, std::string_view method) {
  if (flow.has_self_adjoint_generator()) return;
  throw std::invalid_argument(fmt::format(
      "{}: B of this flow is not known to be linear and self-adjoint in -tr(AB), as the "
      "method needs; elp2 takes any B",
      method));
}

}  // namespace isosyrk

#include "isosyrk/integrators/frame_integrator.h"

#include <stdexcept>

namespace isosyrk {
namespace {

const EulerZeitlin& euler_zeitlin(const Flow& flow) {
  if (const auto* found = dynamic_cast<const EulerZeitlin*>(&flow)) return *found;
  throw std::invalid_argument("co-rotating frame: for Euler-Zeitlin only");
}

}  // namespace

FrameIntegrator::FrameIntegrator(const Flow& flow, const Make& make, ProductBackend backend)
    : Integrator(flow), frame_(euler_zeitlin(flow), backend), method_(make(frame_.flow())) {}

}  // namespace isosyrk

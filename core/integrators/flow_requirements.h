// What a method may ask of its flow.
#pragma once

#include <string_view>

#include "isosyrk/flows/flow.h"

namespace isosyrk {

/// Throws std::invalid_argument, naming the method, unless J = I.
void require_identity_J(const Flow& flow, std::string_view method);

/// Throws std::invalid_argument, naming the method, unless the flow has_self_adjoint_generator().
void require_self_adjoint_generator(const Flow& flow, std::string_view method);

}  // namespace isosyrk

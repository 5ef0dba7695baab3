#include "isosyrk/flows/flow.h"

#include "isosyrk/flows/split_generator.h"

namespace isosyrk {

std::unique_ptr<SplitGenerator> Flow::split_generator() const { return nullptr; }

}  // namespace isosyrk

#include "isosyrk/iteration/attempt.h"

#include <string_view>

namespace isosyrk {
namespace {

std::string_view name(Iteration iteration) {
  switch (iteration) {
    case Iteration::none:
      return "explicit";
    case Iteration::picard:
      return "Picard";
    case Iteration::newton:
      return "Newton";
    case Iteration::frozen_picard:
      return "frozen Picard";
    case Iteration::anderson:
      return "Anderson";
  }
  return "unknown";
}

std::string_view name(Start start) {
  switch (start) {
    case Start::cold:
      return "cold";
    case Start::predicted:
      return "predicted";
    case Start::stepped:
      return "stepped";
  }
  return "unknown";
}

}  // namespace

std::string name(Attempt attempt) {
  std::string iteration(name(attempt.iteration));
  if (attempt.iteration == Iteration::none) return iteration;
  return std::string(name(attempt.start)) + " " + iteration;
}

}  // namespace isosyrk

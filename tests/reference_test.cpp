// Reference solutions: those recorded are what they say, and no other file passes for one.
#include "benchmarks/reference.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "benchmarks/npy_file.h"
#include "benchmarks/program.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

const std::string recorded = ISOSYRK_TEST_DATA "/../../results/recorded/references";
constexpr Index n = 17;

Reference read(const std::string& folder, HbarConvention hbar = HbarConvention::paper) {
  return isosyrk::read_reference("--references", folder, smooth_scene(n), hbar, default_modes());
}

// A third integrator, of order 8, with a step at which it is down at rounding: 400 steps of a few
// products, each of which rounds by some 1e-15 relative.
TEST(Reference, AgreesWithAThirdIntegrator) {
  const Scene scene = smooth_scene(n);
  const auto third = gauss(Formulation::algebra, *scene.flow, 4, 1e-14);
  const Matrix W = integrated(*third, scene.initial, scene.time / 400.0, 400);
  const Reference reference = read(recorded);
  EXPECT_LE(relative_error(W, reference.W), 5e-13);
  EXPECT_LE(reference.uncertainty, 5e-13);
}

class ReferenceFolder : public WithFolder {
 protected:
  ReferenceFolder() {
    std::filesystem::copy(recorded, folder_);
    std::ifstream(folder_ / "references.json") >> good_;
    // Of the four the one that is read, so that every change is seen.
    good_["references"] =
        nlohmann::json::array({good_["references"][0]});  // braces alone copy in clang
    for (const char* unread : {"first", "second"}) good_["references"][0].erase(unread);
  }

  void refuses(const std::string& list, const std::string& part = "references.json") const {
    write("references.json", list);
    for (const std::string& each : {"--references " + folder_.string(), part}) {
      expect_refused<BadArgument>([&] { read(folder_); }, each);
    }
  }

  nlohmann::json good_;
};

TEST_F(ReferenceFolder, OfAnotherSceneIsRefused) {
  EXPECT_NO_THROW(read(folder_));
  EXPECT_THROW(read(folder_, HbarConvention::standard), BadArgument);
  EXPECT_THROW(read(folder_ / "nowhere"), BadArgument);
  const std::vector<std::pair<std::string, nlohmann::json>> others = {
      {"time", 4.0}, {"modes_hash", "0"}, {"scene", "rough"}, {"hbar", "standard"}};
  for (const auto& [field, value] : others) {
    nlohmann::json other = good_;
    other[field] = value;
    refuses(other.dump(), "another scene");
  }
  good_["references"][0]["n"] = 9;
  refuses(good_.dump(), "no solution for n = 17");
}

TEST_F(ReferenceFolder, BrokenIsRefused) {
  const std::string whole = good_.dump();
  refuses("");
  refuses("[]");
  refuses(whole.substr(0, whole.size() / 2));
  const auto without_each_field = [&](nlohmann::json& object) {
    const nlohmann::json before = object;
    for (const auto& [field, value] : before.items()) {
      object.erase(field);
      refuses(good_.dump());
      object[field] = nlohmann::json::object();
      refuses(good_.dump());
      object[field] = value;
    }
  };
  without_each_field(good_);
  without_each_field(good_["references"][0]);
  const auto solution = write("smooth_n17.npy", npy(Matrix::Identity(n, n)));
  refuses(whole, "smooth_n17.npy");
  std::filesystem::remove(solution);
  refuses(whole, "smooth_n17.npy: cannot be read");
}

}  // namespace
}  // namespace isosyrk::testing

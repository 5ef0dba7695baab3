// Reference solutions: what they are worth, and that no other file passes for one.
#include "benchmarks/reference.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/simulation/run.h"

namespace isosyrk {
namespace {

constexpr Index n = 7;

class ReferenceFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "reference_test_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static const Reference& reference() {
    static const Reference value = compute_reference(smooth_scene(n), ProductBackend::openblas);
    return value;
  }

  static nlohmann::json document() {
    return nlohmann::json::parse(
        to_json(reference(), smooth_scene(n), HbarConvention::paper, default_modes()));
  }

  void write(const std::string& contents) const {
    std::ofstream(reference_path(folder_, n)) << contents;
  }

  Reference read(HbarConvention hbar = HbarConvention::paper) const {
    return read_reference("--references", folder_, smooth_scene(n), hbar, default_modes());
  }

  void refuses(const std::string& contents) const {
    write(contents);
    try {
      read();
      FAIL() << "read: " << contents.substr(0, 100);
    } catch (const BadArgument& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("reference_n7.json"), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }

  std::string folder_;
};

// A third integrator, of order 8, with a step at which it is down at rounding: 400 steps of a few
// products, each of which rounds by some 1e-15 relative.
TEST_F(ReferenceFile, AgreesWithAThirdIntegrator) {
  const Scene scene = smooth_scene(n);
  SolverOptions options;
  options.tolerance = 1e-14;
  const auto third =
      gauss_entry(Formulation::algebra, 4).make(*scene.flow, options, ProductBackend::openblas);
  Matrix W = scene.initial;
  ASSERT_TRUE(run(*third, W, scene.time / 400.0, 400).converged());
  EXPECT_LE(relative_error(W, reference().W), 5e-13);
  EXPECT_LE(reference().uncertainty, 5e-13);
}

TEST_F(ReferenceFile, IsReadAsItWasWritten) {
  write(document().dump());
  const Reference back = read();
  EXPECT_EQ(back.W, reference().W);
  EXPECT_EQ(back.uncertainty, reference().uncertainty);
  EXPECT_EQ(back.first.integrator, "group5");
  EXPECT_EQ(back.second.steps, reference().second.steps);
}

TEST(Reference, IntegratorsThatDisagreeGiveNone) {
  EXPECT_THROW(compute_reference(smooth_scene(n), ProductBackend::openblas, 1e-18),
               UncertainReference);
}

TEST_F(ReferenceFile, AFileThatIsMissingIsNamed) { EXPECT_THROW(read(), BadArgument); }

TEST_F(ReferenceFile, OfAnotherSceneIsRefused) {
  write(document().dump());
  EXPECT_NO_THROW(read());
  EXPECT_THROW(read(HbarConvention::standard), BadArgument);
  const std::vector<std::pair<std::string, nlohmann::json>> others = {
      {"n", 9},           {"time", 4.0},        {"modes_hash", "0"},
      {"scene", "rough"}, {"hbar", "standard"}, {"format", "other"}};
  for (const auto& [field, value] : others) {
    nlohmann::json other = document();
    other[field] = value;
    refuses(other.dump());
  }
}

TEST_F(ReferenceFile, BrokenIsRefused) {
  const nlohmann::json good = document();
  const std::string whole = good.dump();
  refuses("");
  refuses("[]");
  refuses("no JSON");
  for (std::size_t length = 1; length < whole.size(); length += whole.size() / 20) {
    refuses(whole.substr(0, length));
  }
  for (const auto& [field, value] : good.items()) {
    nlohmann::json other = good;
    other.erase(field);
    refuses(other.dump());
    other[field] = nlohmann::json::object();
    refuses(other.dump());
  }
  nlohmann::json shorter = good;
  shorter["W"].erase(0);
  refuses(shorter.dump());
}

}  // namespace
}  // namespace isosyrk

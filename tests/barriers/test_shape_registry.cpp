// Look-up of shapes by name, and the error that names the nearest one.
#include <gtest/gtest.h>

#include "barriers/shapes/registry.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/math/error.hpp"

namespace bb::shape_registry_test {
namespace {

std::string message(const std::function<void()>& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ShapeRegistry, HoldsTheBuiltInsInOrder) {
  const std::vector<std::string> names = all_shapes().names();
  const std::vector<std::string> expected{"log",       "log_squared", "quadratic",       "cubic",
                                          "two_stage", "exponential", "minimax_bounded", "minimax"};
  ASSERT_GE(names.size(), expected.size());
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), names.begin()));
  for (const Shape& shape : all_shapes()) {
    EXPECT_FALSE(shape.doc.empty()) << shape.name;
    EXPECT_NE(shape.batch_double, nullptr) << shape.name;
    EXPECT_NE(shape.batch_float, nullptr) << shape.name;
    EXPECT_EQ(all_shapes().find(shape.name), &shape);
  }
  EXPECT_EQ(all_shapes().find("nothing"), nullptr);
}

TEST(ShapeRegistry, UnknownNameGetsTheNamesAllowedAndTheNearest) {
  const std::string text = message([] { require_shape("cubik", "/formulation/shape"); });
  EXPECT_NE(text.find("/formulation/shape"), std::string::npos) << text;
  EXPECT_NE(text.find("\"cubik\""), std::string::npos) << text;
  EXPECT_NE(text.find("log, log_squared, quadratic, cubic, two_stage, exponential"), std::string::npos)
      << text;
  EXPECT_NE(text.find("did you mean cubic?"), std::string::npos) << text;
  EXPECT_EQ(message([] { require_shape("zzzzzzzz"); }).find("did you mean"), std::string::npos);
}

TEST(ShapeRegistry, TakenNameIsRefused) {
  Shape shape = require_shape("log");
  const std::size_t before = all_shapes().size();
  const std::string text = message([&] { all_shapes().add(shape, "my.so"); });
  EXPECT_NE(text.find("my.so: found \"log\""), std::string::npos) << text;
  EXPECT_EQ(all_shapes().size(), before);
}

TEST(ShapeRegistry, ArgumentsByName) {
  EXPECT_EQ(require_argument("gap"), Argument::gap);
  EXPECT_EQ(require_argument("squared_gap"), Argument::squared_gap);
  EXPECT_NE(message([] { require_argument("square_gap"); }).find("did you mean squared_gap?"),
            std::string::npos);
}

}  // namespace
}  // namespace bb::shape_registry_test

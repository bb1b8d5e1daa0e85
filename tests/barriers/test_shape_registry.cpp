// Look-up of shapes by name, and the error that names the nearest one.
#include <gtest/gtest.h>

#include "barriers/named_entries.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

std::string message(const std::function<void()>& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ShapeRegistry, HoldsTheFiveBuiltInsInOrder) {
  const std::vector<std::string> names = entry_names(shapes());
  ASSERT_GE(names.size(), 5u);
  const std::vector<std::string> expected{"log", "log_squared", "quadratic", "cubic", "two_stage"};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), names.begin()));
  for (const Shape& shape : shapes()) {
    EXPECT_FALSE(shape.doc.empty()) << shape.name;
    EXPECT_NE(shape.batch_double, nullptr) << shape.name;
    EXPECT_NE(shape.batch_float, nullptr) << shape.name;
    EXPECT_EQ(find_shape(shape.name), &shape);
  }
  EXPECT_EQ(find_shape("nothing"), nullptr);
}

TEST(ShapeRegistry, UnknownNameGetsTheNamesAllowedAndTheNearest) {
  const std::string text = message([] { require_shape("cubik", "/formulation/shape"); });
  EXPECT_NE(text.find("/formulation/shape"), std::string::npos) << text;
  EXPECT_NE(text.find("\"cubik\""), std::string::npos) << text;
  EXPECT_NE(text.find("log, log_squared, quadratic, cubic, two_stage"), std::string::npos) << text;
  EXPECT_NE(text.find("did you mean cubic?"), std::string::npos) << text;
  EXPECT_EQ(message([] { require_shape("zzzzzzzz"); }).find("did you mean"), std::string::npos);
}

TEST(ShapeRegistry, TakenNameIsRefused) {
  Shape shape = require_shape("log");
  const std::size_t before = shapes().size();
  const std::string text = message([&] { register_shape(shape, "my.so"); });
  EXPECT_NE(text.find("my.so: found \"log\""), std::string::npos) << text;
  EXPECT_EQ(shapes().size(), before);
}

TEST(ShapeRegistry, ArgumentsByName) {
  EXPECT_EQ(require_argument("gap"), Argument::gap);
  EXPECT_EQ(require_argument("squared_gap"), Argument::squared_gap);
  EXPECT_NE(message([] { require_argument("square_gap"); }).find("did you mean squared_gap?"),
            std::string::npos);
}

TEST(NamedEntries, NearestCountsEdits) {
  EXPECT_EQ(nearest_name("lgo", {"log", "cubic"}), "");  // two edits of three letters are no resemblance
  EXPECT_EQ(nearest_name("lo", {"log", "cubic"}), "log");
  EXPECT_EQ(nearest_name("two-stage", {"log", "two_stage"}), "two_stage");
}

}  // namespace
}  // namespace bb

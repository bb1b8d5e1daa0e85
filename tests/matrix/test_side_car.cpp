// A system and its side-car: what is written is read back as it was; what does not fit is named by its pointer.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/math/error.hpp"
#include "tests/matrix/stored.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::side_car_test {
namespace {

using nlohmann::json;

StoredSystem full_system() {
  StoredSystem out = chain(7, 2.5);
  out.system.block_vertex = {4, 5, 9};
  out.coordinates = {{0.1, -0.2, 1e-17}, {1.0 / 3, 2, 3}, {4, 5, 6}};
  out.rhs[3] = -0.0;
  out.rhs[4] = 1e-310;
  out.origin = {"drape", "log", "bdf2", "abc", 0.01, 3, 4, "solved", "contact"};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  out.cond = {{Scaling::none, 2, ConditionStatus::ok, 9.5, 0.5, 4.5},
              {Scaling::block_jacobi, 2, ConditionStatus::not_pd, nan, -1, 4}};
  return out;
}

/// Of full_system(), changed.
json side_car(const StoredSystem& stored, const std::string& matrix) {
  return json::parse(side_car_text(stored, "a.mtx", matrix));
}

TEST(SideCar, ASystemComesBackAsItWas) {
  const test::TemporaryFolder folder;
  const StoredSystem a = full_system();
  const std::string matrix = matrix_market_text(a.system.lower);
  write_file(folder / "a.mtx", matrix);
  write_file(folder / "a.json", side_car_text(a, "a.mtx", matrix));
  const StoredSystem b = read_system((folder / "a.mtx").string());
  EXPECT_TRUE(b.has_side_car);
  EXPECT_EQ(b.rhs_source, "side-car");
  EXPECT_EQ(b.system.block_start, a.system.block_start);
  EXPECT_EQ(b.system.block_vertex, a.system.block_vertex);
  EXPECT_EQ(b.coordinates, a.coordinates);
  ASSERT_EQ(b.rhs.size(), a.rhs.size());
  for (Eigen::Index i = 0; i < a.rhs.size(); ++i) {
    EXPECT_EQ(b.rhs[i], a.rhs[i]);
    EXPECT_EQ(std::signbit(b.rhs[i]), std::signbit(a.rhs[i]));
  }
  EXPECT_EQ(b.origin.scene, "drape");
  EXPECT_EQ(b.origin.formulation, "log");
  EXPECT_EQ(b.origin.integrator, "bdf2");
  EXPECT_EQ(b.origin.git_commit, "abc");
  EXPECT_EQ(b.origin.dt_s, 0.01);
  EXPECT_EQ(b.origin.step, 3);
  EXPECT_EQ(b.origin.iteration, 4);
  EXPECT_EQ(b.origin.form, "solved");
  EXPECT_EQ(b.origin.cause, "contact");
  ASSERT_EQ(b.cond.size(), 2);
  EXPECT_EQ(b.cond[0].cond, 9.5);
  EXPECT_EQ(b.cond[1].scaling, Scaling::block_jacobi);
  EXPECT_EQ(b.cond[1].status, ConditionStatus::not_pd);
  EXPECT_TRUE(std::isnan(b.cond[1].cond));
  EXPECT_EQ(b.cond[1].lambda_min, -1);
}

TEST(SideCar, WithoutOneBlocksAndRightHandSideAreAssumed) {
  const test::TemporaryFolder folder;
  for (const int n : {6, 7}) {
    write_file(folder / "a.mtx", matrix_market_text(chain(n, 2.5).system.lower));
    const StoredSystem b = read_system((folder / "a.mtx").string());
    EXPECT_FALSE(b.has_side_car);
    EXPECT_EQ(b.rhs_source, "A * ones");
    EXPECT_EQ(b.system.block_start.size(), n == 6 ? 3u : 8u);
    EXPECT_DOUBLE_EQ(b.rhs[0], 1.5);
    EXPECT_DOUBLE_EQ(b.rhs[1], 0.5);
  }
}

TEST(SideCar, ABlockSizeWillDo) {
  const test::TemporaryFolder folder;
  write_file(folder / "a.mtx", matrix_market_text(chain(4, 2.5).system.lower));
  write_file(folder / "a.json",
             R"({"schema": "barrierbench.matrix/1", "block_size": 2, "rhs": [1, 2, 3, 4.5]})");
  const StoredSystem b = read_system((folder / "a.mtx").string());
  EXPECT_EQ(b.system.block_start, (std::vector<int>{0, 2, 4}));
  EXPECT_EQ(b.rhs[3], 4.5);
}

struct Fault {
  const char* name;
  std::string patch;  // JSON merge patch of a sound side-car; null removes a key
  std::vector<std::string> says;
};

TEST(SideCar, EveryFaultIsNamedWithItsPointer) {
  const std::vector<Fault> faults{
      {"schema",
       R"({"schema": "barrierbench.matrix/2"})",
       {"a.json#/schema", "matrix/2", "barrierbench.matrix/1"}},
      {"no_schema", R"({"schema": null})", {"a.json#/schema", "barrierbench.matrix/1"}},
      {"key", R"({"rsh": 1})", {"a.json#/rsh", "one of schema"}},
      {"rows", R"({"matrix": {"rows": 8}})", {"#/matrix/rows", "8", "7, the rows of the matrix"}},
      {"entries", R"({"matrix": {"entries": 1}})", {"#/matrix/entries", "13, the entries"}},
      {"hash", R"({"matrix": {"sha256": "00"}})", {"#/matrix/sha256", "the hash of the matrix beside it"}},
      {"matrix", R"({"matrix": 3})", {"#/matrix", "an object"}},
      {"no_rhs", R"({"rhs": null})", {"#/rhs", "7"}},
      {"rhs_length", R"({"rhs": [1, 2]})", {"#/rhs", "2 entries", "an array of 7, one a row of the matrix"}},
      {"rhs_word", R"({"rhs": [1, 2, 3, "x", 5, 6, 7]})", {"#/rhs/3", "\"x\"", "a finite number"}},
      {"blocks_end", R"({"block_start": [0, 3, 6]})", {"#/block_start", "0 to 7 in steps of 1 to 3"}},
      {"blocks_wide", R"({"block_start": [0, 4, 7]})", {"#/block_start", "steps of 1 to 3"}},
      {"blocks_word", R"({"block_start": [0, 2.5, 7]})", {"#/block_start/1", "2.5", "an integer"}},
      {"both", R"({"block_size": 1})", {"#/block_size", "one of block_size and block_start"}},
      {"size", R"({"block_start": null, "block_size": 4})", {"#/block_size", "an integer from 1 to 3"}},
      {"divisor", R"({"block_start": null, "block_size": 2})", {"#/block_size", "a divisor of the 7 rows"}},
      {"vertices", R"({"block_vertex": [1]})", {"#/block_vertex", "1 entries", "an array of 3, one a block"}},
      {"points", R"({"coordinates_m": [[0, 0, 0]]})", {"#/coordinates_m", "an array of 3"}},
      {"point",
       R"({"coordinates_m": [[0, 0, 0], [1, 2], [0, 0, 0]]})",
       {"#/coordinates_m/1", "three numbers"}},
      {"form", R"({"form": "good"})", {"#/form", "one of solved, clamped, exact"}},
      {"dt", R"({"dt_s": 0})", {"#/dt_s", "a number > 0"}},
      {"step", R"({"step": -1})", {"#/step", "-1", "an integer from 0"}},
      {"cause", R"({"cause": 3})", {"#/cause", "a string"}},
      {"cond",
       R"({"cond": [{"scaling": "none", "tier": 2, "status": "fine"}]})",
       {"#/cond/0/status", "\"fine\"", "one of ok, lower_bound, singular, not_pd, not_converged"}},
      {"cond_number",
       R"({"cond": [{"scaling": "none", "tier": 2, "status": "ok", "cond": "1"}]})",
       {"#/cond/0/cond", "a number"}},
  };
  const test::TemporaryFolder folder;
  const StoredSystem a = full_system();
  const std::string matrix = matrix_market_text(a.system.lower);
  write_file(folder / "a.mtx", matrix);
  for (const Fault& fault : faults) {
    json changed = side_car(a, matrix);
    changed.merge_patch(json::parse(fault.patch));
    write_file(folder / "a.json", changed.dump());
    try {
      read_system((folder / "a.mtx").string());
      ADD_FAILURE() << fault.name << " was accepted";
    } catch (const ConfigError& error) {
      const std::string what = error.what();
      EXPECT_EQ(error.violations().size(), 1u) << fault.name << ": " << what;
      for (const std::string& word : fault.says) {
        EXPECT_NE(what.find(word), std::string::npos) << fault.name << ": " << what;
      }
    }
  }
}

TEST(SideCar, SeveralFaultsAreSaidAtOnce) {
  const test::TemporaryFolder folder;
  write_file(folder / "a.mtx", matrix_market_text(chain(3, 2.5).system.lower));
  write_file(folder / "a.json", R"({"schema": "barrierbench.matrix/1", "form": "x", "dt_s": 0, "rhs": [1]})");
  try {
    read_system((folder / "a.mtx").string());
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations().size(), 3u) << error.what();
  }
}

TEST(SideCar, ATornOneIsRefusedWithItsLine) {
  const test::TemporaryFolder folder;
  const StoredSystem a = full_system();
  const std::string matrix = matrix_market_text(a.system.lower);
  write_file(folder / "a.mtx", matrix);
  const std::string text = side_car_text(a, "a.mtx", matrix);
  write_file(folder / "a.json", text.substr(0, text.size() / 2));
  try {
    read_system((folder / "a.mtx").string());
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("a.json:"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace bb::side_car_test

// Hashes, ids, statistics, timers, machine.
#include "core/base/record/provenance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "tests/record/sample_record.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::provenance_test {
namespace {

TEST(Sha256, KnownAnswers) {  // FIPS 180-4 examples
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, FilesAndMissingFiles) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "text";
  std::ofstream(path) << "abc";
  EXPECT_EQ(sha256_file(path), sha256_hex("abc"));
  const std::string long_text(200'000, 'x');  // more than one block of reading
  std::ofstream(path) << long_text;
  EXPECT_EQ(sha256_file(path), sha256_hex(long_text));
  std::filesystem::remove(path);
  EXPECT_EQ(sha256_file(path), "");
}

TEST(StateHash, IsOfTheBitsInLittleEndianOrder) {
  Positions x(3, 1);
  x << 1, -2, 0;
  // 1.0, -2.0, 0.0 as IEEE 754 binary64, least significant byte first
  const std::string bytes("\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\xc0\0\0\0\0\0\0\0\0", 24);
  EXPECT_EQ(state_hash(x), sha256_hex(bytes));
  x(2) = -0.0;
  EXPECT_NE(state_hash(x), sha256_hex(bytes));
}

TEST(ConfigId, IgnoresBlanksAndTheOrderOfKeys) {
  EXPECT_EQ(config_id(R"({"b": 1, "a": [1, 2.50]})"), config_id(R"({"a":[1,2.5],"b":1})"));
  EXPECT_NE(config_id(R"({"a":[2.5,1],"b":1})"), config_id(R"({"a":[1,2.5],"b":1})"));
  EXPECT_THROW(config_id("{"), std::invalid_argument);
}

TEST(ConfigId, CoversFilesByContentAndNoThreads) {
  const std::string a = R"({"threads": 1, "mesh": {"file": "/a/x.ply", "sha256": "11"}, "steps": 3})";
  const auto with = [&a](const std::string& old_text, const std::string& new_text) {
    std::string out = a;
    out.replace(out.find(old_text), old_text.size(), new_text);
    EXPECT_NE(out, a);
    return config_id(out);
  };
  EXPECT_EQ(with("\"threads\": 1", "\"threads\": 7"), config_id(a));
  EXPECT_EQ(with("/a/x.ply", "../b/y.ply"), config_id(a));
  EXPECT_NE(with("x.ply", "x.obj"), config_id(a));  // the suffix chooses the reader
  EXPECT_NE(with("11", "12"), config_id(a));
  EXPECT_NE(with("3", "4"), config_id(a));
  EXPECT_NE(config_id(R"({"file": "a.ply"})"),
            config_id(R"({"file": "b.ply"})"));  // nothing says the content
}

/// Each alone changes the run_id.
TEST(Ids, TheRunIdCoversAllThatMadeTheRecord) {
  const auto id_of = [](auto change) {
    RunRecord record = test::sample_record();
    record.provenance.libraries = {{"blas", "OpenBLAS Haswell"}};
    change(record);
    fill_ids(record);
    return record.ids.run_id;
  };
  const std::string id = id_of([](RunRecord&) {});
  EXPECT_NE(id_of([](RunRecord& r) { r.config.text = "{}"; }), id);
  EXPECT_NE(id_of([](RunRecord& r) { r.provenance.plugins[0].sha256 = std::string(64, 'a'); }), id);
  EXPECT_NE(id_of([](RunRecord& r) { r.provenance.plugins.clear(); }), id);
  EXPECT_NE(id_of([](RunRecord& r) { r.provenance.libraries["blas"] = "OpenBLAS SkylakeX"; }), id);
  EXPECT_NE(id_of([](RunRecord& r) { r.provenance.threads = 5; }), id);
  EXPECT_NE(id_of([](RunRecord& r) { r.machine.cpu_model = "another"; }), id);
  EXPECT_NE(id_of([](RunRecord& r) { r.machine.card = "a card"; }), id);
  EXPECT_EQ(id_of([](RunRecord& r) { r.provenance.plugins[0].file = "elsewhere.so"; }), id);
  EXPECT_EQ(id_of([](RunRecord& r) { r.provenance.argv = {"other"}; }), id);
}

TEST(Ids, NameConfigBuildAndMachine) {
  RunRecord a = test::sample_record(), b = a;
  fill_ids(a);
  b.provenance.threads = 3;
  fill_ids(b);
  EXPECT_EQ(a.ids.config_id, config_id(a.config.text));
  EXPECT_EQ(a.ids.build_id, sha256_file("/proc/self/exe"));
  EXPECT_EQ(a.ids.build_id.size(), 64u);
  EXPECT_EQ(a.ids.machine_id, b.ids.machine_id);
  EXPECT_NE(a.ids.run_id, b.ids.run_id);
}

TEST(Provenance, SaysWhatThisBinaryIs) {
  const Provenance p = collect_provenance({"barrierbench", "run"}, 2);
  EXPECT_EQ(p.argv.size(), 2u);
  EXPECT_EQ(p.threads, 2);
  EXPECT_NE(p.compiler, "");
  for (const char* flag :
       {"-ffp-contract=off", "-fno-tree-vectorize", "-fno-math-errno", "-fno-trapping-math"}) {
    EXPECT_NE(p.flags.find(flag), std::string::npos) << flag << " in " << p.flags;
  }
  EXPECT_EQ(p.build_type == "Release", p.flags.find("hinge_lanes.cpp: -O3") != std::string::npos) << p.flags;
  EXPECT_EQ(p.blas.threads, 1);  // also in the first record, before anything was factorised
  EXPECT_NE(p.blas.kernel, "");
  EXPECT_NE(p.blas.config.find("OpenBLAS"), std::string::npos) << p.blas.config;
  EXPECT_NE(p.blas.library.find("blas"), std::string::npos) << p.blas.library;
  EXPECT_FALSE(p.fast_math);
  for (const char* name : {"eigen", "cholmod", "blas", "tbb", "fmt"})
    EXPECT_NE(p.libraries.at(name), "") << name;
  EXPECT_TRUE(p.git_commit.empty() || p.git_commit.size() == 40) << p.git_commit;
}

TEST(Machine, IsFilled) {
  const Machine m = collect_machine();
  EXPECT_GE(m.cores, 1);
  EXPECT_GT(m.mem_bytes, 1u << 20);
  EXPECT_NE(m.kernel.find("Linux"), std::string::npos);
  EXPECT_GT(peak_rss_bytes(), 1u << 20);
}

TEST(Time, UtcIsIso8601) {
  const std::string now = utc_now();
  ASSERT_EQ(now.size(), 24u);
  EXPECT_EQ(now[10], 'T');
  EXPECT_EQ(now.back(), 'Z');
}

TEST(Stats, QuantilesOfTheFiniteValues) {
  const Stats s = summarize({5, 1, std::nan(""), 3, 2, 4, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(s.n, 5u);
  EXPECT_EQ(s.min.value, 1);
  EXPECT_EQ(s.median.value, 3);
  EXPECT_EQ(s.max.value, 5);
  EXPECT_EQ(s.sum.value, 15);
  EXPECT_DOUBLE_EQ(s.p05.value, 1.2);
  EXPECT_DOUBLE_EQ(s.p95.value, 4.8);
  EXPECT_STREQ(summarize({}).median.status, "empty");
  EXPECT_EQ(summarize({1, 2, 30}).median.value, 2);  // and not the mean
}

void rest_2_ms() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }

TEST(PhaseClock, ChargesEveryMomentToOnePhase) {
  PhaseClock clock;
  rest_2_ms();
  const double start = now_s();
  clock.restart(Phase::step_control);  // what was before counts no more
  rest_2_ms();
  {
    const ScopedPhase outer(clock, Phase::assembly);
    rest_2_ms();
    {
      const ScopedPhase inner(clock, Phase::stiffness);
      rest_2_ms();
    }
    rest_2_ms();
  }
  rest_2_ms();
  const PhaseTimes times = clock.read();
  const double wall = now_s() - start;
  EXPECT_GE(times[Phase::step_control], 0.004);
  EXPECT_GE(times[Phase::assembly], 0.004);  // on both sides of the inner scope, without it
  EXPECT_GE(times[Phase::stiffness], 0.002);
  EXPECT_GE(wall, times.total_s());
  EXPECT_LT(wall - times.total_s(), 1e-3);
  EXPECT_EQ(times[Phase::elastic], 0);
}

TEST(PhaseClock, ALapIsWhatWasChargedSinceTheOneBefore) {
  PhaseClock clock;
  clock.restart(Phase::elastic);
  rest_2_ms();
  const PhaseTimes first = clock.lap();
  clock.change(Phase::output);
  rest_2_ms();
  const PhaseTimes second = clock.lap();
  EXPECT_GE(first[Phase::elastic], 0.002);
  EXPECT_EQ(first[Phase::output], 0);
  EXPECT_GE(second[Phase::output], 0.002);
  PhaseTimes sum = first;
  sum += second;
  EXPECT_NEAR(sum.total_s(), clock.read().total_s(), 1e-3);
  EXPECT_NEAR(sum.solve_s(), sum[Phase::elastic], 1e-9);  // observers are no time of the method
}

TEST(PhaseClock, GivesACalleesOwnPartToItsPhase) {
  PhaseClock clock;
  clock.restart(Phase::linear_solve);
  rest_2_ms();
  const double all = clock.read().total_s();
  clock.move(Phase::linear_solve, Phase::linear_factor, 0.001);
  EXPECT_EQ(clock.read()[Phase::linear_factor], 0.001);
  EXPECT_GE(clock.read()[Phase::linear_solve], all - 0.001);
  EXPECT_GT(clock.read()[Phase::linear_solve], 0);
}

TEST(Outcome, TheMoreSpecificWordWins) {
  EXPECT_EQ(worse(Outcome::ok, Outcome::newton_stall), Outcome::newton_stall);
  EXPECT_EQ(worse(Outcome::penetration, Outcome::newton_stall), Outcome::penetration);
  EXPECT_EQ(to_string(Outcome::ok), "ok");
  EXPECT_EQ(to_string(Outcome::stall_overload), "stall_overload");
  EXPECT_EQ(static_cast<int>(Outcome::ok) + 1, n_words<Outcome>);
}

}  // namespace
}  // namespace bb::provenance_test

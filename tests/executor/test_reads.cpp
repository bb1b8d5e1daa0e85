// What the host reads of an executor was written before: whole runs on memory that is marked until somebody writes to it.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/executor/same_runs.hpp"

namespace bb::exec_reads_test {
namespace {

/// Counts words of downloads that nothing has written since their memory was taken.
class MarkingExecutor final : public exec::HostExecutor {
 public:
  /// words: read by all downloads; unwritten: of these.
  struct Count {
    std::size_t downloads = 0, words = 0, unwritten = 0;
  };
  explicit MarkingExecutor(Count& count) : count_(count) {}
  void download(void* to, const void* from, std::size_t bytes) override {
    HostExecutor::download(to, from, bytes);
    ++count_.downloads;
    for (std::size_t at = 0; at + sizeof(Word) <= bytes; at += sizeof(Word)) {
      Word word = 0;
      memcpy(&word, static_cast<const char*>(to) + at, sizeof(Word));
      ++count_.words;
      count_.unwritten += word == mark;
    }
  }

 private:
  using Word = std::uint32_t;
  static constexpr Word mark =
      0xb9b9b9b9;  // no index of these scenes, and not half of a number that they compute

  void* allocate_bytes(std::size_t bytes) override {
    void* memory = HostExecutor::allocate_bytes(bytes);
    if (memory) memset(memory, static_cast<unsigned char>(mark), bytes);
    return memory;
  }
  Count& count_;
};

TEST(ExecutorReads, EveryNumberThatTheHostReadsWasWrittenBefore) {
  for (const Scene& scene : {test::cloth_on_floor(), test::touching(test::two_sheets(), 0.01)}) {
    SCOPED_TRACE(scene.name);
    MarkingExecutor::Count count;
    const test::RunEnd end =
        test::run_on(scene, "cubic", 5, [&] { return std::make_unique<MarkingExecutor>(count); });
    EXPECT_GT(end.contacts, 0u);
    EXPECT_GT(count.downloads, 100u);
    EXPECT_GT(count.words, 1000u);
    EXPECT_EQ(count.unwritten, 0u);
  }
}

}  // namespace
}  // namespace bb::exec_reads_test

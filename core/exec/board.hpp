// The numbers of an executor that its host reads: they lie side by side and come down together. So what several launches
// found is one wait, where all of them are launched before the first number is requested.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/exec/buffer.hpp"

namespace bb::exec {

class Board {
 public:
  static constexpr std::size_t capacity = 32768;  // B

  /// Places that nothing was written to come down with the others: so they have a value.
  explicit Board(Executor& executor) : memory_(executor, "numbers that are read", capacity) {
    memory_.fill_zero();
  }
  /// The board of an executor, which lives as long as somebody holds it.
  static std::shared_ptr<Board> of(Executor& executor) {
    std::shared_ptr<Board> board = executor.board_.lock();
    if (!board) executor.board_ = board = std::make_shared<Board>(executor);
    return board;
  }

  /// Errors: std::logic_error when the board is full.
  std::size_t take(std::size_t bytes);
  void give_back(std::size_t at, std::size_t bytes) { free_.push_back({at, bytes}); }
  std::byte* on_executor(std::size_t at) { return memory_.data() + at; }
  const std::byte* on_executor(std::size_t at) const { return memory_.data() + at; }
  /// Launches write numbers: what was read is no longer all that there is.
  void written() { fresh_ = false; }
  /// Waits, unless nothing was written since it last did.
  const std::byte* read(std::size_t at);

 private:
  struct Place {
    std::size_t at, bytes;
  };
  Buffer<std::byte> memory_;
  std::vector<std::byte> here_;
  std::vector<Place> free_;
  std::size_t used_ = 0;
  bool fresh_ = false;
};

/// A value on the board. Plain numbers.
template <class T>
class Reading {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 16);

 public:
  explicit Reading(Executor& executor)
      : executor_(&executor), board_(Board::of(executor)), at_(board_->take(sizeof(T))) {}
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  ~Reading() { board_->give_back(at_, sizeof(T)); }

  /// For launches that write it.
  T* to_write() {
    board_->written();
    return reinterpret_cast<T*>(board_->on_executor(at_));
  }
  /// For launches that read it.
  const T* data() const { return reinterpret_cast<const T*>(std::as_const(*board_).on_executor(at_)); }
  /// Every byte of it.
  void fill(unsigned char byte) { executor_->fill_bytes(to_write(), byte, sizeof(T)); }
  /// Waits, unless it came down with another one.
  T get() const {
    T out;
    memcpy(&out, board_->read(at_), sizeof(T));
    return out;
  }

 private:
  Executor* executor_;
  std::shared_ptr<Board> board_;
  std::size_t at_;
};

}  // namespace bb::exec

// A column of an executor's memory, with a name that the ledger and messages use. Count first, then resize: growth
// keeps no values, so that there never are two copies of a large column.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/exec/executor.hpp"

namespace bb::exec {

template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// The executor must outlive the buffer.
  Buffer(Executor& executor, std::string name, Index n = 0) : executor_(&executor), name_(std::move(name)) {
    resize(n);
  }
  Buffer(Buffer&& other) noexcept
      : executor_(other.executor_),
        name_(std::move(other.name_)),
        data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        room_(std::exchange(other.room_, 0)) {}
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() { free(); }

  /// Values are lost where it grows. Memory is kept when it shrinks. Errors: OutOfMemory.
  void resize(Index n) {
    if (n > room_) {
      free();
      data_ = static_cast<T*>(executor_->allocate(name_, static_cast<std::size_t>(n) * sizeof(T)));
      room_ = n;
    }
    size_ = n;
  }
  /// resize() with a quarter more memory when it has to grow: for columns that grow from iterate to iterate.
  void grow(Index n) {
    if (n > room_) resize(n + n / 4);
    size_ = n;
  }
  /// For columns whose length follows the contacts: grow() up to 64 MiB, so that an iterate like the last one allocates
  /// nothing; exact beyond it, where a quarter more is much.
  void fit(Index n) {
    constexpr Index most_with_room = (Index{64} << 20) / static_cast<Index>(sizeof(T));
    n < most_with_room ? grow(n) : resize(n);
  }
  /// Gives the memory back.
  void free() {
    if (room_ == 0) return;
    executor_->release(name_, data_, bytes());
    data_ = nullptr;
    size_ = room_ = 0;
  }
  /// Contents, not names. Both of one executor.
  void swap(Buffer& other) noexcept;

  T* data() { return data_; }
  const T* data() const { return data_; }
  Index size() const { return size_; }
  /// In use, memory that is kept included.
  std::size_t bytes() const { return static_cast<std::size_t>(room_) * sizeof(T); }

  /// Resizes to the values.
  void upload(std::span<const T> values) {
    resize(static_cast<Index>(values.size()));
    executor_->upload(data_, values.data(), values.size_bytes());
  }
  /// to: as long as the buffer.
  void download(std::span<T> to) const { executor_->download(to.data(), data_, to.size_bytes()); }
  std::vector<T> download() const {
    std::vector<T> out(static_cast<std::size_t>(size_));
    download(out);
    return out;
  }
  /// The first numbers alone.
  void download_first(std::span<T> to) const { executor_->download(to.data(), data_, to.size_bytes()); }
  T get(Index i) const {
    T value{};
    executor_->download(&value, data_ + i, sizeof(T));
    return value;
  }
  void set(Index i, const T& value) { executor_->upload(data_ + i, &value, sizeof(T)); }
  void copy_from(const Buffer& other) {
    resize(other.size_);
    executor_->copy(data_, other.data_, static_cast<std::size_t>(size_) * sizeof(T));
  }
  void fill_zero() { executor_->fill_bytes(data_, 0, static_cast<std::size_t>(size_) * sizeof(T)); }

 private:
  Executor* executor_;
  std::string name_;
  T* data_ = nullptr;
  Index size_ = 0, room_ = 0;
};

template <class T>
void Buffer<T>::swap(Buffer& other) noexcept {
  std::swap(data_, other.data_), std::swap(size_, other.size_), std::swap(room_, other.room_);
  std::swap(name_, other.name_);  // the ledger knows memory by the name that it was requested under
}

}  // namespace bb::exec

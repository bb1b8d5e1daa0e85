#include "core/base/input/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace bb {
namespace {

using nlohmann::json;

/// Hands out characters and counts those that were taken, so that every error has a line.
struct CountingIterator {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  const char* at;
  std::size_t* taken;

  reference operator*() const { return *at; }
  CountingIterator& operator++() {
    ++at;
    ++*taken;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at == other.at; }
  bool operator!=(const CountingIterator& other) const { return at != other.at; }
};

/// Watches the parser's events and refuses what the grammar alone allows.
class Watch {
 public:
  Watch(const std::string& text, const std::string& source, LargeIntegers large_integers)
      : text_(text), source_(source), refuse_large_(large_integers == LargeIntegers::refused) {}

  json parse() {
    try {
      const auto see = [this](int depth, json::parse_event_t event, json& value) {
        on_event(depth, event, value);
        return true;
      };
      const char* begin = text_.data();
      return json::parse(CountingIterator{begin, &taken_}, CountingIterator{begin + text_.size(), &taken_},
                         see);
    } catch (const json::parse_error& error) {
      taken_ = error.byte;
      fail(JsonFault::syntax, without_prefix(error.what()), "JSON");
    } catch (const json::out_of_range& error) {
      fail(JsonFault::number_range, without_prefix(error.what()), "numbers within the range of double");
    }
  }

 private:
  void on_event(int depth, json::parse_event_t event, const json& value) {
    using Event = json::parse_event_t;
    step_to(event, value);
    if ((event == Event::object_start || event == Event::array_start) && depth >= max_json_depth) {
      fail(JsonFault::too_deep, fmt::format("more than {} levels of arrays and objects", max_json_depth),
           fmt::format("at most {}", max_json_depth));
    }
    if (event == Event::object_start) keys_.emplace_back();
    if (event == Event::object_end) keys_.pop_back();
    if (event == Event::key && !keys_.back().insert(value.get<std::string>()).second) {
      fail(JsonFault::repeated_key, fmt::format("the key {} twice in one object", value.dump()),
           "each key once");
    }
    if (event == Event::value && refuse_large_ && is_large(value)) {
      fail(JsonFault::large_integer, value.dump(),
           fmt::format("integers from -{0} to {0} (2^53)", max_json_integer), pointer());
    }
  }

  /// Keeps `open_`, the way to the value that is read now.
  void step_to(json::parse_event_t event, const json& value) {
    using Event = json::parse_event_t;
    const bool begins = event == Event::object_start || event == Event::array_start;
    if ((begins || event == Event::value) && !open_.empty() && open_.back().is_array) ++open_.back().index;
    if (event == Event::key) open_.back().key = value.get<std::string>();
    if (begins) open_.push_back({event == Event::array_start, -1, ""});
    if (event == Event::object_end || event == Event::array_end) open_.pop_back();
  }

  /// JSON pointer of the value that was read last; empty for the whole text.
  std::string pointer() const {
    json::json_pointer out;
    for (const Level& level : open_) {
      out /= level.is_array ? std::to_string(level.index) : level.key;
    }
    return out.to_string();
  }

  static bool is_large(const json& value) {
    if (value.is_number_unsigned()) return value.get<std::uint64_t>() > std::uint64_t{max_json_integer};
    return value.is_number_integer() && value.get<std::int64_t>() < -max_json_integer;
  }

  /// Without "[json.exception.parse_error.101] parse error at line 1, column 2: ".
  static std::string without_prefix(const std::string& what) {
    const std::size_t colon = what.find(": "), bracket = what.find("] ");
    if (colon != std::string::npos) return what.substr(colon + 2);
    return bracket == std::string::npos ? what : what.substr(bracket + 2);
  }

  [[noreturn]] void fail(JsonFault fault, std::string found, std::string allowed,
                         const std::string& pointer = "") const {
    // the character that was taken last is the one that showed the fault
    const auto last = static_cast<std::ptrdiff_t>(std::min(taken_ > 0 ? taken_ - 1 : 0, text_.size()));
    const auto line = 1 + std::count(text_.begin(), text_.begin() + last, '\n');
    const std::string place = pointer.empty() ? "" : "#" + pointer;
    throw JsonError(fault, fmt::format("{}:{}{}", source_, line, place), std::move(found),
                    std::move(allowed));
  }

  /// An array or object that is open.
  struct Level {
    bool is_array;
    long index;  // of the element that is read
    std::string key;
  };

  const std::string& text_;
  const std::string& source_;
  bool refuse_large_;
  std::size_t taken_ = 0;
  std::vector<Level> open_;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
};

}  // namespace

json parse_json(const std::string& text, const std::string& source, LargeIntegers large_integers) {
  return Watch(text, source, large_integers).parse();
}

json read_json_file(const std::string& path, const InputKind& kind) {
  return parse_json(read_input_file(path, kind), path);
}

}  // namespace bb

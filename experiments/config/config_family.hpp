// One config file under many overrides: the cases of a sweep, which share nearly all of what there is to read and to write.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "experiments/config/run_config.hpp"

namespace bb {

struct ProceduralScene;

/// Reads configs of one file one after the other. An override acts on one section (document.hpp) and a section is checked and
/// read by itself, but for the defaults that scene and device decide; so only sections are read anew whose overrides are other
/// ones than those of the config before. What sections decide and forbid each other is settled for every config. Whatever is wrong
/// with a config is reported by parse_config. Not for several threads at once: one family a thread.
class ConfigFamily {
 public:
  /// Errors: ConfigError: the file cannot be read.
  explicit ConfigFamily(std::string path);

  /// load_config(path, overrides) to the last bit. It stands until the next call. Errors: those of load_config.
  /// Cost: about a tenth of load_config where one section has other overrides.
  const RunConfig& read(std::span<const std::string> overrides);

  struct Identity {
    std::string config_id;  // config_id of the config
    std::string document;   // a text that is another one wherever the resolved document is
    std::string scene;      // SHA-256 of the section `scene` of the resolved document, as text
  };
  /// Of the config that was read last; sections are written anew where they are not the same to the last bit.
  /// Precondition: its linear solver is not `auto`, which names another one before a config has an id.
  Identity identity();

 private:
  struct Written {
    std::string member;  // "key":value, without the places of files; empty: it is not written
    std::string places;  // SHA-256 of the value where that has places of files, else empty
  };

  /// False where parse_config has to say what is wrong.
  bool read_sections(std::span<const std::string> overrides);
  /// own: the overrides of that section, as in overrides_.
  bool read_section(const Parameter& row, const std::string& own, std::span<const std::string> overrides);
  void write_section(const std::string& name);
  bool make_base(std::span<const std::string> overrides);
  bool sort_overrides(std::span<const std::string> overrides);

  std::string path_, folder_, text_;
  bool known_ = false;       // base_ and overrides_ are those of read_
  std::string method_;       // overrides of the method that base_ was made with
  nlohmann::json base_;      // the document under all other overrides
  nlohmann::json document_;  // of the config that was read last
  std::vector<std::string>
      overrides_;  // of each row of a config, those that it was read with, each ended by a zero byte
  std::vector<std::string> given_;  // the same of the config that is being read
  /// What sections were checked to, with presets and formulas expanded, by name and overrides; null: not given. Most sections of
  /// a sweep come again.
  std::unordered_map<std::string, nlohmann::json> checked_;
  const ProceduralScene* scene_ = nullptr;
  RunConfig blank_;   // defaults and scene, before any other section is read
  RunConfig read_;    // with every section, before they are settled
  RunConfig config_;  // settled
  std::map<std::string, Written> texts_;
  RunConfig written_;  // what texts_ are of, but for the scene
  bool scene_is_written_ = false;
  std::string scene_hash_;
};

}  // namespace bb

// The command line: parses flags, loads plugins, turns exceptions into exit codes. No other
// file prints errors.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <sstream>
#include <utility>

#include "barriers/plugins.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/base/record/provenance.hpp"
#include "core/base/record/schema_version.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/memory.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/run/device_run.hpp"

namespace {

using namespace bb::cli;

/// Nobody can read what was answered; an error that happened before stays what it is. Reported once, and not for a reader that has had
/// enough (head).
int unwritable_output(int code) {
  static bool said = errno == EPIPE;
  if (!std::exchange(said, true)) say("the standard output cannot be written\n");
  return code == exit_ok ? exit_try_again : code;
}

int guarded(const std::function<int()>& verb) {
  try {
    return verb();
  } catch (const bb::ConfigError& error) {
    say(fmt::format("{}\n", error.what()));
    return exit_bad_input;
  } catch (const bb::RecordError& error) {
    say(fmt::format("{}\n", error.what()));
    return error.lasting ? exit_bad_input : exit_try_again;
  } catch (const bb::Interrupted& stopped) {
    const std::string nothing = "no record was written; the same command runs it again";
    say(fmt::format("interrupted: {}\n", stopped.kept.empty() ? nothing : stopped.kept));
    return exit_try_again;
  } catch (const bb::DeviceStopped& stopped) {
    say(fmt::format("{}\n", stopped.what()));
    return stopped.outcome == bb::Outcome::oom ? exit_try_again : exit_internal;
  } catch (const bb::exec::OutOfMemory& error) {
    say(fmt::format("{}\n", error.what()));
    return exit_try_again;
  } catch (const std::bad_alloc&) {
    say("out of memory\n");
    return exit_try_again;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return unwritable_output(exit_ok);
    say(fmt::format("internal error: {}\n", error.what()));
    return exit_internal;
  }
}

/// Options that every verb takes, before the verb and after it, so that the help of each verb shows them.
void common_arguments(CLI::App& app, CommonOptions& common, std::vector<std::string>& plugins) {
  app.add_option(
         "--plugin", plugins,
         "a shared library (.so) with shapes, stiffness policies or integrators, loaded before anything "
         "is read; may be repeated (examples/plugins/README.md)")
      ->allow_extra_args(false);
  app.add_option(
         "--progress", common.progress,
         "auto (one line that is rewritten on a terminal, else a line every 30 s), plain (a line every 10 s) "
         "or none")
      ->check(CLI::IsMember({"auto", "plain", "none"}));
  app.add_option("--progress-every", common.progress_every_s, "seconds between two such lines")
      ->check(finite_number(0, 1e6, true));
  app.add_option("--blas-kernel", common.blas_kernel,
                 "haswell: the same factors on every x86-64-v3 machine (default, unless OPENBLAS_CORETYPE is "
                 "set); native: what OPENBLAS_CORETYPE names, else what OpenBLAS picks by the "
                 "processor")
      ->check(CLI::IsMember({"haswell", "native"}));
}

/// The first word of the command line that is no option and no value of an option before the verb.
std::string first_word(const std::vector<std::string>& argv) {
  for (std::size_t i = 1; i < argv.size(); ++i) {
    if (argv[i] == "--plugin" || argv[i] == "--progress" || argv[i] == "--progress-every" ||
        argv[i] == "--blas-kernel") {
      ++i;
    } else if (!argv[i].starts_with("-")) {
      return argv[i];
    }
  }
  return "";
}

/// Errors: ConfigError with the nearest verb when the command line starts with a word that is none.
void require_verb(const std::vector<std::string>& argv) {
  const std::string word = first_word(argv);
  if (word.empty() || bb::find_named(verbs(), word) != nullptr) return;
  throw bb::unknown_name("bench", word, typed_names());
}

/// A verb under its former name, which a note reports: of the program alone, the front door has such names of its own.
void settle_old_name(std::vector<std::string>& argv) {
  const auto old = std::find(argv.begin() + 1, argv.end(), "neutral");
  if (old == argv.end() || first_word(argv) != "neutral") return;
  *old = "export-scene";
  say("note: \"neutral\" is now \"export-scene\"\n");
}

/// `help VERB` is `VERB --help`, but for a word that is a file format too: `help sweep` is about sweep files.
void settle_help(std::vector<std::string>& argv) {
  if (argv.size() != 3 || argv[1] != "help" || argv[2] == "sweep") return;
  const bool is_verb = bb::find_named(verbs(), argv[2]) != nullptr;
  if (is_verb) argv = {argv[0], argv[2], "--help"};
}

/// What was given before the verb and after it.
struct Given {
  CommonOptions common;
  std::vector<std::string> plugins_before, plugins_after;
};

/// Help whose usage has the verb as a user types it.
struct TypedUsage : CLI::Formatter {
  explicit TypedUsage(const char* name) : typed(name) {}
  std::string make_usage(const CLI::App* app, std::string) const override {
    return CLI::Formatter::make_usage(app, fmt::format("bench {}", typed));
  }
  const char* typed;
};

/// A part of the command line for each verb; what it does once that is read.
std::vector<std::pair<CLI::App*, Action>> declare_verbs(CLI::App& app, Given& given) {
  std::vector<std::pair<CLI::App*, Action>> out;
  for (const Verb& verb : verbs()) {
    CLI::App* part = app.add_subcommand(verb.name, verb.doc);
    part->formatter(std::make_shared<TypedUsage>(verb.typed));
    part->footer(std::string("example: ") + verb.example);
    out.emplace_back(part, verb.declare(*part));
    common_arguments(*part, given.common, given.plugins_after);
    refuse_empty_values(*part);
  }
  return out;
}

/// What --version reports.
std::string version_text() {
  const bb::Provenance made = bb::collect_provenance({}, 1);
  return fmt::format("barrierbench {}, commit {}{}, {}, records {}", made.tool_version,
                     made.git_commit.substr(0, 10), made.git_dirty ? " (files differed from it)" : "",
                     made.compiler, bb::run_schema_version);
}

/// Help, or what is wrong with the command line.
int answer_of_parser(const CLI::App& app, const CLI::ParseError& error) {
  std::ostringstream answer, complaint;
  const int code = app.exit(error, answer, complaint);
  say(complaint.str());
  std::fputs(answer.str().c_str(), stdout);
  const bool written = std::fflush(stdout) == 0;
  return code != 0 ? exit_bad_input : written ? exit_ok : unwritable_output(exit_ok);
}

}  // namespace

bb::PluginFile bb::cli::load_plugin_file(const std::string& file) {
  const std::string name = bb::register_plugin(file).name;  // refuses what is no regular file
  return {name, file, bb::sha256_file(file)};
}

// NOLINTNEXTLINE(bugprone-exception-escape): outside guarded() only the parser's own tables are made
int main(int argc, char** argv) {
  prepare_streams();
  keep_freed_memory();
  Given given;
  CommonOptions& common = given.common;
  common.argv.assign(argv, argv + argc);
  settle_old_name(common.argv);
  settle_help(common.argv);
  CLI::App app{"barrierbench: contact barriers compared in one Newton + ACCD pipeline"};
  app.name("bench");
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text);
  common_arguments(app, common, given.plugins_before);
  refuse_empty_values(app);
  const auto parts = declare_verbs(app, given);

  if (const int code = guarded([&] { return require_verb(common.argv), exit_ok; }); code != exit_ok) {
    return code;
  }
  try {
    app.parse(std::vector<std::string>(common.argv.rbegin(),
                                       common.argv.rend() - 1));  // as CLI11 has it: last first
  } catch (const CLI::ParseError& error) {
    return answer_of_parser(app, error);
  }
  // Nothing was read so far: this may start the program again.
  if (const int code = guarded([&] { return settle_blas_kernel(common.blas_kernel, common.argv), exit_ok; });
      code != exit_ok)
    return code;
  const int code = guarded([&]() -> int {
    common.plugins = given.plugins_before;
    common.plugins.insert(common.plugins.end(), given.plugins_after.begin(), given.plugins_after.end());
    for (const std::string& file : common.plugins) common.loaded.push_back(load_plugin_file(file));
    const auto asked =
        std::find_if(parts.begin(), parts.end(), [](const auto& part) { return part.first->parsed(); });
    return asked->second(common);
  });
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return unwritable_output(code);
}

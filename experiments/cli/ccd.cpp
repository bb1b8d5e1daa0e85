// The verb ccd: queries with a known truth through both continuous tests, as a table on stdout and JSON in a file.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/base/record/writer.hpp"
#include "experiments/ccd/head_on.hpp"
#include "experiments/ccd/random_queries.hpp"
#include "experiments/ccd/read_queries.hpp"
#include "experiments/ccd/score.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"

namespace bb::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr int most_queries = 10'000'000;

struct CcdVerb {
  std::string folder;      // of query files; empty: none
  int random = 0;          // queries of each kind by construction; 0: none
  int head_on = 0;         // sweeps of each gap; 0: none
  std::uint64_t seed = 1;  // of both
  std::string json;        // file; empty: none
};

/// Errors: ConfigError unless exactly one source of queries is named, and its count is in range.
void check_request(const CcdVerb& verb) {
  const int sources = int(!verb.folder.empty()) + int(verb.random != 0) + int(verb.head_on != 0);
  if (sources != 1) {
    throw ConfigError("bench data ccd", fmt::format("{} sources of queries", sources),
                      "one of FOLDER, --random N and --head-on N");
  }
  const auto check_count = [](const char* option, int n) {
    if (n < 0 || n > most_queries) {
      throw ConfigError(option, fmt::format("{}", n), fmt::format("an integer from 1 to {}", most_queries));
    }
  };
  check_count("--random", verb.random);
  check_count("--head-on", verb.head_on);
}

Json to_json(const std::vector<ccd::Score>& scores) {
  Json out = Json::array();
  for (const ccd::Score& s : scores) {
    out.push_back({{"pair", s.pair},
                   {"precision", s.precision},
                   {"method", s.method},
                   {"queries", s.queries},
                   {"positives", s.positives},
                   {"left_out", s.left_out},
                   {"false_negatives", s.false_negatives},
                   {"false_positives", s.false_positives},
                   {"capped", s.capped},
                   {"ns_a_query", s.ns_a_query}});
  }
  return out;
}

Json to_json(const std::vector<ccd::HeadOn>& rows) {
  Json out = Json::array();
  for (const ccd::HeadOn& r : rows) {
    out.push_back({{"precision", r.precision},
                   {"offset_m", r.offset},
                   {"gap_m", r.gap},
                   {"sweeps", r.sweeps},
                   {"start_wrong", r.start_wrong},
                   {"refused", r.refused},
                   {"capped", r.capped},
                   {"crossed", r.crossed}});
  }
  return out;
}

/// CCD queries with a known truth through ACCD and the audit. exit_wrong_answer when a pair that meets was proven free, or
/// an accepted state has crossed. Errors: ConfigError as read_queries, and unless one source is named.
int ccd(const CcdVerb& verb) {
  check_request(verb);
  Json out = {{"schema", "barrierbench.ccd/1"}};
  bool sound = true;
  if (verb.head_on != 0) {
    const auto rows = ccd::head_on_sweeps(verb.head_on, verb.seed);
    show("{}", ccd::head_on_table(rows));
    out["seed"] = verb.seed;
    out["head_on"] = to_json(rows);
    sound = !ccd::any_crossed(rows);
  } else {
    const bool random = verb.random != 0;
    const auto scores = ccd::score_queries(random ? ccd::random_queries(verb.random, verb.seed)
                                                  : ccd::read_queries(verb.folder));
    show("{}", ccd::score_table(scores));
    if (random) out["seed"] = verb.seed;
    out["scores"] = to_json(scores);
    sound = !ccd::any_false_negative(scores);
  }
  if (!verb.json.empty()) write_atomically(verb.json, out.dump(1) + "\n");
  return sound ? exit_ok : exit_wrong_answer;
}

}  // namespace

Action verb::ccd(CLI::App& app) {
  const auto verb = std::make_shared<CcdVerb>();
  app.add_option("folder", verb->folder,
                 "SCENE/vertex-face/*.csv and SCENE/edge-edge/*.csv, rational coordinates");
  app.add_option("--random", verb->random, "so many queries of each kind, their truth known by construction");
  app.add_option("--head-on", verb->head_on,
                 "so many sweeps of a point through a triangle for each gap and offset");
  app.add_option("--seed", verb->seed, "of both (default 1)");
  app.add_option("--json", verb->json, "file of everything that the table shows");
  return [verb](const CommonOptions&) { return cli::ccd(*verb); };
}

}  // namespace bb::cli

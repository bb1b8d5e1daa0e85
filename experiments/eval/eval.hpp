// `eval`: single queries, one JSON object a line, answered by the functions that the pipeline runs. It is how
// a user inspects a function and how other programs check this one. Kinds: registry.inc.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>

namespace bb {

/// Longest query that is read.
inline constexpr std::size_t max_query_bytes = std::size_t{16} << 20;

/// Answers every line of `in` on `out`, in order; blank lines are not queries. A line that cannot be answered, one of more than
/// max_query_bytes too, gets {"id": ..., "error": ...} and the others are still answered; `err` gets one line that counts them.
/// @return 0: all answered; 2: some were not, or `in` broke off; 75: `out` cannot be written. Errors: none.
int run_eval(std::istream& in, std::ostream& out, std::ostream& err);

/// The verb: the queries of a file, or of the standard input for "-", to the standard output.
/// Errors: ConfigError for what is no readable regular file.
int run_eval(const std::string& file);

/// The JSON Schema of all kinds (configs/schema/eval.schema.json, baked in).
void print_eval_schema(std::ostream& out);

}  // namespace bb

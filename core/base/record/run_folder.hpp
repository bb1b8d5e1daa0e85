// What runs leave in their folder, and how it goes again: only names and contents that a run wrote.
#pragma once

#include <filesystem>

namespace bb {

/// Where a file of the folder lies until its run is over: the first folder of `relative` gets ".part".
std::filesystem::path part_of(const std::filesystem::path& relative);

/// Removes files that a process was writing when it was killed, NAME.tmp.PID. Requires that the folder is locked.
void remove_temporaries(const std::filesystem::path& folder);
/// Removes what a run that was killed left unfinished: *.tmp.PID of records, its checkpoints, trace.jsonl.part, and
/// what lies in frames.part, forces.part and matrices.part. Requires that the folder is locked (folder_lock.hpp).
void remove_unfinished(const std::filesystem::path& folder);
/// What lies in those folders alone.
void remove_unfinished_artifacts(const std::filesystem::path& folder);

/// A run ends in two moves, so that a process that is killed anywhere leaves a run that is over or one that goes on:
/// its record is written as run.json.part, whole, when all its other files are; then put_in_place() gives everything
/// its name. The second move can be made again, and is made by the next process that writes to the folder.
std::filesystem::path pending_record(const std::filesystem::path& folder);
/// Puts the run of run.json.part in the place of the earlier one: its trace, frames, forces and matrices, and its record last.
/// False when there is no such file. Requires that the folder is locked. Errors: RecordError.
bool put_in_place(const std::filesystem::path& folder);

/// Removes the record of an earlier run, its trace, and every other file that it names, unless the
/// content is another by now. Files that no record names, and kept inputs, stay. Never fails.
void remove_earlier_run(const std::filesystem::path& folder);

}  // namespace bb

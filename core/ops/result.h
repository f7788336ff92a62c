// What an operation returns: one structure behind the text of a command, its JSON, MeshLab's log, and Python.
//
// Every answer has the same head, head_keys(). What an operation has besides is declared in its row (operation.h), so
// that scripts can rely on names and types.
#pragma once

#include "pcm/ops/accuracy.h"
#include "pcm/system/progress.h"
#include "pcm/system/work_done.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm::ops {

using Json = nlohmann::ordered_json;

enum class Makes : std::uint8_t {
    nothing,  // an answer
    cloud,    // another tree, `output`
    changed,  // `output` is an input that was changed in place
    file,     // `output` is not a tree
};

// A key of an answer.
struct ResultKey {
    const char* key;
    const char* type;  // "count", "number", "text", "flag", "list", "object"; "number?" may be null
    const char* unit;  // "source units", "bytes"; empty: none
    const char* help;
};
const std::vector<ResultKey>& head_keys();

struct Result {
    std::vector<std::string> input;
    std::string output;  // empty: nothing was written
    Makes makes = Makes::nothing;
    Outcome outcome;                   // its `points_out` are the head's points
    std::optional<Accuracy> accuracy;  // each operation sets it
    WorkDone work;                     // what it took
    std::vector<std::string> notes;
    std::vector<std::string> lines;  // for people, without notes, warnings and traded_text()
    Json values = Json::object();    // what the operation has besides the head
    bool good = true;                // false: what was looked at is damaged, and the command's exit code is 1

    void line(const std::string& text) { lines.push_back(text); }
    void print(const char* format, ...) __attribute__((format(printf, 2, 3)));  // adds a line
};

double points_per_second(const Outcome& outcome);
// "error 0 (exact); 310 ms, processor time 520 ms; 30,000 points, 1.20 MB read; peak memory 45.0 MB"
std::string traded_text(const Result& result);
std::vector<std::string> all_lines(const Result& result);  // for people: lines and traded_text()
const char* version();                                     // the version of the library and its programs

// The head, then the values. `command` is the operation's name.
Json json_of(const std::string& command, const Result& result);

// The errors of one operation as JSON: {"error": {"code", "text", "path", "hint"}}.
Json json_of_error(const std::exception& error);

}  // namespace pcm::ops

#include "pcm/ops/result.h"

#include "pcm/ops/argument.h"
#include "pcm/system/counted.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/text.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace pcm::ops {

void Result::print(const char* format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, arguments)) + 1, '\0');
    std::vsnprintf(text.data(), text.size(), format, again);
    va_end(again);
    va_end(arguments);
    text.pop_back();
    lines.push_back(std::move(text));
}

double points_per_second(const Outcome& outcome)
{
    return outcome.seconds > 0 ? static_cast<double>(outcome.points_out) / outcome.seconds : 0.0;
}

std::string network_text(const WorkDone& work)
{
    if (work.requests == 0) return {};
    return ", " + counted(work.requests, "request") + " to servers, " + bytes_text(work.bytes_received) + " received";
}

std::string traded_text(const Result& result)
{
    return text_of(result.accuracy.value()) + "; " + time_text(result.outcome.seconds) + ", processor time " +
           time_text(result.work.cpu_seconds) + "; " + points_text(result.work.points_read) + ", " +
           bytes_text(result.work.bytes_read) + " read" + network_text(result.work) + "; peak memory " +
           bytes_text(peak_memory_bytes());
}

std::vector<std::string> all_lines(const Result& result)
{
    std::vector<std::string> lines = result.lines;
    lines.push_back(traded_text(result));
    return lines;
}

const char* version() { return PCM_VERSION; }

const std::vector<ResultKey>& head_keys()
{
    static const std::vector<ResultKey> keys{
        {"command", "text", "", "name of the operation"},
        {"version", "text", "", "version of the program"},
        {"input", "list", "", "what was read"},
        {"output", "text?", "", "what was written; null: nothing"},
        {"points", "count", "points", "points of the result"},
        {"error", "number?", "", "how far the answer may be from the exact one, in error_unit; null: not known"},
        {"error_unit", "text", "", "source units, %, degrees, points, pixels; empty where exact"},
        {"error_kind", "text", "",
         "exact: but for rounding; bound: never more; 95 %: no more for 95 % of the values, or with a probability of "
         "95 %; estimated: about so much"},
        {"error_of", "text", "", "what is off by it; empty where exact"},
        {"seconds", "number", "s", "time that it took"},
        {"cpu_seconds", "number", "s", "time of all processors"},
        {"points_read", "count", "points", "points that were decoded, again for each time"},
        {"bytes_read", "count", "bytes", "bytes read from files, temporary ones among them"},
        {"requests", "count", "requests", "requests to servers, those that failed included"},
        {"bytes_received", "count", "bytes", "bytes received from servers"},
        {"peak_memory", "count", "bytes", "largest memory of the process since its start"},
        {"warnings", "list", "", "what failed after the result was in place"},
        {"notes", "list", "", "what one should know of the answer"},
        {"points_in", "count", "points", "points of the input"}};
    return keys;
}

namespace {

void put_traded(Json& json, const Result& result)
{
    const Accuracy& accuracy = result.accuracy.value();
    json["error"] = std::isfinite(accuracy.error) ? Json(accuracy.error) : Json();
    json["error_unit"] = accuracy.unit;
    json["error_kind"] = name_of(accuracy.kind);
    json["error_of"] = accuracy.of;
    json["seconds"] = result.outcome.seconds;
    json["cpu_seconds"] = result.work.cpu_seconds;
    json["points_read"] = result.work.points_read;
    json["bytes_read"] = result.work.bytes_read;
    json["requests"] = result.work.requests;
    json["bytes_received"] = result.work.bytes_received;
    json["peak_memory"] = peak_memory_bytes();
}

}  // namespace

Json json_of(const std::string& command, const Result& result)
{
    const Outcome& outcome = result.outcome;
    Json json;
    json["command"] = command;
    json["version"] = version();
    json["input"] = result.input;
    json["output"] = result.output.empty() ? Json() : Json(result.output);
    json["points"] = outcome.points_out;
    put_traded(json, result);
    json["warnings"] = outcome.warnings;
    json["notes"] = result.notes;
    json["points_in"] = outcome.points_in;
    for (const auto& [key, value] : result.values.items()) json[key] = value;
    return json;
}

Json json_of_error(const std::exception& error)
{
    Json what{{"code", "failed"}, {"text", error.what()}, {"path", nullptr}, {"hint", nullptr}};
    if (const auto* known = dynamic_cast<const Error*>(&error)) {
        what["code"] = name_of(known->code());
        if (!known->path().empty()) what["path"] = known->path().string();
        if (!known->hint().empty()) what["hint"] = known->hint();
    } else if (dynamic_cast<const ArgumentError*>(&error)) {
        what["code"] = "usage";
    }
    return {{"error", std::move(what)}};
}

}  // namespace pcm::ops

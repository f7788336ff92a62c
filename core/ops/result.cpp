#include "pcm/ops/result.h"

#include "pcm/ops/argument.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"

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

const char* version() { return PCM_VERSION; }

Json json_of(const std::string& command, const Result& result)
{
    const Outcome& outcome = result.outcome;
    Json json;
    json["command"] = command;
    json["version"] = version();
    json["input"] = result.input;
    json["output"] = result.output.empty() ? Json() : Json(result.output);
    json["points"] = outcome.points_out;
    json["seconds"] = outcome.seconds;
    json["warnings"] = outcome.warnings;
    json["notes"] = result.notes;
    json["points_in"] = outcome.points_in;
    json["points_per_second"] = points_per_second(outcome);
    json["peak_rss_bytes"] = peak_memory_bytes();
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

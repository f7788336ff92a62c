#include "pcm/ops/result.h"

#include "pcm/ops/argument.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"

namespace pcm::ops {

Json json_of(const std::string& command, const Result& result)
{
    const Outcome& outcome = result.outcome;
    Json json;
    json["command"] = command;
    json["version"] = PCM_VERSION;
    json["input"] = result.input;
    json["output"] = result.output.empty() ? Json() : Json(result.output);
    json["points"] = outcome.points_out;
    json["seconds"] = outcome.seconds;
    json["warnings"] = outcome.warnings;
    json["notes"] = result.notes;
    json["points_in"] = outcome.points_in;
    json["points_per_second"] = outcome.seconds > 0 ? static_cast<double>(outcome.points_out) / outcome.seconds : 0.0;
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

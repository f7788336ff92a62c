#include "pcm/ops/operation.h"

#include "pcm/point_cloud.h"
#include "pcm/system/seconds.h"

namespace pcm::ops {

std::string called(Face face, const Argument& argument)
{
    if (face == Face::dialog) return "'" + argument.label() + "'";
    if (argument.is_positional()) return argument.key();
    return argument.letter() ? std::string("-") + argument.letter() : "--" + argument.option_name();
}

std::shared_ptr<PointCloud> Context::open(const std::string& tree) const
{
    return window.open ? window.open(tree) : PointCloud::open(tree);
}

void Meter::put_into(Result& result) const
{
    result.outcome.seconds = seconds_since(start_);
    result.work = work_done() - before_;
}

Result Operation::run(const Context& context)
{
    const Meter meter;
    Result result = answer(context);
    if (!result.accuracy) throw std::logic_error("an operation does not say how exact its answer is");
    meter.put_into(result);
    return result;
}

std::string Operation::called(const Context& context, const std::string& key) const
{
    const Argument* const argument = arguments_.find(key);
    if (!argument) throw std::logic_error("no argument " + key + " is declared");
    return ops::called(context.face, *argument);
}

namespace {

Json usage_of(const std::vector<ResultKey>& keys)
{
    Json json = Json::array();
    for (const ResultKey& key : keys)
        json.push_back({{"key", key.key}, {"type", key.type}, {"unit", key.unit}, {"help", key.help}});
    return json;
}

Json usage_of(const Argument& argument)
{
    Json json{{"key", argument.key()},     {"option", argument.option_names()}, {"script", argument.script_name()},
              {"label", argument.label()}, {"help", argument.help()},           {"type", name_of(argument.kind())}};
    json["unit"] = argument.unit().empty() ? Json() : Json(argument.unit());
    json["default"] = argument.default_text().empty() ? Json() : Json(argument.default_text());
    if (!argument.dialog_default().empty()) json["default_in_dialogs"] = argument.dialog_default();
    if (!argument.without().empty()) json["without"] = argument.without();
    const AllowedNumbers& allowed = argument.allowed();
    if (allowed.least) json[allowed.above_least ? "above" : "least"] = *allowed.least;
    if (allowed.most) json["most"] = *allowed.most;
    for (const Choice& choice : argument.choices()) json["choices"].push_back(choice.name);
    if (argument.count()) {
        json["least_count"] = argument.least_count();
        json["most_count"] = argument.count();
    }
    json["required"] = argument.is_required();
    json["advanced"] = argument.is_advanced();
    json["positional"] = argument.is_positional();
    json["list"] = argument.is_list();
    json["on"] = argument.is_switched_off();
    return json;
}

}  // namespace

std::string description_of(const Row& row)
{
    return row.limits ? std::string(row.details) + "<br>" + row.limits : row.details;
}

Json usage_of(const Row& row, std::optional<Face> face)
{
    Json json{{"name", row.name}};
    json["title"] = row.title ? Json(row.title) : Json();
    json["help"] = row.help;
    json["details"] = row.details;
    json["limits"] = row.limits ? Json(row.limits) : Json();
    json["arguments"] = Json::array();
    const auto operation = row.make();
    for (const Argument& argument : operation->arguments().list())
        if (!face || (argument.is_in(*face) && argument.is_shown())) json["arguments"].push_back(usage_of(argument));
    json["head"] = usage_of(head_keys());
    json["results"] = usage_of(row.results);
    json["step"] = row.step;
    return json;
}

}  // namespace pcm::ops

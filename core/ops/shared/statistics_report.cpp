#include "pcm/ops/shared/statistics_report.h"

#include "pcm/cloud/las_class.h"
#include "pcm/io/las_summary.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>
#include <string>

namespace pcm::ops {
namespace {

Json json_of(const ValueStatistics& values)
{
    Json json = {{"values", values.values}, {"not_finite", values.not_finite}};
    if (values.values) {
        json["min"] = values.least;
        json["max"] = values.most;
        json["mean"] = values.mean;
    }
    return json;
}

Json json_of(const std::vector<std::uint64_t>& counts)
{
    Json json = Json::object();
    for (std::size_t value = 0; value < counts.size(); ++value)
        if (counts[value]) json[std::to_string(value)] = counts[value];
    return json;
}

void print_values(Result& result, const std::string& name, const ValueStatistics& values)
{
    const std::string others = values.not_finite ? "  " + grouped(values.not_finite) + " NaN or infinite" : "";
    if (values.values)
        result.print("  %-28s %24s %24s %24s%s", name.c_str(), exact(values.least).c_str(), exact(values.most).c_str(),
                     exact(values.mean).c_str(), others.c_str());
    else
        result.print("  %-28s%s", name.c_str(), others.c_str());
}

void print_counts(Result& result, const char* name, const std::vector<std::uint64_t>& counts)
{
    if (counts.empty()) return;
    result.print("%s", name);
    for (std::size_t value = 0; value < counts.size(); ++value)
        if (counts[value]) result.print("  %3zu %18s", value, grouped(counts[value]).c_str());
}

void print_duplicates(Result& result, const DuplicateStatistics& duplicates)
{
    const auto points = static_cast<std::uint64_t>(std::llround(duplicates.points));
    if (duplicates.exact)
        result.print("duplicates  %s points at the position of another", grouped(points).c_str());
    else
        result.print(
            "duplicates  about %s points at the position of another, standard error %s (an estimate from one in "
            "%s positions)",
            grouped(points).c_str(), brief(duplicates.standard_error).c_str(), grouped(duplicates.one_in).c_str());
}

}  // namespace

CloudStatistics collect_statistics(PointReader& cloud, const ProgressFunction& progress)
{
    StatisticsCollector collector(cloud.info().schema, cloud.info().grid);
    PointBatch batch;
    while (cloud.read(batch, default_batch_points)) {
        collector.add(batch);
        ProgressUpdate update;
        update.stage = "Reading points";
        update.fraction = cloud.fraction_read();
        if (progress && !progress(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }
    return collector.result();
}

Json json_of_statistics(const CloudStatistics& statistics, const Schema& schema)
{
    Json json;
    json["points"] = statistics.points;
    json["not_finite"] = statistics.not_finite;
    for (std::size_t a = 0; a < 3; ++a) json["position"][std::string(1, "xyz"[a])] = json_of(statistics.position[a]);
    json["attributes"] = Json::object();
    for (std::size_t k = 0; k < schema.size(); ++k) {
        Json components = Json::array();
        for (const ValueStatistics& values : statistics.attributes[k]) components.push_back(json_of(values));
        json["attributes"][schema[k].name] = components;
    }
    if (!statistics.classes.empty()) {
        json["classes"] = Json::array();
        for (unsigned code = 0; code < statistics.classes.size(); ++code)
            if (statistics.classes[code])
                json["classes"].push_back(
                    {{"class", code}, {"name", las_class_name(code)}, {"points", statistics.classes[code]}});
        json["other_classes"] = statistics.other_classes;
    }
    if (!statistics.return_numbers.empty()) json["return_numbers"] = json_of(statistics.return_numbers);
    if (!statistics.numbers_of_returns.empty()) json["numbers_of_returns"] = json_of(statistics.numbers_of_returns);
    const DuplicateStatistics& duplicates = statistics.duplicates;
    json["duplicates"] = {{"points", duplicates.points},
                          {"exact", duplicates.exact},
                          {"one_in", duplicates.one_in},
                          {"standard_error", duplicates.standard_error}};
    return json;
}

void print_statistics(Result& result, const CloudStatistics& statistics, const Schema& schema)
{
    result.print("statistics  %s points", grouped(statistics.points).c_str());
    result.print("  %-28s %24s %24s %24s", "", "min", "max", "mean");
    for (std::size_t a = 0; a < 3; ++a) print_values(result, std::string(1, "xyz"[a]), statistics.position[a]);
    for (std::size_t k = 0; k < schema.size(); ++k)
        for (std::size_t c = 0; c < statistics.attributes[k].size(); ++c)
            print_values(result,
                         schema[k].components == 1 ? schema[k].name : schema[k].name + "[" + std::to_string(c) + "]",
                         statistics.attributes[k][c]);
    if (!statistics.classes.empty()) result.print("classes");
    for (unsigned code = 0; code < statistics.classes.size(); ++code)
        if (statistics.classes[code])
            result.print("  %3u %18s  %s", code, grouped(statistics.classes[code]).c_str(),
                         las_class_name(code).c_str());
    if (statistics.other_classes) result.print("      %18s  above 255", grouped(statistics.other_classes).c_str());
    print_counts(result, "return numbers", statistics.return_numbers);
    print_counts(result, "numbers of returns", statistics.numbers_of_returns);
    print_duplicates(result, statistics.duplicates);
}

}  // namespace pcm::ops

#include "pcm/cli/statistics.h"

#include "pcm/cloud/las_class.h"
#include "pcm/io/las_summary.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"

#include <cmath>
#include <cstdio>
#include <string>

namespace pcm::cli {
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

void print_values(const std::string& name, const ValueStatistics& values)
{
    std::printf("  %-28s", name.c_str());
    if (values.values)
        std::printf(" %24s %24s %24s", exact(values.least).c_str(), exact(values.most).c_str(),
                    exact(values.mean).c_str());
    if (values.not_finite) std::printf("  %s NaN or infinite", grouped(values.not_finite).c_str());
    std::printf("\n");
}

void print_counts(const char* name, const std::vector<std::uint64_t>& counts)
{
    if (counts.empty()) return;
    std::printf("%s\n", name);
    for (std::size_t value = 0; value < counts.size(); ++value)
        if (counts[value]) std::printf("  %3zu %18s\n", value, grouped(counts[value]).c_str());
}

void print_duplicates(const DuplicateStatistics& duplicates)
{
    const auto points = static_cast<std::uint64_t>(std::llround(duplicates.points));
    if (duplicates.exact)
        std::printf("duplicates  %s points at the position of another\n", grouped(points).c_str());
    else
        std::printf(
            "duplicates  about %s points at the position of another, standard error %s (an estimate from one in "
            "%s positions)\n",
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
        if (!progress(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
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
    json["peak_rss_bytes"] = peak_memory_bytes();
    return json;
}

void print_statistics(const CloudStatistics& statistics, const Schema& schema)
{
    std::printf("statistics  %s points\n", grouped(statistics.points).c_str());
    std::printf("  %-28s %24s %24s %24s\n", "", "min", "max", "mean");
    for (std::size_t a = 0; a < 3; ++a) print_values(std::string(1, "xyz"[a]), statistics.position[a]);
    for (std::size_t k = 0; k < schema.size(); ++k)
        for (std::size_t c = 0; c < statistics.attributes[k].size(); ++c)
            print_values(schema[k].components == 1 ? schema[k].name : schema[k].name + "[" + std::to_string(c) + "]",
                         statistics.attributes[k][c]);
    if (!statistics.classes.empty()) std::printf("classes\n");
    for (unsigned code = 0; code < statistics.classes.size(); ++code)
        if (statistics.classes[code])
            std::printf("  %3u %18s  %s\n", code, grouped(statistics.classes[code]).c_str(),
                        las_class_name(code).c_str());
    if (statistics.other_classes) std::printf("      %18s  above 255\n", grouped(statistics.other_classes).c_str());
    print_counts("return numbers", statistics.return_numbers);
    print_counts("numbers of returns", statistics.numbers_of_returns);
    print_duplicates(statistics.duplicates);
}

}  // namespace pcm::cli

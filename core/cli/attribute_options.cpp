#include "pcm/cli/attribute_options.h"

#include "pcm/filter/backends.h"
#include "pcm/system/peak_memory.h"

#include <cstdio>

namespace pcm::cli {

void NeighbourOptions::add_to(Options& options)
{
    options
        .option("-k,--neighbours", neighbours,
                "Number of nearest neighbours (default " + std::to_string(neighbours) + ")")
        .between(1, 1024);
    options.option("--max-distance", max_distance, "Farthest neighbour, source units (default: none)").positive();
    const char* const group = "Precision (default: exact)";
    options.option("--level", level, "Compute the points up to this level; the others take their nearest one's values")
        .group(group);
    options
        .option("--time-limit", time_limit,
                "Choose the finest level that is predicted to take no longer than so many seconds; where it takes "
                "longer, the rest is computed at coarser levels")
        .positive()
        .group(group);
    options
        .option("--error-target", error_target,
                "Choose the coarsest level at which 95 % of the points are predicted to have no larger error, in "
                "percent (for normals 1 is an angle of 0.01)")
        .not_negative()
        .group(group);
    options.option("-m,--memory", memory, "Memory limit, e.g. 96M (the least) or 2G (default 512M)").bytes();
    options.option("-t,--threads", threads, "Threads (default: one per processor)");
    options.flag("--flann", flann, "Search with the FLANN library, for comparison").shown_if(offers_flann());
}

void keep_memory_limit(std::uint64_t bytes, std::uint64_t least)
{
    if (bytes < least)
        throw Error(ErrorCode::invalid_argument, {},
                    "the memory limit is " + bytes_text(bytes) + ": neighbours of a part of a cloud take " +
                        bytes_text(least) + " at least",
                    "give -m " + std::to_string(least >> 20) + "M or more");
    return_large_blocks();
}

void note_memory(FilterReport& report, std::uint64_t limit)
{
    if (report.peak_memory_bytes > limit)
        report.notes.push_back("the memory limit of " + bytes_text(limit) +
                               " was exceeded: " + bytes_text(report.peak_memory_bytes) + " were taken");
}

void NeighbourOptions::put_into(NeighbourAttributeOptions& options) const
{
    keep_memory_limit(memory, least_attribute_memory);
    options.neighbours = neighbours;
    if (max_distance) options.max_distance = *max_distance;
    options.level = level;
    options.time_limit = time_limit;
    options.error_target_percent = error_target;
    options.memory_bytes = memory;
    options.threads = threads;
    options.backend = flann ? NeighbourBackend::flann : NeighbourBackend::own;
}

void put_report(Json& json, const FilterReport& report)
{
    put_outcome(json, report.outcome);
    json["points_in"] = report.outcome.points_in;
    json["level"] = report.level ? Json(*report.level) : Json();
    json["points_checked"] = report.points_checked;
    Json errors = Json::array();
    for (const SampledError& error : report.errors)
        errors.push_back({{"of", error.what},
                          {"unit", error.unit},
                          {"median", error.median},
                          {"p95", error.p95},
                          {"p95_interval", Json::array({error.p95_low, error.p95_high})}});
    json["errors"] = std::move(errors);
    json["notes"] = report.notes;
}

void put_attribute_report(Json& json, const WantedValues& wanted, const NeighbourAttributeReport& report)
{
    put_report(json, report);
    json["points_computed"] = report.points_computed;
    if (wanted.radius) json["radii_limited"] = report.limited;
    json["used_known_normals"] = report.used_known_normals;
    if (wanted.needs_shape())
        json["confidence"] = {{"line", report.lines},
                              {"blob", report.blobs},
                              {"too_few", report.too_few},
                              {"two_surfaces", report.two_surfaces}};
    if (wanted.normal) json["flipped"] = report.flipped;
}

void print_attribute_report(const std::filesystem::path& tree, const WantedValues& wanted,
                            const NeighbourAttributeReport& report)
{
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%s: %s\n", tree.c_str(), outcome_text(noun_of(wanted), report).c_str());
    std::printf("%s points, %s computed, peak memory %s\n", grouped(report.outcome.points_out).c_str(),
                grouped(report.points_computed).c_str(), bytes_text(report.peak_memory_bytes).c_str());
    if (wanted.needs_shape())
        std::printf("neighbours on a line: %s points; in a blob: %s; too few: %s; on two surfaces: %s\n",
                    grouped(report.lines).c_str(), grouped(report.blobs).c_str(), grouped(report.too_few).c_str(),
                    grouped(report.two_surfaces).c_str());
    if (report.limited)
        std::printf("%s points stand alone: their radii are those of their surroundings\n",
                    grouped(report.limited).c_str());
    if (report.used_known_normals) std::printf("radii were measured across the normals that the tree has\n");
}

int run_attribute_filter(const Common& common, const std::string& tree, const TargetOptions& choice,
                         NeighbourAttributeOptions options)
{
    options.progress = console_progress(common);
    options.overwrite = choice.overwrite;
    UpdateTarget target(tree, choice.get());
    NeighbourAttributeReport report = target.update(
        [&](const std::filesystem::path& folder) { return compute_neighbour_attributes(folder, options); });
    note_memory(report, options.memory_bytes);
    end_progress(common);
    if (common.json) {
        Json json;
        json["tree"] = target.path().string();
        put_attribute_report(json, options.wanted, report);
        print_json(json);
    } else {
        print_attribute_report(target.path(), options.wanted, report);
    }
    return finished(report.outcome);
}

}  // namespace pcm::cli

#include "pcm/cli/common.h"
#include "pcm/cli/origin_of_cloud.h"
#include "pcm/cli/reading.h"
#include "pcm/cli/statistics.h"
#include "pcm/cloud/vector.h"
#include "pcm/convert/convert.h"
#include "pcm/io/metadata_text.h"
#include "pcm/io/pipe/merged_reader.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/tree/tree.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    ReadingOptions reading;
    std::vector<std::string> inputs;
    unsigned threads = 0;
    bool scan = false, statistics = false;
};

Json attributes_of(const Schema& schema)
{
    Json attributes = Json::array();
    for (const Attribute& attribute : schema)
        attributes.push_back({{"name", attribute.name},
                              {"type", name_of(attribute.type)},
                              {"components", attribute.components},
                              {"scale", attribute.scale},
                              {"offset", attribute.offset}});
    return attributes;
}

Json box_of(const Box3d& box)
{
    if (box.empty()) return nullptr;
    return {{"min", box.min}, {"max", box.max}};
}

Json metadata_of(const std::vector<Metadata>& metadata)
{
    Json blocks = Json::array();
    for (const Metadata& block : metadata) {
        blocks.push_back({{"key", block.key}, {"bytes", block.value.size()}});
        if (const std::string text = text_of(block); !text.empty()) blocks.back()["text"] = text;
    }
    return blocks;
}

void print_vec(const char* name, const Vec3d& v)
{
    std::printf("%-11s %s  %s  %s\n", name, exact(v[0]).c_str(), exact(v[1]).c_str(), exact(v[2]).c_str());
}

void print_attributes(const Schema& schema)
{
    std::printf("attributes ");
    for (const Attribute& attribute : schema) {
        std::printf(" %s:%s", attribute.name.c_str(), std::string(name_of(attribute.type)).c_str());
        if (attribute.components > 1) std::printf("x%u", attribute.components);
        if (attribute.scale != 1) std::printf("*%s", exact(attribute.scale).c_str());
        if (attribute.offset != 0) std::printf("%+.17g", attribute.offset);
    }
    std::printf("%s\n", schema.empty() ? " none" : "");
}

void print_metadata(const std::vector<Metadata>& metadata)
{
    constexpr std::size_t shown = 300;  // characters of a text; --json prints all of it
    for (const Metadata& block : metadata) {
        std::string text = text_of(block);
        if (text.size() > shown) text = text.substr(0, shown) + "...";
        std::printf("metadata    %s, %s%s%s\n", block.key.c_str(), bytes_text(block.value.size()).c_str(),
                    text.empty() ? "" : ": ", text.c_str());
    }
}

Json to_json(const Tree& tree, const std::optional<CloudStatistics>& statistics)
{
    const TreeInfo& info = tree.info();
    Json json;
    json["tree"] = tree.folder().string();
    json["points"] = info.points;
    json["points_skipped"] = info.points_skipped;
    json["bounds"] = box_of(info.points ? info.bounds() : Box3d());
    json["scale"] = info.grid.scale;
    json["origin"] = info.grid.offset;
    json["sampling"] = info.sampling == Sampling::grid ? "grid" : "poisson";
    json["position_type"] = name_of(info.position_type);
    json["position_error"] = info.position_error;
    json["attributes"] = attributes_of(info.schema);
    json["generation"] = info.generation;
    json["parts"] = tree.part_roots().size();
    json["coverage_kept"] = info.coverage_kept;
    json["levels"] = info.levels;
    json["level"] = Json::array();
    for (const LevelSummary& level : tree.level_summaries())
        json["level"].push_back({{"nodes", level.nodes},
                                 {"points", level.points},
                                 {"points_to_here", level.points_to_here},
                                 {"spacing", level.spacing}});
    json["nodes"] = tree.nodes().size();
    json["bytes"] = info.bytes;
    put_origin(json, info.metadata);
    json["metadata"] = metadata_of(info.metadata);
    json["sources"] = info.sources;
    if (statistics) json["statistics"] = json_of_statistics(*statistics, info.schema);
    return json;
}

void print(const Tree& tree, const std::optional<CloudStatistics>& statistics)
{
    const TreeInfo& info = tree.info();
    const Box3d bounds = info.bounds();
    const std::vector<LevelSummary> levels = tree.level_summaries();
    std::printf("%s\n", tree.folder().string().c_str());
    std::printf("points      %s\n", grouped(info.points).c_str());
    if (info.points_skipped)
        std::printf("skipped     %s without a finite position or beyond a given limit\n",
                    grouped(info.points_skipped).c_str());
    if (info.points) {
        print_vec("min", bounds.min);
        print_vec("max", bounds.max);
    }
    print_vec("scale", info.grid.scale);
    print_vec("origin", info.grid.offset);
    std::printf("positions   %s, largest error %s\n", std::string(name_of(info.position_type)).c_str(),
                exact(info.position_error).c_str());
    print_attributes(info.schema);
    print_origin(info.metadata);
    print_metadata(info.metadata);
    std::printf("size        %s, %.2f bytes per point\n", bytes_text(info.bytes).c_str(),
                info.points ? static_cast<double>(info.bytes) / static_cast<double>(info.points) : 0.0);
    if (info.generation > 1)
        std::printf("updates     %u since the build; %zu %s\n", info.generation - 1, tree.part_roots().size(),
                    tree.part_roots().size() == 1 ? "part" : "parts");
    if (!info.coverage_kept)
        std::printf("levels      have gaps where points were deleted; 'pcmlab compact' closes them\n");
    if (info.sampling == Sampling::grid) std::printf("levels      sampled on a grid (a fast build)\n");
    std::printf("level  nodes          points  points to here  spacing\n");
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const LevelSummary& level = levels[i];
        std::printf("%5zu %6llu %15s %15s  ", i, static_cast<unsigned long long>(level.nodes),
                    grouped(level.points).c_str(), grouped(level.points_to_here).c_str());
        std::printf("%s\n", level.spacing > 0 ? brief(level.spacing).c_str() : "full");
    }
    if (statistics) print_statistics(*statistics, info.schema);
}

// Found by reading all points, not from headers.
struct Scan {
    std::uint64_t points = 0, not_finite = 0;
    Box3d box;
    std::optional<CloudStatistics> statistics;  // if asked for
};

Scan scan(PointReader& cloud, const ProgressFunction& progress)
{
    Scan found;
    PointBatch batch;
    while (cloud.read(batch, default_batch_points)) {
        found.points += batch.size;
        for (std::size_t i = 0; i < batch.size; ++i) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = batch.gridded ? cloud.info().grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
            if (is_finite(p))
                found.box.extend(p);
            else
                ++found.not_finite;
        }
        ProgressUpdate update;
        update.stage = "Reading points";
        update.fraction = cloud.fraction_read();
        if (!progress(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }
    return found;
}

Scan scan_with_statistics(PointReader& cloud, const ProgressFunction& progress)
{
    Scan found;
    found.statistics = collect_statistics(cloud, progress);
    found.points = found.statistics->points;
    found.not_finite = found.statistics->not_finite;
    found.box = found.statistics->box;
    return found;
}

Json to_json(const MergedReader& cloud, const std::optional<Scan>& scanned)
{
    const FileInfo& info = cloud.info();
    Json json;
    json["files"] = Json::array();
    for (const MergedReader::Source& source : cloud.sources()) json["files"].push_back(source.path.string());
    json["format"] = info.format;
    json["points"] = info.points;
    json["points_known"] = info.points_known;
    json["promised_bounds"] = box_of(info.promised_box.value_or(Box3d()));
    if (scanned) {
        json["scanned"] = {
            {"points", scanned->points}, {"not_finite", scanned->not_finite}, {"bounds", box_of(scanned->box)}};
        json["peak_rss_bytes"] = peak_memory_bytes();
        if (scanned->statistics) json["statistics"] = json_of_statistics(*scanned->statistics, info.schema);
    }
    put_skipped(json, info.skipped);
    json["position_type"] = name_of(info.position_type);
    if (info.grid) {
        json["scale"] = info.grid->scale;
        json["offset"] = info.grid->offset;
    }
    json["attributes"] = attributes_of(info.schema);
    put_origin(json, info.metadata);
    json["metadata"] = metadata_of(info.metadata);
    json["notes"] = info.notes;
    return json;
}

void print(const MergedReader& cloud, const std::optional<Scan>& scanned)
{
    const FileInfo& info = cloud.info();
    if (cloud.sources().size() == 1)
        std::printf("%s\n", cloud.sources()[0].path.string().c_str());
    else
        std::printf("%s files, the first %s\n", grouped(cloud.sources().size()).c_str(),
                    cloud.sources()[0].path.string().c_str());
    std::printf("format      %s\n", info.format.c_str());
    if (scanned)
        std::printf("points      %s\n", grouped(scanned->points).c_str());
    else
        std::printf("points      %s%s\n", info.points_known ? "" : "about ", grouped(info.points).c_str());
    if (scanned && scanned->not_finite)
        std::printf("            %s without a finite position\n", grouped(scanned->not_finite).c_str());
    if (scanned && !scanned->box.empty()) {
        print_vec("min", scanned->box.min);
        print_vec("max", scanned->box.max);
    }
    if (info.promised_box && !(scanned && scanned->box == *info.promised_box)) {
        print_vec(scanned ? "header min" : "min", info.promised_box->min);
        print_vec(scanned ? "header max" : "max", info.promised_box->max);
    }
    if (info.grid) {
        print_vec("scale", info.grid->scale);
        print_vec("offset", info.grid->offset);
    }
    std::printf("positions   %s\n", info.grid ? "i32 on a grid" : std::string(name_of(info.position_type)).c_str());
    print_attributes(info.schema);
    print_origin(info.metadata);
    print_metadata(info.metadata);
    if (scanned && scanned->statistics) print_statistics(*scanned->statistics, info.schema);
    for (const std::string& note : info.notes) std::printf("note        %s\n", note.c_str());
}

// The tree among the inputs, which must then be the only one.
std::shared_ptr<const Tree> tree_of(const std::vector<std::string>& inputs)
{
    for (const std::string& input : inputs) {
        if (!is_tree(input) && !is_tree_folder(tree_folder_of(input)) &&
            std::filesystem::path(input).extension() != std::string(".") + tree_extension)
            continue;
        if (inputs.size() > 1) throw Error(ErrorCode::invalid_argument, input, "a tree must be the only input");
        return Tree::open(input);
    }
    return nullptr;
}

template <class... Cloud>
void show(const Common& common, const Cloud&... cloud)
{
    if (common.json)
        print_json(to_json(cloud...));
    else
        print(cloud...);
}

int info(const Arguments& arguments)
{
    const ProgressFunction progress = console_progress(arguments.common);
    if (const auto tree = tree_of(arguments.inputs)) {
        std::optional<CloudStatistics> statistics;
        if (arguments.statistics) {
            CloudOptions options;
            options.read.threads = arguments.threads;
            statistics = collect_statistics(*open_cloud({tree->folder()}, options), progress);
            end_progress(arguments.common);
        }
        show(arguments.common, *tree, statistics);
        return 0;
    }
    ReadOptions reading = arguments.reading.get(arguments.threads);
    reading.ignore_crs = true;  // the notes say where systems differ
    MergedReader cloud({arguments.inputs.begin(), arguments.inputs.end()}, reading);
    std::optional<Scan> scanned;
    if (arguments.statistics)
        scanned = scan_with_statistics(cloud, progress);
    else if (arguments.scan)
        scanned = scan(cloud, progress);
    end_progress(arguments.common);
    show(arguments.common, cloud, scanned);
    return 0;
}

}  // namespace

Run add_info(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options
        .positional(
            "input", arguments->inputs,
            "A tree folder, or any file of it; or files, and folders with their sub-folders, merged into one cloud")
        .required();
    options.flag("--scan", arguments->scan, "Files: read all points, for the exact count and box");
    options.flag("--statistics", arguments->statistics,
                 "Read all points: range and mean of every attribute, points by class and return, duplicates");
    options.option("-t,--threads", arguments->threads, "Reading threads (default: one per processor)");
    arguments->reading.add_to(options);
    add_common(options, arguments->common);
    return [arguments] { return info(*arguments); };
}

}  // namespace pcm::cli

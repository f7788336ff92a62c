// What a tree, or files of any supported format, contain.
#include "pcm/cloud/vector.h"
#include "pcm/convert/convert.h"
#include "pcm/io/metadata_text.h"
#include "pcm/io/pipe/merged_reader.h"
#include "pcm/ops/shared/origin_report.h"
#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/shared/statistics_report.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/system/scaled_decimal.h"
#include "pcm/system/text.h"
#include "pcm/tree/tree.h"

namespace pcm::ops {
namespace {

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

void print_vec(Result& result, const char* name, const Vec3d& v)
{
    result.print("%-11s %s  %s  %s", name, exact(v[0]).c_str(), exact(v[1]).c_str(), exact(v[2]).c_str());
}

void print_on_grid(Result& result, const char* name, const Grid& grid, const Vec3i& q)
{
    const auto text = [&](std::size_t axis) { return decimal_text(q[axis], grid.scale[axis], grid.offset[axis]); };
    result.print("%-11s %s  %s  %s", name, text(0).c_str(), text(1).c_str(), text(2).c_str());
}

void print_attributes(Result& result, const Schema& schema)
{
    std::string text = "attributes ";
    for (const Attribute& attribute : schema) {
        text += " " + attribute.name + ":" + std::string(name_of(attribute.type));
        if (attribute.components > 1) text += "x" + std::to_string(attribute.components);
        if (attribute.scale != 1) text += "*" + exact(attribute.scale);
        if (attribute.offset != 0) text += (attribute.offset > 0 ? "+" : "") + exact(attribute.offset);
    }
    result.line(text + (schema.empty() ? " none" : ""));
}

void print_sources(Result& result, const std::vector<std::string>& sources)
{
    constexpr std::size_t shown = 10;  // names; the values have all
    for (std::size_t i = 0; i < sources.size() && i < shown; ++i) result.line("source      " + sources[i]);
    if (sources.size() > shown) result.line("            and " + grouped(sources.size() - shown) + " more");
}

void print_metadata(Result& result, const std::vector<Metadata>& metadata)
{
    constexpr std::size_t shown = 300;  // characters of a text; --json prints all of it
    for (const Metadata& block : metadata) {
        std::string text = text_of(block);
        if (text.size() > shown) text = text.substr(0, shown) + "...";
        result.print("metadata    %s, %s%s%s", block.key.c_str(), bytes_text(block.value.size()).c_str(),
                     text.empty() ? "" : ": ", text.c_str());
    }
}

void put_tree(Result& result, const Tree& tree, const std::optional<CloudStatistics>& statistics)
{
    const TreeInfo& info = tree.info();
    Json& json = result.values;
    result.input = {tree.folder().string()};
    result.accuracy = exact_answer();
    result.outcome.points_out = info.points;
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
    put_skipped(result, {});
    put_origin(json, info.metadata);
    json["metadata"] = metadata_of(info.metadata);
    json["sources"] = info.sources;
    json["statistics"] = statistics ? json_of_statistics(*statistics, info.schema) : Json();
}

void print_tree(Result& result, const Tree& tree, const std::optional<CloudStatistics>& statistics)
{
    const TreeInfo& info = tree.info();
    const std::vector<LevelSummary> levels = tree.level_summaries();
    result.print("%s", tree.folder().string().c_str());
    print_sources(result, info.sources);
    result.print("points      %s", grouped(info.points).c_str());
    if (info.points_skipped)
        result.print("skipped     %s without a finite position or beyond a given limit",
                     grouped(info.points_skipped).c_str());
    if (info.points) {
        print_on_grid(result, "min", info.grid, info.box.min);
        print_on_grid(result, "max", info.grid, info.box.max);
    }
    print_vec(result, "scale", info.grid.scale);
    print_vec(result, "origin", info.grid.offset);
    result.print("positions   %s, largest error %s", std::string(name_of(info.position_type)).c_str(),
                 exact(info.position_error).c_str());
    print_attributes(result, info.schema);
    print_origin(result, info.metadata);
    print_metadata(result, info.metadata);
    result.print("size        %s, %.2f bytes per point", bytes_text(info.bytes).c_str(),
                 info.points ? static_cast<double>(info.bytes) / static_cast<double>(info.points) : 0.0);
    if (info.generation > 1)
        result.print("updates     %u since the build; %zu %s", info.generation - 1, tree.part_roots().size(),
                     tree.part_roots().size() == 1 ? "part" : "parts");
    if (!info.coverage_kept)
        result.print("levels      have gaps where points were deleted; 'pcmlab compact' closes them");
    result.line(info.sampling == Sampling::grid ? "levels      sampled on a grid (a fast build)"
                                                : "levels      Poisson disks");
    result.print("level       nodes           points   points to here  spacing");
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const LevelSummary& level = levels[i];
        result.print("%5zu %11s %16s %16s  %s", i, grouped(level.nodes).c_str(), grouped(level.points).c_str(),
                     grouped(level.points_to_here).c_str(), level.spacing > 0 ? brief(level.spacing).c_str() : "full");
    }
    if (statistics) print_statistics(result, *statistics, info.schema);
}

// Found by reading all points, not from headers.
struct Scan {
    std::uint64_t points = 0, not_finite = 0;
    Box3d box;
    std::optional<CloudStatistics> statistics;  // if requested
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
        if (progress && !progress(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
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

void put_files(Result& result, const MergedReader& cloud, const std::optional<Scan>& scanned)
{
    const FileInfo& info = cloud.info();
    Json& json = result.values;
    result.outcome.points_out = info.points;
    result.accuracy = exact_answer();
    if (!info.points_known && !scanned)  // guessed from the size of the file
        result.accuracy = {ErrorKind::estimated, std::numeric_limits<double>::infinity(), "points",
                           "the number of points"};
    result.notes = info.notes;
    json["files"] = Json::array();
    for (const MergedReader::Source& source : cloud.sources()) json["files"].push_back(source.path.string());
    json["format"] = info.format;
    json["points_known"] = info.points_known;
    json["promised_bounds"] = box_of(info.promised_box.value_or(Box3d()));
    if (scanned) {
        json["scanned"] = {
            {"points", scanned->points}, {"not_finite", scanned->not_finite}, {"bounds", box_of(scanned->box)}};
        if (scanned->statistics) json["statistics"] = json_of_statistics(*scanned->statistics, info.schema);
    }
    put_skipped(result, info.skipped);
    json["position_type"] = name_of(info.position_type);
    if (info.grid) {
        json["scale"] = info.grid->scale;
        json["offset"] = info.grid->offset;
    }
    json["attributes"] = attributes_of(info.schema);
    put_origin(json, info.metadata);
    json["metadata"] = metadata_of(info.metadata);
}

void print_files(Result& result, const MergedReader& cloud, const std::optional<Scan>& scanned)
{
    const FileInfo& info = cloud.info();
    if (cloud.sources().size() == 1)
        result.print("%s", cloud.sources()[0].path.string().c_str());
    else
        result.print("%s files, the first %s", grouped(cloud.sources().size()).c_str(),
                     cloud.sources()[0].path.string().c_str());
    result.print("format      %s", info.format.c_str());
    if (scanned)
        result.print("points      %s", grouped(scanned->points).c_str());
    else
        result.print("points      %s%s", info.points_known ? "" : "about ", grouped(info.points).c_str());
    if (scanned && scanned->not_finite)
        result.print("            %s without a finite position", grouped(scanned->not_finite).c_str());
    if (scanned && !scanned->box.empty()) {
        print_vec(result, "min", scanned->box.min);
        print_vec(result, "max", scanned->box.max);
    }
    if (info.promised_box && !(scanned && scanned->box == *info.promised_box)) {
        print_vec(result, scanned ? "header min" : "min", info.promised_box->min);
        print_vec(result, scanned ? "header max" : "max", info.promised_box->max);
    }
    if (info.grid) {
        print_vec(result, "scale", info.grid->scale);
        print_vec(result, "offset", info.grid->offset);
    }
    result.print("positions   %s", info.grid ? "i32 on a grid" : std::string(name_of(info.position_type)).c_str());
    print_attributes(result, info.schema);
    print_origin(result, info.metadata);
    print_metadata(result, info.metadata);
    if (scanned && scanned->statistics) print_statistics(result, *scanned->statistics, info.schema);
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

class Info : public Operation {
public:
    Info()
    {
        arguments_.add("input", inputs_)
            .as(ValueKind::cloud)
            .positional()
            .required()
            .script("Tree")
            .label("Tree folder")
            .help(
                "A tree folder, or any file of it; or files, and folders with their sub-folders, merged into one "
                "cloud");
        arguments_.add("scan", scan_)
            .only(Face::command)  // a tree, which is what dialogs take, knows its points
            .label("Scan")
            .help("Files: read all points, for the exact count and box");
        arguments_.add("statistics", statistics_)
            .label("Statistics")
            .help("Read all points: range and mean of every attribute, points by class and return, duplicates");
        work_.declare_threads(arguments_);
        reading_.declare(arguments_, Face::command);
    }

    Result answer(const Context& context) override
    {
        Result result;
        for (const ResultKey& key : keys) result.values[key.key] = nullptr;
        if (const auto tree = tree_of(inputs_)) {
            std::optional<CloudStatistics> statistics;
            if (statistics_) {
                CloudOptions options;
                options.read.threads = work_.threads;
                statistics = collect_statistics(*open_cloud({tree->folder()}, options), context.progress);
            }
            put_tree(result, *tree, statistics);
            print_tree(result, *tree, statistics);
            return result;
        }
        ReadOptions reading = reading_.get(work_.threads);
        reading.ignore_crs = true;  // the notes say where systems differ
        MergedReader cloud({inputs_.begin(), inputs_.end()}, reading);
        std::optional<Scan> scanned;
        if (statistics_)
            scanned = scan_with_statistics(cloud, context.progress);
        else if (scan_)
            scanned = scan(cloud, context.progress);
        result.input = inputs_;
        put_files(result, cloud, scanned);
        print_files(result, cloud, scanned);
        return result;
    }

    // A key that applies to the other of trees and files is null.
    static const std::vector<ResultKey> keys;

private:
    std::vector<std::string> inputs_;
    bool scan_ = false, statistics_ = false;
    WorkArguments work_;
    ReadingArguments reading_;
};

const std::vector<ResultKey> Info::keys = with_skipped_keys(
    {{"files", "list?", "", "files: the files that are read"},
     {"format", "text?", "", "files: their format"},
     {"points_known", "flag?", "", "files: false: the number of points is an estimate"},
     {"promised_bounds", "object?", "source units", "files: min and max by the headers"},
     {"scanned", "object?", "", "files: points, not_finite and bounds of all points; null: they were not read"},
     {"points_skipped", "count?", "points", "trees: points that the build left out"},
     {"bounds", "object?", "source units", "trees: min and max; null: there is no point"},
     {"scale", "list?", "source units", "steps of the positions"},
     {"origin", "list?", "source units", "trees: offset of the grid"},
     {"offset", "list?", "source units", "files: offset of the grid"},
     {"sampling", "text?", "", "trees: poisson or grid"},
     {"position_type", "text", "", "type of the positions in the sources"},
     {"position_error", "number?", "source units", "trees: largest position error"},
     {"attributes", "list", "", "name, type, components, scale, offset"},
     {"generation", "count?", "", "trees: 1, and 1 more for each update"},
     {"parts", "count?", "", "trees: 1, and 1 more for each time that points were appended"},
     {"coverage_kept", "flag?", "", "trees: false: coarse levels have gaps"},
     {"levels", "count?", "", "trees: levels of detail"},
     {"level", "list?", "", "trees: nodes, points, points_to_here, spacing of each level"},
     {"nodes", "count?", "", "trees: chunks"},
     {"bytes", "count?", "bytes", "trees: size"},
     {"crs", "object?", "", "coordinate system; null: none is stated"},
     {"gps_time", "object?", "", "kind of GPS times; null: none is stated"},
     {"las", "object?", "", "header of the one LAS file that the cloud is from"},
     {"metadata", "list", "", "key, bytes and text of each block"},
     {"sources", "list?", "", "trees: names of the files that they were built from"},
     {"statistics", "object?", "", "statistics of all points; null: they were not read"}});

}  // namespace

Row info_row()
{
    return {"info",
            "Point Cloud Tree Information",
            "Show what a tree, or files of any supported format, contain",
            "Writes the properties of a point cloud tree to the log: number of points, bounds in source coordinates, "
            "attributes, levels of detail with their spacing, size on disk, and the largest position error.",
            menu::measure,
            nullptr,
            Info::keys,
            make<Info>,
            {},
            always_exact};
}

}  // namespace pcm::ops

// Files and trees become a file of another format, or a tree.
#include "pcm/convert/convert.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/builder.h"
#include "pcm/cluster/filter/team_convert.h"
#include "pcm/ops/shared/bucket_output.h"
#include "pcm/ops/shared/level_arguments.h"
#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/query/nearest.h"
#include "pcm/system/error.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/seconds.h"
#include "pcm/system/text.h"
#include "pcm/system/tree_folder.h"
#include "pcm/system/url.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <chrono>

namespace pcm::ops {
namespace {

std::vector<std::filesystem::path> paths_of(const std::vector<std::string>& texts)
{
    return {texts.begin(), texts.end()};
}

Vec3d vector_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

class Convert : public Operation {
public:
    Convert()
    {
        arguments_.add("paths", paths_)
            .as(ValueKind::inputs)
            .positional()
            .required()
            .label("Inputs and output")
            .help(
                "Files, folders with their sub-folders, or trees, merged into one cloud; without --output the last "
                "one is the output");
        arguments_.add("output", output_)
            .as(ValueKind::output)
            .letter('o')
            .label("Output")
            .help("What is written; its extension sets the format: " + std::string(tree_extension) + ", " +
                  writable_text() + "; a tree may be in a bucket, s3://BUCKET/NAME.pct")
            .without("the last path");
        declare_choice();
        declare_grid();
        declare_output();
        work_.memory = options_.memory_bytes;
        work_.declare(arguments_, least_build_memory);
        arguments_.find("memory")->group("Output");
        reading_.declare(arguments_);
        reading_.declare_ignore_crs(arguments_);
    }

    Result answer(const Context& context) override
    {
        Result result;
        result.input = paths_;
        result.output = output_.empty() ? paths_.back() : output_;
        result.makes = Makes::file;
        if (output_.empty()) result.input.pop_back();
        if (result.input.empty()) throw ArgumentError("paths: an input and an output are needed");
        options_.cloud.read = reading_.get(work_.threads);
        options_.write.threads = options_.threads = work_.threads;
        options_.memory_bytes = work_.memory;
        const Selection chosen = region_.get();
        options_.cloud.selection.box = chosen.box;
        options_.cloud.selection.region = chosen.region;
        options_.cloud.selection.clips = chosen.clips;
        options_.cloud.selection.where = chosen.where;
        take_grid();
        if (!las_version_.empty()) options_.write.las_version = static_cast<unsigned>(las_version_.back() - '0');
        if (!colour_bits_.empty()) options_.write.colour_bits = colour_bits_ == "8" ? 8 : 16;
        options_.progress = context.progress;
        const double left_out = choose_level(result.input);
        const ConvertReport report = context.team ? convert_together(result, context)
                                     : is_url(result.output)
                                         ? convert_to_bucket(result, context.progress)
                                         : pcm::convert(paths_of(result.input), result.output, options_);
        result.accuracy = without_finer_levels(left_out, report.outcome.error);
        describe(result, report);
        return result;
    }

private:
    void declare_choice()
    {
        const char* const group = "Selection";
        CloudOptions& cloud = options_.cloud;
        level_.declare(arguments_, "Trees: only the points up to this level", group);
        arguments_.add("max_points", cloud.max_points)
            .group(group)
            .label("Maximum number of points")
            .help("A tree: only its deepest level with at most this many points");
        region_.declare(arguments_, group);
        arguments_.add("attributes", cloud.selection.keep)
            .also("keep")
            .group(group)
            .label("Attributes")
            .help("Only these attributes, separated by commas: --attributes intensity,rgb")
            .without("all");
        arguments_.add("drop", cloud.selection.drop)
            .group(group)
            .label("Without")
            .help("All attributes except these, separated by commas: --drop user_data")
            .without("none");
    }

    void declare_grid()
    {
        const char* const group = "Output";
        arguments_.add("grid", step_)
            .positive()
            .group(group)
            .label("Grid")
            .help("LAS, LAZ: coordinate step")
            .without("the source's, or the coarsest that is exact");
        arguments_.add("scale", scale_)
            .advanced()
            .count(3)
            .positive()
            .group(group)
            .label("Scale")
            .help("LAS, LAZ: steps x y z: --scale 0.01 0.01 0.001");
        arguments_.add("offset", offset_)
            .advanced()
            .count(3)
            .group(group)
            .label("Offset")
            .help("LAS, LAZ: offset x y z of the grid: --offset 500000 4800000 0");
    }

    void declare_output()
    {
        const char* const group = "Output";
        WriteOptions& write = options_.write;
        arguments_.add("decimals", write.decimals)
            .advanced()
            .group(group)
            .label("Decimals")
            .help("Text: digits after the decimal point")
            .without("as many as exact positions need");
        arguments_.add("ascii", write.ascii).group(group).label("Text").help("PLY, PCD: text instead of binary");
        arguments_.add("las_version", las_version_)
            .advanced()
            .one_of({{"1.0", "1.0"}, {"1.1", "1.1"}, {"1.2", "1.2"}, {"1.3", "1.3"}, {"1.4", "1.4"}})
            .group(group)
            .label("LAS version")
            .help("LAS, LAZ: version")
            .without("the source's, or the lowest that holds everything");
        arguments_.add("colour_bits", colour_bits_)
            .advanced()
            .one_of({{"8", "8"}, {"16", "16"}})
            .group(group)
            .label("Bits of colours")
            .help("PLY, PCD: colours of 8 bits, rounded if need be, or 16")
            .without("8, and the exact ones too where 8 do not hold them");
        arguments_.add("float_positions", write.float_positions)
            .advanced()
            .group(group)
            .label("Positions as floats")
            .help("PCD: positions as floats relative to a whole-numbered shift in VIEWPOINT, for PCL and Open3D");
        chunk_points_argument(arguments_, options_.chunk_points);
        arguments_.find("chunk_points")->group(group);
        arguments_.add("overwrite", options_.overwrite)
            .group(group)
            .label("Overwrite")
            .help("Replace an existing output");
    }

    void take_grid()
    {
        if (step_ && !scale_.empty()) throw ArgumentError("--grid and --scale exclude each other");
        if (step_) scale_ = {*step_, *step_, *step_};
        if (!offset_.empty()) {
            if (scale_.empty())
                throw Error(ErrorCode::invalid_argument, {}, "--offset was given without a scale",
                            "give --scale or --grid too");
            options_.write.grid = Grid{vector_of(scale_), vector_of(offset_)};
        } else if (!scale_.empty()) {
            options_.scale = vector_of(scale_);
        }
    }

    // By all processes.
    ConvertReport convert_together(const Result& result, const Context& context) const
    {
        if (is_url(result.output))
            throw Error(ErrorCode::unsupported, result.output, "several processes write to folders, not to buckets",
                        "send the output there afterwards, by 'pcmlab convert'");
        ByteWriter request;
        for (const std::string& word : context.words) request.put_string(word);
        return convert_by(*context.team, paths_of(result.input), result.output, options_, request.bytes());
    }

    // A whole tree of this machine is sent as it is; anything else becomes a tree here first.
    ConvertReport convert_to_bucket(const Result& result, const ProgressFunction& progress)
    {
        const BucketOutput bucket(result.output, result.input, options_.overwrite);
        const std::string& input = result.input[0];
        if (result.input.size() == 1 && !is_url(input) && is_tree_folder(tree_folder_of(input)) && takes_everything()) {
            ConvertReport report;
            const auto start = std::chrono::steady_clock::now();
            report.outcome.points_in = report.outcome.points_out = Tree::open(input)->info().points;
            report.bytes = bucket.send(input, progress);
            report.outcome.seconds = seconds_since(start);
            report.outcome.error_meaning = "largest position error, source units";
            return report;
        }
        options_.progress = part_of(progress, 0, 0.8);
        options_.overwrite = bucket.may_replace();
        const ConvertReport report = pcm::convert(paths_of(result.input), bucket.place(), options_);
        bucket.send(part_of(progress, 0.8, 1));
        return report;
    }

    bool takes_everything() const
    {
        const CloudOptions& cloud = options_.cloud;
        return !cloud.level && !cloud.max_points && !cloud.selection.chooses_points() &&
               !cloud.selection.chooses_attributes() && options_.chunk_points == default_chunk_points;
    }

    // Sets the level. Returns the largest spacing of the trees at it (query/nearest.h); 0: all points are taken.
    double choose_level(const std::vector<std::string>& inputs)
    {
        CloudOptions& cloud = options_.cloud;
        if (!level_.given() && !cloud.max_points) return 0;
        if (level_.error_target && inputs.size() > 1)
            throw ArgumentError("an error target chooses the level of a single tree; several inputs were given");
        cloud.level = level_.level;
        double spacing = 0;
        for (const std::string& input : inputs) {
            if (!is_tree(input) && !is_tree_folder(tree_folder_of(input))) continue;  // refused by convert()
            const auto tree = Tree::open(input);
            if (level_.error_target) cloud.level = level_.of(*tree);
            const auto level = cloud.max_points ? tree->level_with_at_most(*cloud.max_points) : cloud.level;
            if (level) spacing = std::max(spacing, level_spacing(*tree, *level));
        }
        return spacing;
    }

    static void describe(Result& result, const ConvertReport& report)
    {
        result.outcome = report.outcome;
        result.notes = report.notes;
        result.values["points_selected"] = report.outcome.points_in;
        result.values["points_skipped"] = report.points_skipped;
        put_skipped(result, report.skipped);
        result.values["bytes"] = report.bytes;
        result.values["position_error"] = report.outcome.error;
        result.values["grid"] =
            report.grid ? Json({{"scale", report.grid->scale}, {"offset", report.grid->offset}}) : Json();
        result.print("%s: %s points in %.1f s (%.2f M points/s), %s", result.output.c_str(),
                     grouped(report.outcome.points_out).c_str(), report.outcome.seconds,
                     points_per_second(report.outcome) / 1e6, bytes_text(report.bytes).c_str());
        if (report.grid)
            result.line("grid chosen: scale " + exact(report.grid->scale) + ", offset " + exact(report.grid->offset));
    }

    std::vector<std::string> paths_;  // inputs; then the output, where `output_` is empty
    std::string output_;
    RegionArguments region_;
    LevelArguments level_;
    std::optional<double> step_;
    std::vector<double> scale_, offset_;
    std::string las_version_, colour_bits_;
    WorkArguments work_;
    ReadingArguments reading_;
    ConvertOptions options_;
};

}  // namespace

Row convert_row()
{
    return {"convert",
            nullptr,
            "Convert files of any supported format, or trees, to a file of another format or to a tree",
            "Writes a cloud, or a part of it, in another format: all points, or those in a region or that meet "
            "conditions, with all attributes or some.",
            0,
            nullptr,
            with_skipped_keys(
                {{"points_selected", "count", "points", "points of the inputs that were selected"},
                 {"points_skipped", "count", "points", "without a finite position, or beyond the largest coordinate"},
                 {"bytes", "count", "bytes", "size of the output"},
                 {"position_error", "number", "source units", "largest position error"},
                 {"grid", "object?", "source units",
                  "scale and offset that were chosen for a cloud of doubles; null: none was"}}),
            make<Convert>,
            {},
            follows_from_points_read};
}

}  // namespace pcm::ops

#include "pcm/convert/convert.h"

#include "pcm/cli/common.h"
#include "pcm/cli/reading.h"
#include "pcm/cli/region_options.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/tree/tree.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    ReadingOptions reading;
    RegionOptions region;
    std::vector<std::string> paths;  // inputs, then the output
    std::vector<double> scale, offset;
    double step = 0;
    std::string las_version;
    std::uint64_t memory = std::uint64_t(1) << 30;
    unsigned threads = 0;
    ConvertOptions options;
};

Vec3d vector_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

void take_grid(const Arguments& arguments, ConvertOptions& options)
{
    std::vector<double> scale = arguments.scale;
    if (arguments.step != 0) scale = {arguments.step, arguments.step, arguments.step};
    for (const double s : scale)
        if (!(s > 0)) throw Error(ErrorCode::invalid_argument, {}, "--grid and --scale must be positive");
    if (!arguments.offset.empty()) {
        if (scale.empty())
            throw Error(ErrorCode::invalid_argument, {}, "--offset was given without a scale",
                        "give --scale or --grid too");
        options.write.grid = Grid{vector_of(scale), vector_of(arguments.offset)};
    } else if (!scale.empty()) {
        options.scale = vector_of(scale);
    }
}

std::optional<unsigned> minor_version(const std::string& text)
{
    if (text.empty()) return std::nullopt;
    for (unsigned minor = 0; minor <= 4; ++minor)
        if (text == "1." + std::to_string(minor)) return minor;
    throw UsageError("--las-version: found '" + text + "', expected 1.0, 1.1, 1.2, 1.3 or 1.4");
}

int convert(Arguments& arguments)
{
    if (arguments.paths.size() < 2) throw UsageError("paths: an input and an output are needed");
    ConvertOptions& options = arguments.options;
    const std::string output = arguments.paths.back();
    const std::vector<std::filesystem::path> inputs(arguments.paths.begin(), arguments.paths.end() - 1);
    options.cloud.read = arguments.reading.get(arguments.threads);
    options.write.threads = options.threads = arguments.threads;
    options.memory_bytes = arguments.memory;
    const Selection chosen = arguments.region.get();
    options.cloud.selection.box = chosen.box;
    options.cloud.selection.region = chosen.region;
    options.cloud.selection.clips = chosen.clips;
    options.cloud.selection.where = chosen.where;
    take_grid(arguments, options);
    options.write.las_version = minor_version(arguments.las_version);
    if (const auto bits = options.write.colour_bits; bits && *bits != 8 && *bits != 16)
        throw UsageError("--colour-bits: found " + std::to_string(*bits) + ", expected 8 or 16");
    options.progress = console_progress(arguments.common);

    const ConvertReport report = pcm::convert(inputs, output, options);
    end_progress(arguments.common);
    if (arguments.common.json) {
        Json json;
        json["output"] = output;
        put_outcome(json, report.outcome);
        json["points_selected"] = report.outcome.points_in;
        json["points_skipped"] = report.points_skipped;
        put_skipped(json, report.skipped);
        json["bytes"] = report.bytes;
        json["position_error"] = report.outcome.error;
        if (report.grid) json["grid"] = {{"scale", report.grid->scale}, {"offset", report.grid->offset}};
        json["notes"] = report.notes;
        print_json(json);
        return finished(report.outcome);
    }
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%s: %s points in %.1f s (%.2f M points/s), %s\n", output.c_str(),
                grouped(report.outcome.points_out).c_str(), report.outcome.seconds,
                points_per_second(report.outcome) / 1e6, bytes_text(report.bytes).c_str());
    if (report.grid)
        std::printf("grid chosen: scale %s, offset %s\n", exact(report.grid->scale).c_str(),
                    exact(report.grid->offset).c_str());
    std::printf("largest position error %s source units, peak memory %s\n", exact(report.outcome.error).c_str(),
                bytes_text(peak_memory_bytes()).c_str());
    return finished(report.outcome);
}

void add_choice(Options& options, Arguments& arguments)
{
    const char* const group = "Selection";
    CloudOptions& cloud = arguments.options.cloud;
    options.option("--level", cloud.level, "Trees: only the points up to this level").group(group);
    options.option("--max-points", cloud.max_points, "A tree: only its deepest level with at most this many points")
        .group(group);
    arguments.region.add_to(options, group);
    options
        .option("--attributes,--keep", cloud.selection.keep,
                "Only these attributes, separated by commas: --attributes intensity,rgb")
        .separated_by(',')
        .one_value_each()
        .group(group);
    options.option("--drop", cloud.selection.drop, "All attributes except these, separated by commas: --drop user_data")
        .separated_by(',')
        .one_value_each()
        .group(group);
}

void add_output(Options& options, Arguments& arguments)
{
    const char* const group = "Output";
    ConvertOptions& to = arguments.options;
    const Option step = options
                            .option("--grid", arguments.step,
                                    "LAS, LAZ: coordinate step (default: the source's, or the coarsest that is exact)")
                            .positive()
                            .group(group);
    options.option("--scale", arguments.scale, "LAS, LAZ: steps x y z: --scale 0.01 0.01 0.001")
        .values(3)
        .positive()
        .excludes(step)
        .group(group);
    options.option("--offset", arguments.offset, "LAS, LAZ: offset x y z of the grid: --offset 500000 4800000 0")
        .values(3)
        .group(group);
    options
        .option("--decimals", to.write.decimals,
                "Text: digits after the decimal point (default: as many as exact positions need)")
        .group(group);
    options.flag("--ascii", to.write.ascii, "PLY, PCD: text instead of binary").group(group);
    options
        .option("--las-version", arguments.las_version,
                "LAS, LAZ: version 1.0 to 1.4 (default: the source's, or the lowest that holds everything)")
        .group(group);
    options
        .option("--colour-bits", to.write.colour_bits,
                "PLY, PCD: colours of 8 bits, rounded if need be, or 16 (default: 8, and the exact ones too where 8 do "
                "not hold them)")
        .group(group);
    options
        .flag("--float-positions", to.write.float_positions,
              "PCD: positions as floats relative to a whole-numbered shift in VIEWPOINT, for PCL and Open3D")
        .group(group);
    options.option("-m,--memory", arguments.memory, "Trees: memory limit of the build, e.g. 512M or 2G (default 1G)")
        .bytes()
        .group(group);
    options.option("--chunk-points", to.chunk_points, "Trees: maximum number of points per chunk (default 25000)")
        .group(group);
    options.flag("--overwrite", to.overwrite, "Replace an existing output").group(group);
}

}  // namespace

Run add_convert(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    std::string writable = tree_extension;
    for (const std::string& extension : writable_extensions()) writable += ", " + extension;
    options
        .positional("paths", arguments->paths,
                    "Files, folders with their sub-folders, or trees, merged into one cloud; then the output, whose "
                    "extension sets "
                    "the format: " +
                        writable)
        .required();
    add_choice(options, *arguments);
    add_output(options, *arguments);
    options.option("-t,--threads", arguments->threads, "Threads (default: one per processor)");
    arguments->reading.add_to(options);
    arguments->reading.add_ignore_crs(options);
    add_common(options, arguments->common);
    return [arguments] { return convert(*arguments); };
}

}  // namespace pcm::cli

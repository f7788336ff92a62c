#include "pcm/filter/result_tree.h"
#include "pcm/io/pipe/transformed_reader.h"

#include "pcm/build/builder.h"
#include "pcm/cli/common.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree, output;
    std::vector<double> translate, rotate, matrix, pivot;
    double scale = 1;
    std::uint64_t memory = std::uint64_t(1) << 30;
    BuildOptions options;
};

[[noreturn]] void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

Affine map_of(const Arguments& arguments, const Box3d& box)
{
    Vec3d pivot = box.empty() ? Vec3d{0, 0, 0} : box.centre();
    if (!arguments.pivot.empty()) pivot = {arguments.pivot[0], arguments.pivot[1], arguments.pivot[2]};
    if (!arguments.matrix.empty()) {
        if (!arguments.rotate.empty() || arguments.scale != 1 || !arguments.translate.empty())
            refuse("--matrix cannot be combined with --rotate, --scale or --translate",
                   "the matrix replaces all of them");
        std::array<Vec3d, 3> linear;
        Vec3d shift;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) linear[i][j] = arguments.matrix[i * 4 + j];
            shift[i] = arguments.matrix[i * 4 + 3];
        }
        return Affine::about(linear, shift, pivot);
    }
    if (arguments.rotate.empty() && arguments.scale == 1 && arguments.translate.empty())
        refuse("no transformation was given", "give --translate, --rotate, --scale or --matrix");
    Vec3d axis{0, 0, 1};
    double radians = 0;
    if (!arguments.rotate.empty()) {
        axis = {arguments.rotate[0], arguments.rotate[1], arguments.rotate[2]};
        if (axis == Vec3d{0, 0, 0})
            refuse("the axis of --rotate has length zero", "0 0 1 30 rotates by 30 degrees about the vertical axis");
        radians = arguments.rotate[3] * pi / 180;
    }
    Affine map;
    if (radians == 0) {  // positions keep their grid
        map.pivot = map.target = pivot;
        for (std::size_t a = 0; a < 3; ++a) map.linear[a][a] = arguments.scale;
        if (arguments.scale == 1) map.pivot = map.target = {0, 0, 0};
    } else {
        map = Affine::rotation(axis, radians, pivot, arguments.scale);
    }
    for (std::size_t a = 0; a < 3 && !arguments.translate.empty(); ++a) map.target[a] += arguments.translate[a];
    return map;
}

int transform(Arguments& arguments)
{
    const auto tree = Tree::open(arguments.tree);
    std::error_code ignored;
    if (std::filesystem::equivalent(tree->folder(), arguments.output, ignored))
        refuse("the output is the input tree", "give the new tree another name");
    const Affine map = map_of(arguments, tree->info().bounds());
    const auto open = [&] {
        return std::make_unique<TransformedReader>(std::make_unique<TreeReader>(tree, std::nullopt, Selection()), map);
    };
    arguments.options.memory_bytes = arguments.memory;
    arguments.options.progress = console_progress(arguments.common);
    const BuildReport report = build_or_write(open, tree->info().sources, arguments.output, arguments.options);
    end_progress(arguments.common);
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        json["output"] = arguments.output;
        put_outcome(json, report.outcome);
        json["position_error"] = report.outcome.error;
        json["bytes"] = report.bytes;
        print_json(json);
        return finished(report.outcome);
    }
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%s: %s points in %.1f s, %s; largest position error %s source units\n", arguments.output.c_str(),
                grouped(report.outcome.points_out).c_str(), report.outcome.seconds, bytes_text(report.bytes).c_str(),
                exact(report.outcome.error).c_str());
    return finished(report.outcome);
}

}  // namespace

Run add_transform(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    options
        .positional("output", arguments->output,
                    "The new tree's folder, by convention NAME.pct; or a file, by the extension: NAME.laz, .ply, ...")
        .required();
    const char* group = "Transformation (scaled and rotated about the pivot, then translated)";
    options.option("--translate", arguments->translate, "Translation dx dy dz, source units: --translate 0 0 -1.5")
        .values(3)
        .group(group);
    options
        .option("--rotate", arguments->rotate,
                "Rotation about the axis ax ay az by an angle in degrees, counter-clockwise where the axis points to "
                "the viewer: --rotate 0 0 1 30")
        .values(4)
        .group(group);
    options.option("--scale", arguments->scale, "Scale factor, such as 0.3048 from feet to metres (default 1)")
        .group(group);
    options.option("--matrix", arguments->matrix, "Instead of these: twelve numbers, the rows of a 3 x 4 matrix")
        .values(12)
        .group(group);
    options
        .option("--pivot", arguments->pivot,
                "Point x y z that stays where it is (default: the centre of the cloud's box)")
        .values(3)
        .group(group);
    options.option("-m,--memory", arguments->memory, "Memory limit of the build, e.g. 512M or 2G (default 1G)").bytes();
    options.option("--chunk-points", arguments->options.chunk_points,
                   "Maximum number of points per chunk (default 25000)");
    options.option("-t,--threads", arguments->options.threads, "Threads (default: one per processor)");
    options.flag("--overwrite", arguments->options.overwrite, "Replace an existing output");
    add_common(options, arguments->common);
    return [arguments] { return transform(*arguments); };
}

}  // namespace pcm::cli

// One point for each voxel.
#include "pcm/filter/voxel_grid_in_memory.h"
#include "pcm/ops/shared/result_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

#include <cmath>
#include <limits>

namespace pcm::ops {
namespace {

// Last bit of the largest coordinate, as a double.
double last_bit_of(const Box3d& box)
{
    if (box.empty()) return 0;
    const double largest = std::max(largest_magnitude(box.min), largest_magnitude(box.max));
    return std::nextafter(largest, std::numeric_limits<double>::infinity()) - largest;
}

class Voxel : public Operation {
public:
    Voxel()
    {
        to_.declare_inputs(arguments_);
        arguments_.add("size", size_)
            .letter('s')
            .script("VoxelSize")
            .required()
            .in_dialogs("0.1")
            .spacing_in_dialogs()
            .unit("source units")
            .label("Voxel size")
            .help("Edge of a voxel");
        arguments_.add("anchor", anchor_)
            .count(3)
            .label("Anchor")
            .help("Voxels begin at x y z plus multiples of their size; grids of different clouds fit together")
            .without("0 0 0");
        arguments_.choice("point", options_.point, {{"centroid", "Centroid"}, {"nearest", "Nearest point"}})
            .label("Point of a voxel")
            .help(
                "centroid: the mean position with the means of the attributes; nearest: the point that is nearest to "
                "the centroid, unchanged");
        arguments_.add("nearest", nearest_)
            .only(Face::command)  // dialogs have the choice
            .label("Nearest point")
            .help(
                "Keep the point nearest to the centroid, unchanged, instead of the centroid and mean attributes: "
                "--point nearest");
        arguments_.add("count", options_.count)
            .label("Add point_count")
            .help("Add an attribute point_count: the number of points in the voxel");
        arguments_.add("majority", options_.by_majority)
            .label("By majority")
            .help("Integer attributes whose most frequent value is taken, separated by commas")
            .without("classification, return numbers, flags, identities");
        arguments_.add("mean", options_.by_mean)
            .label("By mean")
            .help("Attributes whose mean is taken, separated by commas")
            .without("all others");
        to_.declare_target(arguments_);
        to_.declare_reading(arguments_);
    }

    Result answer(const Context& context) override
    {
        options_.voxels.size = size_;
        if (!anchor_.empty()) options_.voxels.anchor = {anchor_[0], anchor_[1], anchor_[2]};
        if (nearest_) options_.point = VoxelPoint::nearest;
        check_voxels(options_.voxels, {}, nullptr);  // before files are read
        const Sources sources(to_, to_.target.choice(context.face, arguments_), Sampling::grid, context.progress,
                              [&](const FileInfo& points) { return fits_in_memory(points, to_.work.memory); });
        const VoxelGridReport report =
            sources.points()
                ? sources.apply_to_points([&](PointReader& points, const auto& names, const ResultOptions& to) {
                      return voxel_grid_in_memory(points, names, options_, to);
                  })
                : sources.apply([&](const std::filesystem::path& tree, const ResultOptions& to) {
                      return voxel_grid(tree, options_, to);
                  });
        // Centroids are rounded to doubles.
        const double rounding = options_.point == VoxelPoint::centroid ? last_bit_of(report.box) : 0;
        Result result;
        sources.describe(result, report.build);
        result.accuracy = rounded_positions(report.build.outcome.error + rounding);
        result.values["voxel_size"] = size_;
        result.values["most_points_in_a_voxel"] = report.most_in_one;
        result.values["bytes"] = report.build.bytes;
        const Outcome& outcome = result.outcome;
        result.print("%s: %s points of %s, one for each voxel of %s with points, in %.1f s (%.2f M points/s)",
                     result.output.c_str(), grouped(outcome.points_out).c_str(), grouped(outcome.points_in).c_str(),
                     exact(size_).c_str(), outcome.seconds,
                     static_cast<double>(outcome.points_in) / std::max(1e-9, outcome.seconds) / 1e6);
        result.print("at most %s points in a voxel, %s", grouped(report.most_in_one).c_str(),
                     bytes_text(report.build.bytes).c_str());
        return result;
    }

private:
    ResultArguments to_;
    double size_ = 0;
    std::vector<double> anchor_;
    bool nearest_ = false;
    VoxelGridOptions options_;
};

}  // namespace

Row voxel_row()
{
    return {
        "voxel",
        "Voxel Grid of Point Cloud Tree",
        "Thin a cloud: one point for each voxel, the centroid of its points and of their attributes",
        "Makes a <b>point cloud tree</b> with one point for each voxel that has points: their centroid, with the means "
        "of their colours, normals and other attributes, or the point nearest to it. The voxels' corners are multiples "
        "of their size in source coordinates. It takes clouds of any size in bounded memory.",
        menu::points | menu::sampling,
        "-voxels.pct",
        {{"voxel_size", "number", "source units", "edge of a voxel"},
         {"most_points_in_a_voxel", "count", "points", "points of the voxel with the most"},
         {"bytes", "count", "bytes", "size of the result"}},
        make<Voxel>,
        {"size"},
        "It takes neither a time limit nor an error target: every point is read once, and centroids are rounded as "
        "doubles are."};
}

}  // namespace pcm::ops

#include "bench/place/clicks.h"

#include "pcm/shapes/shape_traits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace pcm::bench {
namespace {

constexpr std::size_t least_clicked = 200;  // points
constexpr double points_share = 0.9, radius_share = 0.05;

}  // namespace

ClickedSite::ClickedSite(const std::filesystem::path& tree, std::size_t clicks, std::uint64_t seed)
    : cloud_(PointCloud::open(tree)),
      truth_(read_truth(std::filesystem::path(cloud_->tree()->folder()).replace_extension(".truth.json")))
{
    const Tree& nodes = *cloud_->tree();
    const std::size_t source = *nodes.info().schema.find("point_source_id");
    ColumnSet columns = ColumnSet::only_positions();
    columns.attributes.set(source);
    std::vector<std::vector<Vec3d>> places(truth_.size());
    for (NodeId node = 0; node < nodes.nodes().size(); ++node) {
        const Chunk chunk = nodes.read_chunk(node, columns);
        std::vector<std::uint16_t>& ids = ids_.emplace_back(chunk.points);
        for (std::size_t i = 0; i < chunk.points; ++i) {
            ids[i] = static_cast<std::uint16_t>(chunk.attributes[source]->value(i, 0));
            places.at(ids[i]).push_back(nodes.info().grid.to_source(chunk.positions->grid(i)));
        }
    }
    std::mt19937_64 random(seed);
    std::vector<std::uint32_t> clicked;
    for (std::uint32_t id = 1; id < places.size(); ++id)
        if (places[id].size() >= least_clicked) clicked.push_back(id);
    const auto click = [&](std::uint32_t id) {
        if (!places[id].empty()) clicks_.push_back({places[id][random() % places[id].size()], id});
    };
    for (std::size_t k = 0; k < clicks && !clicked.empty(); ++k) click(clicked[random() % clicked.size()]);
    for (std::size_t k = 0; k < clicks / 3; ++k) click(0);
}

bool ClickedSite::is_right(const FittedPrimitive& fitted, std::uint32_t truth) const
{
    const ShapeFit& fit = fitted.primitive.fit;
    const Shape& shape = truth_[truth].shape;
    if (!fit.has_shape() || fit.shape.kind != shape.kind || fitted.points.empty()) return false;
    if (traits_of(shape.kind).has_radius()) {
        const double error = std::fabs(fit.shape.radius - shape.radius);
        if (!(error <= std::max(radius_share * shape.radius, 3 * fit.errors.radius))) return false;
    }
    std::uint64_t own = 0;
    for (NodeId node = 0; node < ids_.size(); ++node)
        for (const std::uint32_t i : fitted.points.points(node)) own += ids_[node][i] == truth;
    return static_cast<double>(own) >= points_share * static_cast<double>(fitted.points.size());
}

void ClickedSite::judge(bool list, Counts& counts) const
{
    FitAtOptions options;
    for (const ShapeTraits& row : shape_kinds()) options.kinds.push_back(row.kind);
    options.threads = 1;
    for (const Click& click : clicks_) {
        const FittedPrimitive fitted = fit_at(*cloud_, {click.place}, {}, options);
        const ShapeFit& fit = fitted.primitive.fit;
        const bool good = fit.verdict == FitVerdict::good, right = click.truth > 0 && is_right(fitted, click.truth);
        if (click.truth == 0)
            ++(good ? counts.clutter_good : counts.clutter_doubtful);
        else if (right)
            ++(good ? counts.right_good : counts.right_doubtful);
        else
            ++(good ? counts.wrong_good : counts.wrong_doubtful);
        if (list)
            std::printf("%s %u: %s, %s, %llu points%s%s\n",
                        click.truth == 0 ? "clutter" : traits_of(truth_[click.truth].shape.kind).name, click.truth,
                        fit.has_shape() ? traits_of(fit.shape.kind).name : "nothing", name_of(fit.verdict),
                        static_cast<unsigned long long>(fitted.points.size()), right ? ", right" : "",
                        good ? "" : (", " + fit.message).c_str());
    }
}

}  // namespace pcm::bench

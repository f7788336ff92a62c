#include "pcm/detect/add_elbows.h"

#include "pcm/detect/joined_report.h"
#include "pcm/detect/point_labels.h"
#include "pcm/detect/surface_sample.h"
#include "pcm/place/bent_tube.h"
#include "pcm/shapes/primitive_list.h"
#include "pcm/tree/selected_nodes.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace pcm {
namespace {

// The list with elbows in place of their pieces, and each point's place in it.
class WithElbows {
public:
    WithElbows(const PointCloud& cloud, const ElbowOptions& options, ElbowReport elbows, DetectReport& report)
        : points_(cloud.tree(), options.limit),
          elbows_(std::move(elbows)),
          report_(report),
          labels_(std::make_shared<PointLabels>(*cloud.tree()))
    {
    }

    void run()
    {
        leave_out_pieces();
        for (std::size_t i = 0; i < elbows_.elbows.size(); ++i) {
            Primitive& elbow = elbows_.elbows[i];
            elbow.label = static_cast<std::uint32_t>(report_.primitives.size() + 1);
            elbow.points = take_points(elbow);
            report_.primitives.push_back(std::move(elbow));
            report_.agreement.push_back(elbows_.agreement[i]);
        }
        sort();
        report_.labels = labels_;
        report_.outcome.points_out = 0;
        for (const Primitive& one : report_.primitives) report_.outcome.points_out += one.points;
    }

private:
    const Tree& tree() const { return points_.tree(); }

    void leave_out_pieces()
    {
        std::vector<std::uint32_t> label_of(report_.primitives.size() + 1, 0);
        std::vector<Primitive> kept;
        std::vector<double> agreement;
        for (std::size_t i = 0; i < report_.primitives.size(); ++i) {
            if (elbows_.is_piece[i]) continue;
            kept.push_back(std::move(report_.primitives[i]));
            agreement.push_back(report_.agreement[i]);
            label_of[i + 1] = static_cast<std::uint32_t>(kept.size());
        }
        report_.primitives = std::move(kept);
        report_.agreement = std::move(agreement);
        number_again(report_.primitives);
        label_again(*report_.labels, label_of);
    }

    // Most points first.
    void sort()
    {
        std::vector<std::size_t> order(report_.primitives.size());
        std::iota(order.begin(), order.end(), std::size_t(0));
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return report_.primitives[a].points > report_.primitives[b].points;
        });
        std::vector<std::uint32_t> label_of(order.size() + 1, 0);
        std::vector<Primitive> sorted;
        std::vector<double> agreement;
        for (const std::size_t i : order) {
            sorted.push_back(std::move(report_.primitives[i]));
            sorted.back().colour = colour_in_turn(sorted.size() - 1);
            agreement.push_back(report_.agreement[i]);
            label_of[i + 1] = sorted.back().label = static_cast<std::uint32_t>(sorted.size());
        }
        report_.primitives = std::move(sorted);
        report_.agreement = std::move(agreement);
        label_again(*labels_, label_of);
    }

    // `label_of`: keyed by label.
    void label_again(const PointLabels& from, const std::vector<std::uint32_t>& label_of)
    {
        for (NodeId node = 0; node < tree().nodes().size(); ++node) {
            if (tree().node(node).points == 0) continue;
            std::vector<std::uint32_t> labels = from.get(node);
            for (std::uint32_t& label : labels) label = label_of[label];
            labels_->set_all(node, labels);
        }
    }

    // Number of points that now are the elbow's.
    std::uint64_t take_points(const Primitive& elbow)
    {
        const ShapeFit& fit = elbow.fit;
        const double reach = fit.shape.radius + fit.shape.second + fit.threshold;
        const Vec3d corner{reach, reach, reach};
        const Box3d around{fit.shape.point - corner, fit.shape.point + corner};
        const double arc = elbow.bounds.end - elbow.bounds.begin;
        std::uint64_t count = 0;
        points_.visit(
            grid_box(tree(), around), std::numeric_limits<std::uint16_t>::max(), [&](const ChosenPoints::Some& some) {
                const std::vector<std::uint32_t> before = labels_->get(some.node);
                std::vector<std::uint32_t> numbers;
                for (std::size_t k = 0; k < some.number.size(); ++k) {
                    if (before[some.number[k]] > 0 || distance_to(fit.shape, some.at[k]) > fit.threshold) continue;
                    const double angle = angle_about(fit.shape, elbow.bounds.zero, some.at[k]);
                    const bool is_on_arc = angle >= elbow.bounds.begin ? angle <= elbow.bounds.begin + arc
                                                                       : angle + 2 * pi <= elbow.bounds.begin + arc;
                    if (is_on_arc) numbers.push_back(some.number[k]);
                }
                labels_->set(some.node, numbers, std::vector<std::uint32_t>(numbers.size(), elbow.label).data());
                count += numbers.size();
            });
        return count;
    }

    const ChosenPoints points_;
    ElbowReport elbows_;
    DetectReport& report_;
    const std::shared_ptr<PointLabels> labels_;
};

}  // namespace

std::size_t add_elbows(const PointCloud& cloud, const ElbowOptions& options, DetectReport& report)
{
    ElbowReport found = find_elbows(cloud, report.primitives, options);
    const std::size_t count = found.elbows.size();
    if (count > 0) WithElbows(cloud, options, std::move(found), report).run();
    return count;
}

}  // namespace pcm

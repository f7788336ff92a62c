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
          before_(report.primitives.size()),
          labels_(std::make_shared<PointLabels>(*cloud.tree()))
    {
    }

    void run()
    {
        std::vector<std::size_t> number;  // place of each in the list as it was, with all elbows behind it
        std::vector<Primitive> all;
        for (std::size_t i = 0; i < before_; ++i) {
            if (elbows_.is_piece[i]) continue;
            all.push_back(std::move(report_.primitives[i]));
            number.push_back(i);
        }
        number_again(all);
        for (std::size_t k = 0; k < elbows_.elbows.size(); ++k) {
            Primitive& elbow = elbows_.elbows[k];
            elbow.points = take_points(elbow, static_cast<std::uint32_t>(k + 1));
            all.push_back(std::move(elbow));
            number.push_back(before_ + k);
        }
        put_in_order(std::move(all), number);
        report_.outcome.points_out = 0;
        for (const Primitive& one : report_.primitives) report_.outcome.points_out += one.points;
    }

private:
    const Tree& tree() const { return points_.tree(); }

    // Most points first. `number`: as in run().
    void put_in_order(std::vector<Primitive> all, const std::vector<std::size_t>& number)
    {
        std::vector<double> agreement = std::move(report_.agreement);
        agreement.insert(agreement.end(), elbows_.agreement.begin(), elbows_.agreement.end());
        std::vector<std::size_t> order(all.size());
        std::iota(order.begin(), order.end(), std::size_t(0));
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return all[a].points > all[b].points; });
        std::vector<std::uint32_t> label_of(agreement.size() + 1, 0);  // keyed by number + 1
        report_.primitives.clear();
        report_.agreement.clear();
        for (const std::size_t i : order) {
            report_.primitives.push_back(std::move(all[i]));
            Primitive& one = report_.primitives.back();
            one.colour = colour_in_turn(report_.primitives.size() - 1);
            label_of[number[i] + 1] = one.label = static_cast<std::uint32_t>(report_.primitives.size());
            report_.agreement.push_back(agreement[number[i]]);
        }
        label_points(label_of);
    }

    void label_points(const std::vector<std::uint32_t>& label_of)
    {
        for (NodeId node = 0; node < tree().nodes().size(); ++node) {
            if (tree().node(node).points == 0) continue;
            const std::vector<std::uint32_t> old = report_.labels->get(node);
            std::vector<std::uint32_t> labels = labels_->get(node);
            for (std::size_t i = 0; i < labels.size(); ++i)
                labels[i] = label_of[labels[i] > 0 ? before_ + labels[i] : old[i]];
            labels_->set_all(node, labels);
        }
        report_.labels = labels_;
    }

    // Whether a point with this label belongs to something that is kept.
    bool is_taken(std::uint32_t old) const { return old > 0 && !elbows_.is_piece[old - 1]; }

    // Number of points that now are the elbow's.
    std::uint64_t take_points(const Primitive& elbow, std::uint32_t label)
    {
        const ShapeFit& fit = elbow.fit;
        const double reach = fit.shape.radius + fit.shape.second + fit.threshold;
        const Vec3d corner{reach, reach, reach};
        const Box3d around{fit.shape.point - corner, fit.shape.point + corner};
        const double arc = elbow.bounds.end - elbow.bounds.begin;
        std::uint64_t count = 0;
        points_.visit(
            grid_box(tree(), around), std::numeric_limits<std::uint16_t>::max(), [&](const ChosenPoints::Some& some) {
                const std::vector<std::uint32_t> old = report_.labels->get(some.node), own = labels_->get(some.node);
                std::vector<std::uint32_t> numbers;
                for (std::size_t k = 0; k < some.number.size(); ++k) {
                    const std::uint32_t i = some.number[k];
                    if (is_taken(old[i]) || own[i] > 0 || distance_to(fit.shape, some.at[k]) > fit.threshold) continue;
                    const double angle = angle_about(fit.shape, elbow.bounds.zero, some.at[k]);
                    const bool is_on_arc = angle >= elbow.bounds.begin ? angle <= elbow.bounds.begin + arc
                                                                       : angle + 2 * pi <= elbow.bounds.begin + arc;
                    if (is_on_arc) numbers.push_back(i);
                }
                labels_->set(some.node, numbers, std::vector<std::uint32_t>(numbers.size(), label).data());
                count += numbers.size();
            });
        return count;
    }

    const ChosenPoints points_;
    ElbowReport elbows_;
    DetectReport& report_;
    const std::size_t before_;                   // number of primitives before
    const std::shared_ptr<PointLabels> labels_;  // those of elbows by their place + 1, at last all of them
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

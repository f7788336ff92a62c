#include "pcm/detect/outline_points.h"

#include "pcm/detect/tuning.h"
#include "pcm/shapes/flat_hull.h"
#include "pcm/tree/selected_nodes.h"

#include <algorithm>
#include <limits>

namespace pcm {
namespace {

constexpr std::size_t least_outlined = 20;  // points that an outline is from

class OutlinePoints {
public:
    OutlinePoints(const ChosenPoints& points, const std::vector<Hypothesis>& hypotheses, AssignedPoints& assigned,
                  PointLabels& labels, const OutlinePointsOptions& options)
        : points_(points), hypotheses_(hypotheses), assigned_(assigned), labels_(labels), options_(options)
    {
    }

    void run()
    {
        std::vector<std::uint32_t> number_of(assigned_.parts.size(), 0);
        for (const auto& [number, part] : assigned_.numbers) number_of[part] = number;
        for (std::uint32_t p = 0; p < assigned_.parts.size(); ++p)
            if (needs_points(assigned_.parts[p])) take(assigned_.parts[p], number_of[p] + 1);
    }

private:
    bool needs_points(const SurfacePart& part) const
    {
        const OutlineTuning& tuned = detect_tuning().outlines;
        const auto points = static_cast<double>(part.points), least = static_cast<double>(options_.least_points);
        return traits_of(hypotheses_[part.hypothesis].shape.kind).is_flat() && part.some.size() >= least_outlined &&
               points >= tuned.min_points * least && points < tuned.max_points * least &&
               static_cast<double>(part.continued) <=
                   detect_tuning().pieces.doubtful_edge * static_cast<double>(part.edge) &&
               static_cast<double>(part.mixed) <= detect_tuning().joining.max_mixed * static_cast<double>(part.sampled);
    }

    void take(SurfacePart& part, std::uint32_t label)
    {
        const Hypothesis& from = hypotheses_[part.hypothesis];
        const FlatHull outline(part.some, from.shape);
        Box3d around = part.box;
        for (std::size_t a = 0; a < 3; ++a) around.min[a] -= options_.spacing, around.max[a] += options_.spacing;
        points_.visit(grid_box(points_.tree(), around), std::numeric_limits<std::uint16_t>::max(),
                      [&](const ChosenPoints::Some& some) {
                          options_.check();
                          std::vector<std::uint32_t> numbers, given;
                          const std::vector<std::uint32_t> before = labels_.get(some.node);
                          for (std::size_t k = 0; k < some.number.size(); ++k) {
                              const std::uint32_t old = before[some.number[k]] & ~interior_label;
                              if (old > 0 && assigned_.part_of(old) != AssignedPoints::no_part) continue;
                              if (distance_to(from.shape, some.at[k]) > from.threshold ||
                                  outline.gap_to(some.at[k]) > options_.spacing)
                                  continue;
                              numbers.push_back(some.number[k]);
                              given.push_back(label);
                              ++part.points;
                              part.box.extend(some.at[k]);
                          }
                          labels_.set(some.node, numbers, given.data());
                      });
    }

    const ChosenPoints& points_;
    const std::vector<Hypothesis>& hypotheses_;
    AssignedPoints& assigned_;
    PointLabels& labels_;
    const OutlinePointsOptions& options_;
};

}  // namespace

void take_outline_points(const ChosenPoints& points, const std::vector<Hypothesis>& hypotheses,
                         AssignedPoints& assigned, PointLabels& labels, const OutlinePointsOptions& options)
{
    OutlinePoints(points, hypotheses, assigned, labels, options).run();
}

}  // namespace pcm

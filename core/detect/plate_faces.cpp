#include "pcm/detect/plate_faces.h"

#include "pcm/detect/refined_shape.h"
#include "pcm/detect/tuning.h"
#include "pcm/detect/two_faces.h"
#include "pcm/shapes/flat_hull.h"
#include "pcm/tree/selected_nodes.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace pcm {
namespace {

// What a plane's points are divided by.
struct Plate {
    std::uint32_t part = 0;
    std::array<std::uint32_t, 2> parts{};  // numbers of the faces' parts
    std::array<std::uint32_t, 2> labels{};
    std::map<std::uint32_t, std::size_t> face_of;
    std::array<Shape, 2> planes;
    double threshold = 0;
    Box3d box;
    FlatHull outline;
};

class PlateDivision {
public:
    PlateDivision(const ChosenPoints& points, const SeenPlanes& seen, AssignedPoints& assigned,
                  std::vector<Hypothesis>& hypotheses, PointLabels& labels, const PlateOptions& options)
        : points_(points), seen_(seen), assigned_(assigned), hypotheses_(hypotheses), labels_(labels), options_(options)
    {
    }

    void run()
    {
        for (const SeenPlane& plane : seen_.planes())
            if (may_be_plate(plane)) divide(plane);
        for (const Plate& plate : plates_) give_labels(plate);
    }

private:
    bool may_be_plate(const SeenPlane& plane) const
    {
        return plane.is_narrow && plane.rms > detect_tuning().contest.min_noise * options_.noise &&
               !plane.points.empty();
    }

    void divide(const SeenPlane& plane)
    {
        const PlateTuning& tuned = detect_tuning().plates;
        const auto left = seen_.left_along(plane.shape.axis);
        if (!left) return;
        const auto faces = two_faces(plane.shape, seen_.shifts().corrected(plane.points),
                                     std::hypot(*left, tuned.least_left * options_.noise));
        if (!faces || faces->certainty < tuned.min_certainty || faces->noise > tuned.max_noise * faces->noise_as_one)
            return;
        add_plate(plane, *faces);
    }

    void add_plate(const SeenPlane& plane, const TwoFaces& faces)
    {
        Plate plate{plane.part,
                    {},
                    {},
                    faces.face_of,
                    faces.planes,
                    plane.threshold,
                    assigned_.parts[plane.part].box,
                    FlatHull(places_of(plane.points), plane.shape)};
        const SurfacePart whole = assigned_.parts[plane.part];
        std::array<std::vector<PointOfStation>, 2> points;
        for (const PointOfStation& p : plane.points) points[faces.face_of.at(p.station)].push_back(p);
        for (const std::size_t face : {0, 1}) {
            const double share = static_cast<double>(points[face].size()) / static_cast<double>(plane.points.size());
            const auto part_of_it = [&](std::uint64_t count) {
                return static_cast<std::uint64_t>(std::llround(share * static_cast<double>(count)));
            };
            SurfacePart part;
            plate.planes[face] = refined_shape(places_of(points[face]), faces.planes[face], plane.threshold)
                                     .value_or(faces.planes[face]);
            part.some = places_of(seen_.shifts().corrected(points[face]));
            Hypothesis one = hypotheses_[whole.hypothesis];
            one.shape = plate.planes[face];
            part.hypothesis = static_cast<std::uint32_t>(hypotheses_.size());
            hypotheses_.push_back(std::move(one));
            part.sampled = part_of_it(whole.sampled);
            part.edge = part_of_it(whole.edge);
            part.mixed = part_of_it(whole.mixed);
            plate.parts[face] = face == 0 ? plane.part : static_cast<std::uint32_t>(assigned_.parts.size());
            if (face == 0)
                assigned_.parts[plane.part] = std::move(part);
            else
                assigned_.parts.push_back(std::move(part));
        }
        for (const std::size_t face : {0, 1}) {
            plate.labels[face] = ++assigned_.next_number;
            assigned_.numbers.push_back({plate.labels[face] - 1, plate.parts[face]});
        }
        plates_.push_back(std::move(plate));
    }

    void give_labels(const Plate& plate)
    {
        points_.visit(grid_box(points_.tree(), plate.box), std::numeric_limits<std::uint16_t>::max(),
                      [&](const ChosenPoints::Some& some) {
                          options_.check();
                          give_labels(plate, some);
                      });
    }

    // Its own points, and those that belong to nothing.
    void give_labels(const Plate& plate, const ChosenPoints::Some& some)
    {
        const PointStations& stations = *seen_.shifts().stations;
        std::vector<std::uint32_t> labels = labels_.get(some.node);
        const auto is_wanted = [&](std::size_t k) {
            const std::uint32_t part = part_of(labels[some.number[k]]);
            return part == plate.part ||
                   (part == AssignedPoints::no_part && plate.outline.gap_to(some.at[k]) <= options_.spacing);
        };
        std::optional<Chunk> chunk;
        for (std::size_t k = 0; k < some.number.size(); ++k) {
            if (!is_wanted(k)) continue;
            if (!chunk) chunk = points_.tree().read_chunk(some.node, stations.columns());
            std::uint32_t& label = labels[some.number[k]];
            const auto seen = plate.face_of.find(stations.at(*chunk, some.number[k]));
            const bool is_near =
                seen != plate.face_of.end() && distance_to(plate.planes[seen->second], some.at[k]) <= plate.threshold;
            if (!is_near) {
                if (part_of(label) != AssignedPoints::no_part) label = 0;
                continue;
            }
            label = plate.labels[seen->second] | (label & interior_label);
            SurfacePart& face = assigned_.parts[plate.parts[seen->second]];
            ++face.points;
            face.box.extend(some.at[k]);
        }
        if (chunk) labels_.set_all(some.node, labels);
    }

    std::uint32_t part_of(std::uint32_t label) const
    {
        return label == 0 ? AssignedPoints::no_part : assigned_.part_of(label & ~interior_label);
    }

    const ChosenPoints& points_;
    const SeenPlanes& seen_;
    AssignedPoints& assigned_;
    std::vector<Hypothesis>& hypotheses_;
    PointLabels& labels_;
    const PlateOptions& options_;
    std::vector<Plate> plates_;
};

}  // namespace

void divide_plates(const ChosenPoints& points, const SeenPlanes& seen, AssignedPoints& assigned,
                   std::vector<Hypothesis>& hypotheses, PointLabels& labels, const PlateOptions& options)
{
    PlateDivision(points, seen, assigned, hypotheses, labels, options).run();
}

}  // namespace pcm

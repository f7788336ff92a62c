#include "pcm/place/station_survey.h"

#include "pcm/cloud/box_distance.h"
#include "pcm/cloud/numbers.h"
#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/place/station_reach.h"
#include "pcm/place/tuning.h"
#include "pcm/tree/source_rounding.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace pcm {
namespace {

using PatchMatrix = Eigen::MatrixXd;
using PatchVector = Eigen::VectorXd;

constexpr int most_agreeing_rounds = 8;
constexpr Eigen::Index surface_terms = 6;  // coefficients of a height of the second degree

struct StationPoint {
    Vec3d place{};
    std::uint32_t station = 0;
};

StationEvidence evidence_of(const StationPatch& patch)
{
    const std::size_t count = patch.stations.size(), columns = 3 * count;
    std::vector<double> whole(columns * columns), pulls(columns);
    for (std::size_t s = 0; s < count; ++s)
        for (std::size_t a = 0; a < 3; ++a) {
            pulls[3 * s + a] = patch.u[s] * patch.normal[a];
            for (std::size_t t = 0; t < count; ++t)
                for (std::size_t b = 0; b < 3; ++b)
                    whole[(3 * s + a) * columns + 3 * t + b] =
                        patch.h[s * count + t] * patch.normal[a] * patch.normal[b];
        }
    StationEvidence evidence;
    evidence.add(patch.stations, whole, pulls, patch.noise);
    return evidence;
}

// The frame of a patch: its middle, and its axes, the normal last; false where the points do not lie along a surface.
bool frame_of(const std::vector<StationPoint>& points, Vec3d& middle, std::array<Vec3d, 3>& axes, double& size)
{
    middle = {};
    for (const StationPoint& p : points) middle = middle + (p.place - points.front().place);
    middle = points.front().place + middle / static_cast<double>(points.size());
    SquareMatrix<3> moments{};
    for (const StationPoint& p : points) {
        const Vec3d d = p.place - middle;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) moments[a][b] += d[a] * d[b];
    }
    const Eigensystem<3> system = eigensystem<3>(moments);
    const PatchTuning& tuned = place_tuning().patches;
    if (!(system.values[2] > 0) || system.values[1] < tuned.min_width * system.values[2] ||
        system.values[0] > tuned.max_thickness * system.values[1])
        return false;
    for (std::size_t k = 0; k < 3; ++k)
        axes[2 - k] = {system.vectors[k][0], system.vectors[k][1], system.vectors[k][2]};
    size = std::sqrt(system.values[2] / static_cast<double>(points.size()));
    return true;
}

// Points of stations that see the same surface have neighbours of each other's.
void count_mixed(const std::vector<std::array<double, 2>>& places, const std::vector<StationPoint>& points,
                 StationPatch& patch)
{
    const auto n = static_cast<double>(points.size());
    std::map<std::uint32_t, std::size_t> counts;
    for (std::size_t i = 0; i < points.size(); ++i) {
        double nearest = infinity;
        std::uint32_t station = points[i].station;
        for (std::size_t j = 0; j < points.size(); ++j) {
            if (j == i) continue;
            const double dx = places[j][0] - places[i][0], dy = places[j][1] - places[i][1], away = dx * dx + dy * dy;
            if (away < nearest) nearest = away, station = points[j].station;
        }
        patch.mixed += station != points[i].station;
        ++counts[points[i].station];
    }
    for (const auto& [station, count] : counts)
        patch.mixed_by_chance += static_cast<double>(count) * (n - static_cast<double>(count)) / (n - 1);
}

// False unless the points are a smooth surface that this many stations see all of. `mixed` is set where they lie along
// any surface.
bool patch_of(std::vector<StationPoint> points, std::size_t fewest, StationPatch& patch)
{
    const PatchTuning& tuned = place_tuning().patches;
    std::map<std::uint32_t, std::size_t> counts;
    for (const StationPoint& p : points) ++counts[p.station];
    for (const auto& [station, count] : counts)
        if (count >= tuned.min_station_points) patch.stations.push_back(station);
    if (patch.stations.size() < fewest) return false;
    const auto number = [&](std::uint32_t station) {
        const auto at = std::lower_bound(patch.stations.begin(), patch.stations.end(), station);
        return at != patch.stations.end() && *at == station ? at - patch.stations.begin() : -1;
    };
    points.erase(
        std::remove_if(points.begin(), points.end(), [&](const StationPoint& p) { return number(p.station) < 0; }),
        points.end());
    Vec3d middle;
    std::array<Vec3d, 3> axes;
    double size = 0;
    if (points.size() < tuned.min_points || !frame_of(points, middle, axes, size)) return false;
    patch.normal = axes[2];
    const auto n = static_cast<Eigen::Index>(points.size()),
               stations = static_cast<Eigen::Index>(patch.stations.size());
    PatchMatrix terms(n, surface_terms), of_station = PatchMatrix::Zero(n, stations);
    PatchVector heights(n);
    std::vector<std::array<double, 2>> places;
    for (Eigen::Index i = 0; i < n; ++i) {
        const StationPoint& p = points[static_cast<std::size_t>(i)];
        const Vec3d d = p.place - middle;
        const double x = dot(axes[0], d) / size, y = dot(axes[1], d) / size;
        terms.row(i) << 1, x, y, x * x, x * y, y * y;
        of_station(i, number(p.station)) = 1;
        heights[i] = dot(axes[2], d);
        places.push_back({x, y});
    }
    if (fewest > 1) count_mixed(places, points, patch);
    PatchMatrix normal = terms.transpose() * terms;
    normal.diagonal().array() += 1e-9 * static_cast<double>(n);
    const Eigen::LDLT<PatchMatrix> solver(normal);
    const PatchMatrix h = of_station.transpose() * of_station -
                          of_station.transpose() * terms * solver.solve(terms.transpose() * of_station);
    // Stations that see different parts of it differ by what is assumed of the surface between them.
    const PatchVector counts_of = of_station.colwise().sum();
    if (h.trace() < tuned.min_overlap * (static_cast<double>(n) - counts_of.squaredNorm() / static_cast<double>(n)))
        return false;
    const PatchVector u =
        of_station.transpose() * heights - of_station.transpose() * terms * solver.solve(terms.transpose() * heights);
    patch.h.assign(h.data(), h.data() + h.size());  // symmetric
    patch.u.assign(u.data(), u.data() + u.size());
    PatchMatrix joint(n, surface_terms + stations);
    joint << terms, of_station;
    PatchMatrix products = joint.transpose() * joint;
    products.diagonal().array() += 1e-9 * static_cast<double>(n);  // one column depends on the others
    const PatchVector left = heights - joint * products.ldlt().solve(joint.transpose() * heights);
    const auto freedom = static_cast<double>(n - surface_terms - stations + 1);
    if (!(freedom >= 8)) return false;
    patch.noise = left.norm() / std::sqrt(freedom);
    return patch.noise > 0;
}

class Survey {
public:
    Survey(const Tree& tree, const PointStations& stations)
        : tree_(tree), stations_(stations), rounding_(tree.info()), reach_(tree.info().bounds().centre())
    {
    }

    StationSurvey run(const Vec3d& place)
    {
        for (const NodeId root : tree_.part_roots())
            if (root != no_node) gather(root, place);
        std::sort(views_.begin(), views_.end(),
                  [](const View& a, const View& b) { return a.box.diagonal() < b.box.diagonal(); });
        for (const View& view : views_) {
            look_at(view);
            if (is_enough()) break;
        }
        const PatchTuning& tuned = place_tuning().patches;
        const bool mix =
            seen_by_chance_ >= tuned.min_seen * mixed_by_chance_ && mixed_ >= tuned.min_mixed * seen_by_chance_;
        const bool is_shown = stations_.are_stated() || mixed_by_chance_ >= tuned.enough_by_chance;
        return {smooth_patches(), stations_.are_stated() || !is_shown || mix, is_shown, reach_.reach()};
    }

private:
    // A node's box, and those of the points that are as dense in all of it: of the node and of the nodes above it.
    struct View {
        Box3d box;
        std::size_t begin = 0, end = 0;
    };

    // The chunks from a part's root to the leaf at the place.
    void gather(NodeId node, const Vec3d& place)
    {
        const std::size_t begin = points_.size();
        for (; node != no_node;) {
            const bool is_root = points_.size() == begin;
            read(node);
            for (std::size_t i = begin; is_root && i < points_.size(); ++i)
                reach_.add(points_[i].place, points_[i].station);
            views_.push_back({tree_.box(node), begin, points_.size()});
            NodeId next = no_node;
            double best = infinity;
            for (const NodeId child : tree_.node(node).children) {
                if (child == no_node) continue;
                const double away = squared_distance(tree_.box(child), place);
                if (away < best) best = away, next = child;
            }
            node = next;
        }
    }

    void read(NodeId node)
    {
        const Chunk chunk = tree_.read_chunk(node, stations_.columns());
        for (std::uint32_t i = 0; i < chunk.points; ++i)
            points_.push_back(
                {rounding_(tree_.info().grid.to_source(chunk.positions->grid(i))), stations_.at(chunk, i)});
    }

    // Cubes that hold about the wanted number of points where they are on a surface.
    void look_at(const View& view)
    {
        const PatchTuning& tuned = place_tuning().patches;
        const Box3d& box = view.box;
        std::vector<StationPoint> inside;
        for (std::size_t i = view.begin; i < view.end; ++i)
            if (box.contains(points_[i].place)) inside.push_back(points_[i]);
        thin(inside);
        if (inside.size() < tuned.cube_points) return;
        double edge = box.diagonal() / 16;
        // The points of a cube on a surface grow with the square of its edge.
        for (int round = 0; round < 3; ++round)
            edge *= std::clamp(std::sqrt(static_cast<double>(tuned.cube_points) / held(inside, box.min, edge)),
                               1.0 / 64, 4.0);
        const std::vector<CubePoint> order = divided(inside, box.min, edge);
        for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
            std::vector<StationPoint> in_cube;
            for (end = begin; end < order.size() && order[end].first == order[begin].first; ++end)
                in_cube.push_back(inside[order[end].second]);
            StationPatch patch;
            const bool shows = in_cube.size() <= tuned.max_points && patch_of(in_cube, fewest_stations(), patch);
            mixed_by_chance_ += patch.mixed_by_chance;
            if (!shows) continue;
            mixed_ += patch.mixed;
            seen_by_chance_ += patch.mixed_by_chance;
            patches_.push_back(std::move(patch));
        }
    }

    static void thin(std::vector<StationPoint>& points)
    {
        const std::size_t step = points.size() / place_tuning().patches.box_points + 1;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < points.size(); i += step) points[kept++] = points[i];
        points.resize(kept);
    }

    // Points with their cubes, cube by cube.
    using CubePoint = std::pair<std::uint64_t, std::uint32_t>;
    static std::vector<CubePoint> divided(const std::vector<StationPoint>& points, const Vec3d& corner, double edge)
    {
        std::vector<CubePoint> order;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            const Vec3d d = (points[i].place - corner) / edge;
            std::uint64_t key = 0;
            for (const double along : d) key = key << 21 | (static_cast<std::uint64_t>(along) & 0x1fffff);
            order.emplace_back(key, i);
        }
        std::sort(order.begin(), order.end());
        return order;
    }

    // The number of points in the cube of a point, on average.
    static double held(const std::vector<StationPoint>& points, const Vec3d& corner, double edge)
    {
        const std::vector<CubePoint> order = divided(points, corner, edge);
        double sum = 0;
        for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
            for (end = begin; end < order.size() && order[end].first == order[begin].first;) ++end;
            sum += static_cast<double>((end - begin) * (end - begin));
        }
        return sum / static_cast<double>(points.size());
    }

    std::size_t fewest_stations() const { return stations_.source() == StationSource::none ? 1 : 2; }

    bool is_enough() const
    {
        std::set<std::uint32_t> stations;
        for (const StationPatch& patch : patches_) stations.insert(patch.stations.begin(), patch.stations.end());
        return patches_.size() >= place_tuning().patches.enough &&
               (fewest_stations() == 1 || stations.size() >= place_tuning().patches.enough_stations);
    }

    std::vector<StationPatch> smooth_patches() const
    {
        std::vector<StationPatch> smooth;
        if (patches_.empty()) return smooth;
        std::vector<double> noises;
        for (const StationPatch& patch : patches_) noises.push_back(patch.noise);
        const auto quarter = noises.begin() + static_cast<std::ptrdiff_t>(noises.size() / 4);
        std::nth_element(noises.begin(), quarter, noises.end());
        for (const StationPatch& patch : patches_)
            if (patch.noise <= place_tuning().patches.max_noise * *quarter) smooth.push_back(patch);
        return smooth;
    }

    const Tree& tree_;
    const PointStations& stations_;
    const SourceRounding rounding_;
    StationReach reach_;
    std::vector<StationPoint> points_;
    std::vector<View> views_;
    std::vector<StationPatch> patches_;
    double mixed_by_chance_ = 0;             // sum over all patches
    double mixed_ = 0, seen_by_chance_ = 0;  // sums over patches that stations see all of
};

std::size_t direction_of(const StationPart& part)
{
    const Vec3d& n = part.normal;
    std::size_t largest = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (std::fabs(n[a]) > std::fabs(n[largest])) largest = a;
    return largest;
}

double median_of(std::vector<double> values)
{
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Whether each deviates from the shifts by no more than a few medians of the deviations of parts with similar normals.
std::vector<bool> agreeing_with(const StationSpread& found, const std::vector<StationPart>& parts, double most)
{
    std::vector<double> deviations;
    std::array<std::vector<double>, 3> alike;
    for (const StationPart& part : parts) {
        deviations.push_back(part.evidence.deviation_from(found.shifts));
        alike[direction_of(part)].push_back(deviations.back());
    }
    const double largest = place_tuning().patches.max_unlike * median_of(deviations);
    std::array<double, 3> usual{};
    for (std::size_t a = 0; a < 3; ++a) usual[a] = std::min(median_of(alike[a]), largest);
    std::vector<bool> agrees;
    for (std::size_t i = 0; i < parts.size(); ++i)
        agrees.push_back(deviations[i] <= most * usual[direction_of(parts[i])]);
    return agrees;
}

}  // namespace

StationEvidence agreeing_evidence(const StationEvidence& known, const std::vector<StationPart>& parts)
{
    if (parts.empty()) return known;
    const PatchTuning& tuned = place_tuning().patches;
    // The two faces of a plate, each seen by other stations, are farther apart than most registrations leave stations.
    std::vector<bool> agrees = agreeing_with(known.spread(), parts, tuned.max_first_deviation);
    StationEvidence evidence;
    for (int round = 0; round < most_agreeing_rounds; ++round) {
        evidence = known;
        for (std::size_t i = 0; i < parts.size(); ++i)
            if (agrees[i]) evidence.add(parts[i].evidence);
        const std::vector<bool> now = agreeing_with(evidence.spread(), parts, tuned.max_deviation);
        if (now == agrees) break;
        agrees = now;
    }
    return evidence;
}

std::vector<StationPart> StationSurvey::parts() const
{
    std::vector<StationPart> parts;
    for (const StationPatch& patch : patches) parts.push_back({evidence_of(patch), patch.normal});
    return parts;
}

double StationSurvey::noise() const
{
    std::vector<double> noises;
    for (const StationPatch& patch : patches) noises.push_back(patch.noise);
    return median_of(noises);
}

StationEvidence StationSurvey::evidence(const StationEvidence& known) const
{
    return agreeing_evidence(known, parts());
}

StationSurvey station_survey(const Tree& tree, const PointStations& stations, const Vec3d& place)
{
    return Survey(tree, stations).run(place);
}

bool name_stations(const std::vector<StationSurvey>& places)
{
    int votes = 0;
    for (const StationSurvey& one : places)
        if (one.is_shown) votes += one.names_stations ? 1 : -1;
    return votes >= 0;
}

StationsElsewhere stations_elsewhere(const Tree& tree, const PointStations& stations)
{
    std::vector<NodeId> leaves;
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        const auto& children = tree.node(node).children;
        const bool is_leaf =
            std::all_of(children.begin(), children.end(), [](NodeId child) { return child == no_node; });
        if (is_leaf && tree.node(node).points > 0) leaves.push_back(node);
    }
    const std::size_t count = place_tuning().patches.places_elsewhere;
    StationsElsewhere found;
    if (leaves.size() <= count) return found;  // they would be the same again
    std::vector<StationSurvey> places;
    for (std::size_t i = 0; i < count; ++i)
        places.push_back(
            station_survey(tree, stations, tree.box(leaves[(2 * i + 1) * leaves.size() / (2 * count)]).centre()));
    found.names_stations = name_stations(places);
    double squares = 0;
    for (const StationSurvey& one : places) {
        const StationSpread spread = one.evidence().spread();
        squares += spread.freedom * spread.spread * spread.spread;
        found.freedom += spread.freedom;
    }
    if (found.freedom > 0) found.spread = std::sqrt(squares / found.freedom);
    return found;
}

}  // namespace pcm

// What a lasso takes of the front: against a depth buffer of all points one by one, and of two walls the nearer one.

#include "pcm/select/front_points.h"

#include "pcm/system/error.h"
#include "pcm/tree/point_size.h"
#include "tests/sanitizers.h"
#include "tests/select/cloud_of_points.h"

#include <cmath>
#include <map>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

// Looks along -back from `eye`, which is relative to the origin; in perspective or not.
Camera look(const Vec3d& origin, const Vec3d& eye, const Vec3d& back, bool perspective, double scale)
{
    Camera camera;
    camera.origin = origin;
    camera.width = 200;
    camera.height = 150;
    const Vec3d right = normalised(cross({0, 0, 1}, back)), up = cross(back, right);
    const std::array<Vec3d, 3> rows{right, up, back};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t a = 0; a < 3; ++a) camera.modelview[a * 4 + r] = scale * rows[r][a];
        camera.modelview[12 + r] = -scale * dot(rows[r], eye);
    }
    camera.modelview[15] = 1;
    const double near = 0.1 * scale, far = 1000 * scale;
    if (perspective) {
        camera.projection[0] = 1.5, camera.projection[5] = 2, camera.projection[11] = -1;
        camera.projection[10] = (far + near) / (near - far), camera.projection[14] = 2 * far * near / (near - far);
    } else {
        camera.projection[0] = 0.015 / scale, camera.projection[5] = 0.02 / scale, camera.projection[15] = 1;
        camera.projection[10] = -2 / (far + 1000 * scale), camera.projection[14] = 0;
    }
    return camera;
}

class FrontPoints : public CloudOfPoints {
protected:
    struct Splat {
        double x, y, depth, size, least, radius;
        bool drawn;
    };
    Splat splat(const Camera& camera, const KnownPoint& point) const
    {
        const Vec3d d = point.position - camera.origin;
        double e[4] = {0, 0, 0, 1}, c[4];
        for (std::size_t r = 0; r < 3; ++r)
            e[r] = camera.modelview[r] * d[0] + camera.modelview[4 + r] * d[1] + camera.modelview[8 + r] * d[2] +
                   camera.modelview[12 + r];
        for (std::size_t r = 0; r < 4; ++r)
            c[r] = camera.projection[r] * e[0] + camera.projection[4 + r] * e[1] + camera.projection[8 + r] * e[2] +
                   camera.projection[12 + r];
        const double scale = std::hypot(camera.modelview[0], camera.modelview[1], camera.modelview[2]);
        const double pixels = camera.projection[5] * camera.height / 2 / c[3];
        const double size =
            scale * point_size(sizes_.at({point.node, point.number}), least_point_size(tree_->info().grid));
        Splat s{};
        s.x = (c[0] / c[3] + 1) * 100;
        s.y = (c[1] / c[3] + 1) * 75;
        s.depth = -e[2];
        s.size = std::max(size, 0.5 / pixels);
        s.least = 1.5 / pixels;
        s.drawn = c[3] > 0 && std::fabs(c[2]) <= c[3];
        s.radius = std::min(64.0, s.size * pixels);
        return s;
    }
    // Counts points on which the slow way and the fast one agree; those at the very edge of a decision may differ.
    void check(const Camera& camera, const std::vector<Vec2d>& corners, const FrontOptions& options)
    {
        std::map<std::pair<int, int>, double> depths;
        const auto lower = [&](int x, int y, double depth) {
            const auto [at, is_new] = depths.try_emplace({x, y}, depth);
            if (!is_new) at->second = std::min(at->second, depth);
        };
        const auto shown = [&](const KnownPoint& p) { return options.shown.where.empty() || p.classification < 16; };
        for (const KnownPoint& p : points_) {
            const Splat s = splat(camera, p);
            if (!s.drawn || !shown(p)) continue;
            lower(int(std::floor(s.x)), int(std::floor(s.y)), s.depth);
            for (int y = int(s.y - s.radius) - 1; y <= s.y + s.radius; ++y)
                for (int x = int(s.x - s.radius) - 1; x <= s.x + s.radius; ++x) {
                    const double part = (std::pow(x + 0.5 - s.x, 2) + std::pow(y + 0.5 - s.y, 2)) / s.radius / s.radius;
                    if (part <= 1) lower(x, y, s.depth + s.size * part);
                }
        }
        const PointSet found = front_points(tree_, camera, corners, options);
        const Polygon polygon(corners);
        std::size_t in_lasso = 0;
        for (const KnownPoint& p : points_) {
            const Splat s = splat(camera, p);
            const bool in = s.drawn && shown(p) && polygon.contains(s.x / 100 - 1, s.y / 75 - 1);
            in_lasso += in;
            const bool wanted =
                in && s.x >= 0 && s.x < 200 && s.y >= 0 && s.y < 150 &&
                s.depth <= depths.at({int(std::floor(s.x)), int(std::floor(s.y))}) + options.tolerance * s.size;
            if (wanted != found.contains(p.node, p.number)) ++differences_;
            front_ += wanted;
        }
        behind_ += in_lasso;
        compared_ += points_.size();
    }
    void read_sizes()
    {
        ColumnSet columns;
        columns.sizes = true;
        for (NodeId node = 0; node < tree_->nodes().size(); ++node) {
            const Chunk chunk = tree_->read_chunk(node, columns);
            for (std::uint32_t i = 0; i < chunk.points; ++i) sizes_[{node, i}] = chunk.sizes->as<std::uint8_t>()[i];
        }
    }
    std::map<std::pair<NodeId, std::uint32_t>, std::uint8_t> sizes_;
    std::size_t differences_ = 0, front_ = 0, behind_ = 0, compared_ = 0;
};

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(FrontPoints, PCM_NOT_UNDER_THREAD(AreThoseOfADepthBufferOfAllPoints))
{
    make(Shape::volume, 9000);
    read_sizes();
    std::mt19937_64 random(1);
    for (int round = 0; round < 8; ++round) {
        const auto any = [&](double size) { return size * (static_cast<double>(random() % 2001) / 1000 - 1); };
        const Vec3d back = normalised({any(1), any(1), any(0.7)});
        const double away = round % 4 == 3 ? 20 : 150;  // or among the points
        const Camera camera = look(middle(), away * back, back, round % 2 == 0, round % 3 ? 1 : 0.01);
        std::vector<Vec2d> corners;
        for (std::size_t n = 3 + random() % 5; n > 0; --n) corners.push_back({any(1.2), any(1.2)});
        FrontOptions options;
        options.tolerance = round % 5;
        options.select.threads = 1 + round % 3;
        if (round % 4 == 1) options.shown.where.push_back(parse_condition("classification<16"));
        check(camera, corners, options);
    }
    EXPECT_LE(differences_, 2u);  // rounding, where a point is on the border of a pixel
    EXPECT_GT(front_, 400u);
    EXPECT_GT(behind_, 2 * front_);
}

// Two dense walls, one behind the other, at map coordinates.
TEST_F(FrontPoints, OfTwoWallsTheNearerOneIsTaken)
{
    std::vector<LasRecord> walls = records(Shape::surface, 40000, 1);
    for (std::size_t i = 0; i < walls.size(); ++i) {
        LasRecord& p = walls[i];
        const std::int32_t x = p.x / 10, z = p.y / 10;  // 10 m wide, 6 m high
        p.x = x, p.z = z, p.y = i % 2 ? 0 : 3000, p.classification = i % 2;
    }
    Grid grid;
    grid.scale = {0.001, 0.001, 0.001};
    grid.offset = {512345, 4812345, 100};
    write_las(folder_ / "a.las", walls, grid);
    BuildOptions build;
    build.chunk_points = 1000;
    build_tree({folder_ / "a.las"}, path(), build);
    read();
    for (const bool perspective : {true, false}) {
        // From the front, half from above, and at a flat angle.
        for (const Vec3d& back : {Vec3d{0, -1, 0}, Vec3d{0, -1, 0.4}, Vec3d{2, -1, 0.1}}) {
            const Vec3d away = normalised(back);
            const Camera camera = look({512350, 4812345, 103}, 15 * away, away, perspective, 1);
            const double half = perspective ? 0.1 : 0.02;  // within both walls, seen from anywhere
            const std::vector<Vec2d> corners{{-half, -half}, {half, -half}, {half, half}, {-half, half}};
            const PointSet front = front_points(tree_, camera, corners);
            const Region lasso = Region::lasso(camera.modelview, camera.projection, camera.origin, corners);
            std::size_t near = 0, nearer_taken = 0, far = 0, farther_taken = 0;
            for (const KnownPoint& p : points_) {
                if (!lasso.contains(p.position)) continue;
                const bool taken = front.contains(p.node, p.number);
                (p.classification == 1 ? near : far) += 1;
                (p.classification == 1 ? nearer_taken : farther_taken) += taken;
            }
            ASSERT_GT(near, 50u);
            ASSERT_GT(far, 50u);
            EXPECT_GE(static_cast<double>(nearer_taken), 0.99 * static_cast<double>(near)) << back[0] << perspective;
            EXPECT_LE(static_cast<double>(farther_taken), 0.01 * static_cast<double>(far)) << back[0] << perspective;
            // Without the nearer wall the farther one is in front.
            FrontOptions options;
            options.shown.where.push_back(parse_condition("classification=0"));
            EXPECT_GE(static_cast<double>(front_points(tree_, camera, corners, options).size()),
                      0.99 * static_cast<double>(far));
        }
    }
    Camera camera = look(middle(), {0, 0, 0}, {0, -1, 0}, true, 1);
    EXPECT_TRUE(front_points(tree_, camera, {{2, 2}, {3, 2}, {3, 3}}).empty());
    camera.width = 0;
    EXPECT_THROW(front_points(tree_, camera, {{0, 0}, {1, 0}, {1, 1}}), Error);
}

}  // namespace

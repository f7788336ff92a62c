// Splats by their formulas in double precision, and a picture of them to compare with.
#pragma once

#include "tests/gl/splat_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace pcm::test {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// A splat on the screen: coverage and depth at window coordinates; infinite where it does not cover.
using Splat = std::function<double(double x, double y)>;

struct Eye {
    Vec3d place{}, normal{};
    double depth = 0;
    double window[2]{};
    double focal[2]{};  // pixels per eye unit at the splat's depth
};

inline Eye eye_of(const Camera& view, const Disc& disc)
{
    Eye eye;
    const Matrix& m = view.modelview;
    const Matrix& p = view.projection;
    for (std::size_t r = 0; r < 3; ++r) {
        eye.place[r] = m[12 + r];
        for (std::size_t c = 0; c < 3; ++c) {
            eye.place[r] += m[c * 4 + r] * disc.centre[c];
            eye.normal[r] += m[c * 4 + r] * disc.normal[c];  // the modelview is a rotation
        }
    }
    eye.depth = -eye.place[2];
    const double w = p[11] == 0 ? 1 : eye.depth;
    const double size[2] = {double(view.width), double(view.height)};
    for (std::size_t a = 0; a < 2; ++a) {
        eye.window[a] = size[a] / 2 * ((p[a * 5] * eye.place[a] + p[8 + a] * eye.place[2] + p[12 + a]) / w + 1);
        eye.focal[a] = size[a] / 2 * p[a * 5] / w;
    }
    return eye;
}

struct ClipDepths {
    double near, far;
};
inline ClipDepths clip_of(const Camera& view)
{
    const Matrix& p = view.projection;
    if (p[11] == 0) return {(1 + p[14]) / p[10], (p[14] - 1) / p[10]};
    return {p[14] / (p[10] - 1), p[14] / (p[10] + 1)};
}

inline Splat square(const Camera& view, const Disc& disc, double side)
{
    const Eye eye = eye_of(view, disc);
    const ClipDepths clip = clip_of(view);
    return [=](double x, double y) {
        const bool inside = std::abs(x - eye.window[0]) <= side / 2 && std::abs(y - eye.window[1]) <= side / 2;
        return inside && eye.depth > clip.near && eye.depth < clip.far ? eye.depth : infinity;
    };
}

inline std::vector<DiscHit> picture_of(const Camera& view, const std::vector<Splat>& splats, double margin)
{
    std::vector<DiscHit> pixels;
    for (int row = 0; row < view.height; ++row)
        for (int column = 0; column < view.width; ++column) {
            DiscHit best;
            for (std::size_t s = 0; s < splats.size(); ++s) {
                const double depth = splats[s](column + 0.5, row + 0.5);
                for (int k = 0; k < 9 && margin > 0; ++k)
                    if ((splats[s](column + 0.5 + margin * (k % 3 - 1), row + 0.5 + margin * (k / 3 - 1)) < infinity) !=
                        (depth < infinity))
                        best.certain = false;
                if (!(depth < best.runner_up)) continue;
                best.runner_up = depth;
                if (depth < best.depth) {
                    std::swap(best.depth, best.runner_up);
                    best.disc = static_cast<std::int32_t>(s);
                }
            }
            pixels.push_back(best);
        }
    return pixels;
}

inline void expect_same(const Drawn& picture, const std::vector<DiscHit>& truth, const Camera& view, bool reversed,
                        std::size_t least_covered, double most_depth_error = 1e-5)
{
    std::size_t covered = 0, wrong = 0;
    double worst = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (!truth[i].certain) continue;
        const int seen = SplatScene::disc_of(picture.colours[i]);
        if (seen != truth[i].disc) {
            const bool tie =
                seen >= 0 && truth[i].disc >= 0 && truth[i].runner_up - truth[i].depth < 1e-4 * truth[i].depth;
            wrong += !tie;
            continue;
        }
        if (seen < 0) continue;
        ++covered;
        worst = std::max(worst, std::abs(depth_of(view, reversed, picture.depths[i]) / truth[i].depth - 1));
    }
    EXPECT_GE(covered, least_covered);
    EXPECT_EQ(wrong, 0u);
    EXPECT_LE(worst, most_depth_error);
}

}  // namespace pcm::test

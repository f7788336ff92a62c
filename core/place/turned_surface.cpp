#include "pcm/place/turned_surface.h"

#include "pcm/place/tuning.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <vector>

namespace pcm {
namespace {

using Key = std::array<std::int64_t, 3>;
using Products = Eigen::Matrix<double, 4, 4>;  // products of x, y, z and the distance from the shape
using Sums4 = Eigen::Matrix<double, 4, 1>;

enum class Pass : std::uint8_t { unknown, no, yes };

// Sums over points, relative to a place.
struct Moments {
    std::uint32_t points = 0;
    Sums4 sums = Sums4::Zero();
    Products products = Products::Zero();

    // Others, relative to a place that is `offset` away from this one's.
    void add(const Moments& other, const Sums4& offset)
    {
        const double n = other.points;
        products += other.products + offset * other.sums.transpose() + other.sums * offset.transpose() +
                    n * offset * offset.transpose();
        sums += other.sums + n * offset;
        points += other.points;
    }
};

// Cubes in bricks of 4 x 4 x 4: a block of 27 cubes touches eight bricks at most, and neighbouring blocks the same
// ones.
struct Brick {
    Key key{};
    std::array<std::uint32_t, 64> cubes{};  // number of each one's moments, from 1; 0: no points
    std::array<Pass, 64> passes{};
};

// Bricks by their keys: open addressing in a table that is at most half full. Pointers to bricks stay valid.
class Bricks {
public:
    Brick& operator[](const Key& key)
    {
        std::size_t slot = slot_of(key);
        if (slots_[slot] > 0) return bricks_[slots_[slot] - 1];
        if (2 * bricks_.size() >= slots_.size()) {
            widen();
            slot = slot_of(key);
        }
        bricks_.emplace_back().key = key;
        slots_[slot] = static_cast<std::uint32_t>(bricks_.size());
        return bricks_.back();
    }
    const Brick* find(const Key& key) const
    {
        const std::uint32_t number = slots_[slot_of(key)];
        return number > 0 ? &bricks_[number - 1] : nullptr;
    }

private:
    // The slot of a key, or the empty one where it belongs.
    std::size_t slot_of(const Key& key) const
    {
        std::uint64_t hash = 0;
        for (const std::int64_t k : key) hash = (hash ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15u;
        std::size_t slot = static_cast<std::size_t>(hash ^ (hash >> 32)) & (slots_.size() - 1);
        while (slots_[slot] > 0 && bricks_[slots_[slot] - 1].key != key) slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }
    void widen()
    {
        slots_.assign(2 * slots_.size(), 0);
        for (std::size_t i = 0; i < bricks_.size(); ++i)
            slots_[slot_of(bricks_[i].key)] = static_cast<std::uint32_t>(i + 1);
    }

    std::vector<std::uint32_t> slots_ = std::vector<std::uint32_t>(256);  // numbers of bricks, from 1; 0: empty
    std::deque<Brick> bricks_;
};

class BlockJudge final : public SurroundingsTest::Judge {
public:
    BlockJudge(const Shape& shape, double edge, double angle, const Vec3d& corner)
        : shape_(shape), edge_(edge), angle_(angle), corner_(corner)
    {
    }

    void add(const Vec3d& p) override
    {
        const Key key = key_of(p);
        const Vec3d d = p - middle_of(key);
        const Sums4 v(d[0], d[1], d[2], signed_distance(shape_, p));
        std::uint32_t& number = brick_of(key).cubes[place_in_brick(key)];
        if (number == 0) {
            moments_.emplace_back();
            number = static_cast<std::uint32_t>(moments_.size());
        }
        Moments& cube = moments_[number - 1];
        ++cube.points;
        cube.sums += v;
        cube.products += v * v.transpose();
    }

    bool passes(const Vec3d& p) override
    {
        const Key key = key_of(p);
        Pass& known = brick_of(key).passes[place_in_brick(key)];
        if (known == Pass::unknown) known = is_turned(key) ? Pass::no : Pass::yes;
        return known == Pass::yes;
    }

private:
    Key key_of(const Vec3d& p) const
    {
        Key key{};
        for (std::size_t a = 0; a < 3; ++a)
            key[a] = static_cast<std::int64_t>(std::clamp(std::floor((p[a] - corner_[a]) / edge_), -1e15, 1e15));
        return key;
    }
    static Key brick_key(const Key& key) { return {key[0] >> 2, key[1] >> 2, key[2] >> 2}; }
    static std::size_t place_in_brick(const Key& key)
    {
        return static_cast<std::size_t>((key[0] & 3) | (key[1] & 3) << 2 | (key[2] & 3) << 4);
    }
    Brick& brick_of(const Key& key)
    {
        const Key wanted = brick_key(key);
        if (brick_ && wanted == last_) return *brick_;
        brick_ = &bricks_[wanted];
        last_ = wanted;
        return *brick_;
    }
    Vec3d middle_of(const Key& key) const
    {
        Vec3d middle{};
        for (std::size_t a = 0; a < 3; ++a) middle[a] = corner_[a] + (static_cast<double>(key[a]) + 0.5) * edge_;
        return middle;
    }

    // Moments of the cubes around a key and its own, relative to its middle.
    Moments block_of(const Key& key) const
    {
        const Key first = brick_key({key[0] - 1, key[1] - 1, key[2] - 1});
        const Key last = brick_key({key[0] + 1, key[1] + 1, key[2] + 1});
        std::array<const Brick*, 8> bricks{};
        for (std::size_t k = 0; k < 8; ++k) {
            const Key wanted{k & 1 ? last[0] : first[0], k & 2 ? last[1] : first[1], k & 4 ? last[2] : first[2]};
            const bool is_again =
                (k & 1 && first[0] == last[0]) || (k & 2 && first[1] == last[1]) || (k & 4 && first[2] == last[2]);
            if (is_again) continue;
            bricks[k] = bricks_.find(wanted);
        }
        Moments block;
        for (std::int64_t n = 0; n < 27; ++n) {
            const Key step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
            const Key cube{key[0] + step[0], key[1] + step[1], key[2] + step[2]};
            std::size_t k = 0;
            for (std::size_t a = 0; a < 3; ++a) k |= (cube[a] >> 2 != first[a] ? std::size_t(1) << a : 0);
            const std::uint32_t number = bricks[k] ? bricks[k]->cubes[place_in_brick(cube)] : 0;
            if (number == 0) continue;
            block.add(moments_[number - 1], edge_ * Sums4(static_cast<double>(step[0]), static_cast<double>(step[1]),
                                                          static_cast<double>(step[2]), 0));
        }
        return block;
    }

    bool is_turned(const Key& key) const
    {
        const Moments block = block_of(key);
        if (block.points < tuned_.min_block_points) return false;
        const double n = block.points;
        const Sums4 mean = block.sums / n;
        const Products spread = block.products / n - mean * mean.transpose();
        const Vec3d middle = middle_of(key) + Vec3d{mean[0], mean[1], mean[2]};
        const AxisFrame frame(normal_at(shape_, middle));
        Eigen::Matrix<double, 3, 4> to_shape = Eigen::Matrix<double, 3, 4>::Zero();
        for (int a = 0; a < 3; ++a) {
            to_shape(0, a) = frame.u[static_cast<std::size_t>(a)];
            to_shape(1, a) = frame.v[static_cast<std::size_t>(a)];
        }
        to_shape(2, 3) = 1;
        const Eigen::Matrix3d on_shape = to_shape * spread * to_shape.transpose();
        if (is_surely_level(on_shape)) return false;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(on_shape);
        const double least = std::max(axes.eigenvalues()[0], 0.0), next = axes.eigenvalues()[1];
        if (!(next > 1e-6 * axes.eigenvalues()[2])) return false;
        const double angle = std::acos(std::min(1.0, std::fabs(axes.eigenvectors()(2, 0))));
        return angle > angle_ + tuned_.deviations * std::sqrt(least / (next * n));
    }

    // A bound on the angle without the eigenvectors. With the covariance A along the shape, b of that with the
    // distance, and the variance c of the distance, the plane's slope is |(A - l I)^-1 b| <= |b| / (a - l), where a is
    // A's least eigenvalue and the least one of all, l, at most c. Rounding is far below the factor 0.999.
    bool is_surely_level(const Eigen::Matrix3d& m) const
    {
        const double half = (m(0, 0) + m(1, 1)) / 2;
        const double least = half - std::hypot((m(0, 0) - m(1, 1)) / 2, m(1, 0));
        return angle_ < pi / 2 && std::hypot(m(2, 0), m(2, 1)) < 0.999 * std::tan(angle_) * (least - m(2, 2));
    }

    const Shape shape_;
    const double edge_, angle_;
    const Vec3d corner_;
    const TurnedTuning& tuned_ = place_tuning().turned;
    std::vector<Moments> moments_;
    Bricks bricks_;
    // Brick of the last point: the next one is mostly in the same.
    Brick* brick_ = nullptr;
    Key last_{};
};

}  // namespace

TurnedSurface::TurnedSurface(const Shape& shape, double threshold, double edge, double angle, const TreeInfo& tree)
    : shape_(shape),
      edge_(edge),
      angle_(angle),
      corner_(tree.bounds().min),
      near_(shape, std::max(threshold, place_tuning().turned.counted * edge), pi, tree.schema)
{
    if (!(angle > 0))
        throw Error(ErrorCode::invalid_argument, {},
                    "the largest angle between the shape and the surface of points is " + exact(angle) +
                        " radians; it is positive, and pi / 2 or more where they are not compared");
}

double TurnedSurface::edge_for(double step, double noise)
{
    return std::max(step / 3, place_tuning().turned.cube_noises * noise);
}

bool TurnedSurface::is_shown_on(const Shape& shape, double threshold, double edge)
{
    const double narrowest = narrowest_radius(shape);
    return threshold > place_tuning().thin_pipes.max_threshold * narrowest ||
           narrowest >= place_tuning().turned.min_shown * edge;
}

std::unique_ptr<SurroundingsTest::Judge> TurnedSurface::judge() const
{
    return std::make_unique<BlockJudge>(shape_, edge_, angle_, corner_);
}

}  // namespace pcm

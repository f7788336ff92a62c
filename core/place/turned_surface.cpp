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
#include <unordered_map>

namespace pcm {
namespace {

using Key = std::array<std::int64_t, 3>;
using Products = Eigen::Matrix<double, 4, 4>;  // products of x, y, z and the distance from the shape
using Sums4 = Eigen::Matrix<double, 4, 1>;

struct Hash {
    std::size_t operator()(const Key& key) const
    {
        std::uint64_t hash = 0;
        for (const std::int64_t k : key) hash = (hash ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15u;
        return static_cast<std::size_t>(hash ^ (hash >> 32));
    }
};

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
        if (!cube_ || key != cube_key_) cube_ = &cubes_[key];
        cube_key_ = key;
        ++cube_->points;
        cube_->sums += v;
        cube_->products += v * v.transpose();
    }

    bool passes(const Vec3d& p) override
    {
        const Key key = key_of(p);
        if (passed_ && key == passed_key_) return *passed_;
        const auto [known, is_new] = passing_.emplace(key, true);
        if (is_new) known->second = !is_turned(key);
        passed_ = &known->second;
        passed_key_ = key;
        return known->second;
    }

private:
    Key key_of(const Vec3d& p) const
    {
        Key key{};
        for (std::size_t a = 0; a < 3; ++a)
            key[a] = static_cast<std::int64_t>(std::clamp(std::floor((p[a] - corner_[a]) / edge_), -1e15, 1e15));
        return key;
    }
    Vec3d middle_of(const Key& key) const
    {
        Vec3d middle{};
        for (std::size_t a = 0; a < 3; ++a) middle[a] = corner_[a] + (static_cast<double>(key[a]) + 0.5) * edge_;
        return middle;
    }

    bool is_turned(const Key& key) const
    {
        Moments block;
        for (std::int64_t n = 0; n < 27; ++n) {
            const Key step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
            const auto found = cubes_.find({key[0] + step[0], key[1] + step[1], key[2] + step[2]});
            if (found == cubes_.end()) continue;
            block.add(found->second, edge_ * Sums4(static_cast<double>(step[0]), static_cast<double>(step[1]),
                                                   static_cast<double>(step[2]), 0));
        }
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
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(to_shape * spread * to_shape.transpose());
        const double least = std::max(axes.eigenvalues()[0], 0.0), next = axes.eigenvalues()[1];
        if (!(next > 1e-6 * axes.eigenvalues()[2])) return false;
        const double angle = std::acos(std::min(1.0, std::fabs(axes.eigenvectors()(2, 0))));
        return angle > angle_ + tuned_.deviations * std::sqrt(least / (next * n));
    }

    const Shape shape_;
    const double edge_, angle_;
    const Vec3d corner_;
    const TurnedTuning& tuned_ = place_tuning().turned;
    std::unordered_map<Key, Moments, Hash> cubes_;
    std::unordered_map<Key, bool, Hash> passing_;
    // Cubes of the last points: the next one is mostly in the same. Rehashing moves no element.
    Moments* cube_ = nullptr;
    const bool* passed_ = nullptr;
    Key cube_key_{}, passed_key_{};
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

std::unique_ptr<SurroundingsTest::Judge> TurnedSurface::judge() const
{
    return std::make_unique<BlockJudge>(shape_, edge_, angle_, corner_);
}

}  // namespace pcm

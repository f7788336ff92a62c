#include "pcm/place/station_reach.h"

#include <algorithm>
#include <cmath>

namespace pcm {

void StationReach::add(const Vec3d& p, std::uint32_t station)
{
    const Vec3d away = p - origin_;
    Seen& own = seen_[station];
    own.points += 1;
    own.squares += dot(away, away);
    own.sum = own.sum + away;
}

double StationReach::reach() const
{
    double points = 0, squares = 0;
    for (const auto& [station, own] : seen_) {
        points += own.points;
        squares += std::max(0.0, own.squares - dot(own.sum, own.sum) / own.points);
    }
    return points > 0 ? std::sqrt(3 * squares / points) : 0;
}

}  // namespace pcm

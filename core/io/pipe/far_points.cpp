#include "pcm/io/pipe/far_points.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

int exponent_of(double magnitude) { return magnitude > 0 ? std::ilogb(magnitude) : std::numeric_limits<int>::min(); }

}  // namespace

void FarPoints::Union::add(const Group& group)
{
    points += group.points;
    box.extend(group.box);
    places += group.places.size();
}

void FarPoints::watch(const PointBatch& batch)
{
    for (std::size_t i = 0; i < batch.size; ++i) {
        const Vec3d p{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
        if (is_finite(p)) watch(p);
    }
}

void FarPoints::watch(const Vec3d& p)
{
    const double magnitude = largest_magnitude(p);
    const int exponent = exponent_of(magnitude);
    if (!last_ || exponent != last_exponent_) {
        last_ = &groups_[exponent];  // a map's elements stay where they are
        last_exponent_ = exponent;
    }
    Group& group = *last_;
    if (group.points++ == 0) {
        group.least = magnitude;
        group.first = p;
        group.first_number = watched_;
    }
    ++watched_;
    group.least = std::min(group.least, magnitude);
    group.box.extend(p);
    box_.extend(p);
    if (group.places.size() > few_places) return;
    Place place{};
    for (std::size_t a = 0; a < 3 && magnitude > 0; ++a)
        place[a] = static_cast<std::int16_t>(std::lround(std::scalbn(p[a], 6 - exponent)));
    group.see(place);
}

void FarPoints::Group::see(const Place& place)
{
    if (places.size() <= few_places && std::find(places.begin(), places.end(), place) == places.end())
        places.push_back(place);
}

void FarPoints::merge(const FarPoints& later)
{
    for (const auto& [exponent, theirs] : later.groups_) {
        const auto [at, is_new] = groups_.try_emplace(exponent, theirs);
        Group& group = at->second;
        if (is_new) {
            group.first_number += watched_;
            continue;
        }
        group.points += theirs.points;
        group.box.extend(theirs.box);
        group.least = std::min(group.least, theirs.least);
        for (const Place& place : theirs.places) group.see(place);
    }
    box_.extend(later.box_);
    watched_ += later.watched_;
}

void FarPoints::save(ByteWriter& out) const
{
    out.put(watched_);
    out.put(static_cast<std::uint64_t>(groups_.size()));
    for (const auto& [exponent, group] : groups_) {
        out.put(static_cast<std::int32_t>(exponent));
        out.put(group.points);
        out.put(group.least);
        out.put(group.first_number);
        for (const Vec3d& p : {group.box.min, group.box.max, group.first})
            for (std::size_t a = 0; a < 3; ++a) out.put(p[a]);
        out.put(static_cast<std::uint8_t>(group.places.size()));
        for (const Place& place : group.places)
            for (const std::int16_t part : place) out.put(part);
    }
}

FarPoints FarPoints::load(ByteReader& in)
{
    FarPoints watched;
    watched.watched_ = in.get<std::uint64_t>();
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
        Group& group = watched.groups_[in.get<std::int32_t>()];
        group.points = in.get<std::uint64_t>();
        group.least = in.get<double>();
        group.first_number = in.get<std::uint64_t>();
        for (Vec3d* p : {&group.box.min, &group.box.max, &group.first})
            for (std::size_t a = 0; a < 3; ++a) (*p)[a] = in.get<double>();
        group.places.resize(in.get<std::uint8_t>());
        for (Place& place : group.places)
            for (std::int16_t& part : place) part = in.get<std::int16_t>();
        watched.box_.extend(group.box);
    }
    return watched;
}

double FarPoints::usual_magnitude() const
{
    const auto most = std::max_element(groups_.begin(), groups_.end(),
                                       [](const auto& a, const auto& b) { return a.second.points < b.second.points; });
    if (most == groups_.end() || most->second.box == Box3d{{0, 0, 0}, {0, 0, 0}}) return 0;
    return std::ldexp(1.0, most->first + 1);
}

double FarPoints::mean_spacing(const Box3d& box, std::uint64_t points)
{
    return points ? box.diagonal() / std::sqrt(static_cast<double>(points)) : 0;
}

std::optional<FarPoints::Finding> FarPoints::find(const Steps& steps) const
{
    std::vector<const Group*> groups;  // from the origin outwards
    std::vector<Union> inner;          // each group together with those before it
    for (const auto& [exponent, group] : groups_) {
        groups.push_back(&group);
        Union sum = inner.empty() ? Union() : inner.back();
        sum.add(group);
        inner.push_back(sum);
    }
    if (groups.empty()) return std::nullopt;
    Finding finding;
    std::size_t kept = groups.size();  // the first `kept` groups remain
    for (bool again = true; again;) {
        again = false;
        const double step = largest_magnitude(steps(inner[kept - 1].box));
        Union far;
        for (std::size_t k = kept - 1; k > 0; --k) {
            far.add(*groups[k]);
            const Union& near = inner[k - 1];
            const double diagonal = near.box.diagonal();
            const double spacing = mean_spacing(near.box, near.points);
            if (!(diagonal > 0) || !(step > spacing / 4)) continue;
            const bool few = far.places <= few_places || far.points <= near.points / 16 ||
                             (far.points <= near.points && step >= diagonal / 8);
            if (!few) continue;
            if (finding.points == 0) finding.step = step;
            finding.points += far.points;
            finding.spacing = spacing;
            kept = k;
            again = true;
            break;
        }
    }
    if (finding.points == 0) return std::nullopt;
    const Box3d& box = inner[kept - 1].box;
    const double largest = std::max(largest_magnitude(box.min), largest_magnitude(box.max));
    const Group* first = groups[kept];
    for (std::size_t k = kept; k < groups.size(); ++k)
        if (groups[k]->first_number < first->first_number) first = groups[k];
    finding.first = first->first;
    // A round number where there is one between the two.
    const double round = std::pow(10.0, std::ceil(std::log10(largest)));
    finding.limit = round >= largest && round < groups[kept]->least ? round : largest;
    return finding;
}

void FarPoints::refuse(const Steps& steps, const std::string& what) const
{
    const std::optional<Finding> found = find(steps);
    if (!found) return;
    throw Error(ErrorCode::invalid_argument, {},
                grouped(found->points) + " of " + grouped(watched_) +
                    " points lie too far from the others, such as that at " + exact(found->first) + ": " + what +
                    " that reaches them has steps of " + brief(found->step) + ", and the others are about " +
                    brief(found->spacing) + " apart",
                "if they are no-data values, " + way_to_leave_out(found->limit));
}

std::string way_to_leave_out(double limit)
{
    return "leave out points with coordinates beyond " + exact(limit) + ": --largest-coordinate " + exact(limit) +
           ", in MeshLab the parameter 'Largest coordinate'";
}

}  // namespace pcm

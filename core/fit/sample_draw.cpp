#include "pcm/fit/sample_draw.h"

#include "pcm/fit/tuning.h"

#include <algorithm>

namespace pcm {
namespace {

constexpr std::size_t most_ordered = 1000;

}  // namespace

SampleDraw::SampleDraw(const WorkingPoints& points, SampleNormals& normals, std::size_t sampled, bool progressive,
                       std::uint64_t seed)
    : points_(points), sampled_(sampled), random_(seed)
{
    if (!progressive || points.size() <= sampled) return;
    const std::size_t known = std::min(points.size(), most_ordered);
    std::vector<std::pair<double, std::uint32_t>> quality;
    // Points are in random order.
    for (std::size_t i = 0; i < known; ++i) quality.emplace_back(normals.unevenness(i), static_cast<std::uint32_t>(i));
    std::sort(quality.begin(), quality.end());
    for (const auto& entry : quality) order_.push_back(entry.second);
    part_ = sampled;
    expected_ = fit_tuning().sampling.even_samples;
    for (std::size_t i = 0; i < sampled; ++i)
        expected_ *= static_cast<double>(part_ - i) / static_cast<double>(order_.size() - i);
}

void SampleDraw::grow()
{
    const double n = static_cast<double>(part_), next = expected_ * (n + 1) / (n + 1 - static_cast<double>(sampled_));
    ++part_;
    until_ += std::ceil(next - expected_);
    expected_ = next;
}

bool SampleDraw::draw(std::size_t* sample)
{
    ++drawn_;
    const bool ordered = !order_.empty() && part_ < order_.size();
    if (ordered && drawn_ > until_) grow();
    std::size_t drawn = 0;
    if (ordered) sample[drawn++] = order_[part_ - 1];  // and others before it
    for (; drawn < sampled_; ++drawn) {
        sample[drawn] = ordered ? order_[random_.below(part_ - 1)] : random_.below(points_.size());
        if (std::find(sample, sample + drawn, sample[drawn]) != sample + drawn) return false;
    }
    return true;
}

}  // namespace pcm

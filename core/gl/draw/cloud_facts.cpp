#include "pcm/gl/draw/cloud_facts.h"

#include "pcm/gl/tuning.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pcm {
namespace {

bool is_one_grey(const Column& column)
{
    const std::size_t scalars = column.size() * column.components();
    for (std::size_t i = 0; i < column.size(); ++i)
        for (std::uint32_t c = 0; scalars && c < column.components(); ++c)
            if (column.value(i, c) != column.value(0)) return false;
    return true;
}

// Whether the differences from one value to the next are smaller than between values in any order, of which they are
// then by chance less than once in a thousand (von Neumann 1941). Points of a chunk are in Morton order: the next one
// is near.
bool varies_smoothly(const std::vector<double>& values)
{
    double sum = 0, squares = 0, steps = 0;
    const auto n = static_cast<double>(values.size());
    for (const double v : values) sum += v / n;
    for (std::size_t i = 0; i < values.size(); ++i) {
        squares += (values[i] - sum) * (values[i] - sum);
        if (i > 0) steps += (values[i] - values[i - 1]) * (values[i] - values[i - 1]);
    }
    if (!(squares > 0) || !std::isfinite(squares)) return false;
    return steps / squares < 2 * (1 - 3 / std::sqrt(n));
}

// Whether at least two classes that say what a point belongs to (LAS 1.4: not unclassified, noise or overlap) have a
// share of the sample each.
bool says_classes(const std::vector<double>& values)
{
    std::map<double, std::size_t> counts;
    for (const double v : values) ++counts[v];
    for (const double nothing : {0.0, 1.0, 7.0, 12.0, 18.0}) counts.erase(nothing);
    const std::size_t points = gl_tuning().sample.points_per_classified;
    return std::count_if(counts.begin(), counts.end(),
                         [&](const auto& entry) { return points * entry.second >= values.size(); }) >= 2;
}

// The first points of several columns, one after the other.
Column joined(const std::vector<std::pair<const Column*, std::size_t>>& parts)
{
    Column all(parts.front().first->type(), parts.front().first->components());
    std::size_t points = 0;
    for (const auto& [column, count] : parts) points += count;
    all.resize(points);
    std::byte* to = all.data();
    for (const auto& [column, count] : parts) {
        std::memcpy(to, column->data(), count * column->point_bytes());
        to += count * column->point_bytes();
    }
    return all;
}

}  // namespace

CloudFacts::CloudFacts(std::shared_ptr<PointCloud> cloud)
    : cloud_(std::move(cloud)), sample_(coarsest_chunks(*cloud_->tree()))
{
}

ColumnSet CloudFacts::columns_of(const Key& key)
{
    ColumnSet columns;
    columns.positions = std::get<ColourSource>(key) == ColourSource::none;
    if (!columns.positions) columns.attributes.set(std::get<1>(key));
    return columns;
}

CloudFact CloudFacts::fact_of(const Key& key, const Handles& chunks) const
{
    const TreeInfo& info = cloud_->info();
    const auto [source, place, component] = key;
    CloudFact fact;
    std::vector<double> values;
    std::vector<std::pair<const Column*, std::size_t>> parts;
    for (std::size_t s = 0; s < sample_.size(); ++s) {
        if (!chunks[s]) continue;
        const Chunk& chunk = *chunks[s];
        const std::size_t points = std::min(sample_[s].points, chunk.points);
        if (source == ColourSource::none) {
            for (std::size_t i = 0; i < points; ++i)
                values.push_back(info.grid.to_source(chunk.positions->grid(i, 2), 2));
            continue;
        }
        const Column& column = *chunk.attributes[place];
        const Attribute& attribute = info.schema[place];
        for (std::size_t i = 0; i < points; ++i)
            values.push_back(column.value(i, component) * attribute.scale + attribute.offset);
        parts.emplace_back(&column, points);
    }
    fact.has_shape = varies_smoothly(values);
    const bool is_classified = source != ColourSource::classification || says_classes(values);
    fact.values = summary_of(values);
    fact.is_blank = fact.values.is_constant() || !is_classified;
    fact.range = source == ColourSource::intensity ? balanced_range(fact.values) : linear_range(fact.values);
    if (source == ColourSource::rgb && !parts.empty()) {
        const Column all = joined(parts);
        fact.scale = ColourScale::of(all, ColourSource::rgb);
        fact.is_blank = is_one_grey(all);
    }
    // One point has nothing to differ from; its own colour is shown.
    fact.is_blank = fact.is_blank && info.points > 1;
    return fact;
}

const CloudFact* CloudFacts::known(ColourSource source, const AttributePlace& place) const
{
    const auto found = known_.find({source, place.attribute, place.component});
    return found == known_.end() ? nullptr : &found->second;
}

const CloudFact* CloudFacts::find(const CloudStyle& usable, const std::function<bool(NodeId)>& has_failed)
{
    const ColourTraits& traits = traits_of(usable.colour);
    const auto place = colour_place(usable, cloud_->info().schema);
    if (!place && traits.colouring != Colouring::height) return nullptr;
    const AttributePlace at = place.value_or(AttributePlace{});
    if (const CloudFact* const fact = known(traits.source, at)) return fact;

    const Key key{traits.source, at.attribute, at.component};
    if (asked_.count(key)) return nullptr;
    Handles chunks;
    bool complete = true, any = false;
    const auto held = held_.find(key);
    for (std::size_t s = 0; s < sample_.size(); ++s) {
        const SampledChunk& sampled = sample_[s];
        const bool is_held = held != held_.end() && held->second[s];
        chunks.push_back(is_held ? held->second[s] : cloud_->cache().find(sampled.node, columns_of(key)));
        any = any || chunks.back();
        complete = complete && (chunks.back() || has_failed(sampled.node));
    }
    if (!complete || (!any && !sample_.empty())) {
        asked_[key] = std::move(chunks);
        return nullptr;
    }
    asked_.erase(key);
    return &known_.emplace(key, fact_of(key, chunks)).first->second;
}

std::map<NodeId, ColumnSet> CloudFacts::missing(const std::function<bool(NodeId)>& has_failed)
{
    std::map<NodeId, ColumnSet> list;
    for (const auto& [key, chunks] : asked_)
        for (std::size_t s = 0; s < sample_.size(); ++s) {
            if (chunks[s] || has_failed(sample_[s].node)) continue;
            const auto [place, is_new] = list.try_emplace(sample_[s].node, columns_of(key));
            if (!is_new) place->second |= columns_of(key);
        }
    return list;
}

}  // namespace pcm

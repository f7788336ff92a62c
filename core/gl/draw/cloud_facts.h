// What the colours of a cloud depend on as a whole: the ranges of its values, found in its coarsest chunks. These are
// loaded like all others, so a fact is known some frames after it was asked for. No OpenGL here.
//
// GL thread only.
#pragma once

#include "pcm/gl/style/splat_style.h"
#include "pcm/point_cloud.h"
#include "pcm/view/point_colours.h"
#include "pcm/view/value_range.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

namespace pcm {

// Facts about one attribute, or about the heights.
struct CloudFact {
    ValueSummary values;    // as users see them; for rgb, the first component
    ColourScale scale;      // colours' scale, for rgb
    bool is_blank = false;  // all sampled points have the same value; for rgb, the same shade of grey: the default of
                            // many writers; for classes, fewer than two describe what points belong to
    // Neighbours' values differ less than those of any two points: they show surfaces and not noise alone.
    bool has_shape = true;
    // Balanced for intensities, else linear.
    ValueRange range;
};

class CloudFacts {
public:
    explicit CloudFacts(std::shared_ptr<PointCloud> cloud);

    // The fact that a usable style's attribute or, without one, its heights have; null while its chunks are being
    // loaded, and for a style without either. What is asked for after begin_frame() is missing() until it is known.
    // What was not known in a frame becomes known in the next one at the earliest: the style is chosen by it.
    void begin_frame()
    {
        held_ = std::move(asked_);
        asked_.clear();
    }
    const CloudFact* find(const CloudStyle& usable, const std::function<bool(NodeId)>& has_failed);
    // Columns to be loaded, without those of chunks that could not be loaded.
    std::map<NodeId, ColumnSet> missing(const std::function<bool(NodeId)>& has_failed);
    // Whether what was asked for is not known yet.
    bool lacks() const { return !asked_.empty(); }
    // What find() has found before, by attribute and component.
    const CloudFact* known(ColourSource source, const AttributePlace& place) const;
    // Facts are found anew: values may have changed.
    void forget() { known_.clear(); }

private:
    // Attribute and component; for ColourSource::none, heights, neither counts.
    using Key = std::tuple<ColourSource, std::size_t, std::uint32_t>;
    using Handles = std::vector<L2Cache::Handle>;  // as many as sample_, empty where a chunk is not loaded
    static ColumnSet columns_of(const Key& key);
    CloudFact fact_of(const Key& key, const Handles& chunks) const;

    const std::shared_ptr<PointCloud> cloud_;
    const std::vector<SampledChunk> sample_;
    std::map<Key, CloudFact> known_;
    std::map<Key, Handles> asked_, held_;  // in this frame; in the one before, so that loaded chunks stay
};

}  // namespace pcm

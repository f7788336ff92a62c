#include "pcm/gl/chunk_feed.h"

#include "pcm/gl/vertex_discs.h"

#include <utility>

namespace pcm {
namespace {

// A chunk that could not be loaded is requested again after this time: the network may be back.
constexpr std::chrono::seconds retry_after{5};

}  // namespace

ChunkFeed::ChunkFeed(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1)
    : cloud_(std::move(cloud)), l1_(std::move(l1)), owner_(l1_->add_owner())
{
}

ChunkFeed::~ChunkFeed()
{
    set_wake({});
    if (asked_last_) cloud_->cache().request({});  // cancels the latest request
    l1_->remove_owner(owner_);
}

void ChunkFeed::Inbox::put(NodeId node)
{
    const std::lock_guard lock(mutex);
    const bool first = arrived.empty();
    arrived.insert(node);
    // Under the lock: when set_wake has returned, the former function is not running.
    if (first && wake) wake();
}

std::set<NodeId> ChunkFeed::Inbox::take()
{
    const std::lock_guard lock(mutex);
    return std::exchange(arrived, {});
}

void ChunkFeed::set_wake(std::function<void()> wake)
{
    const std::lock_guard lock(inbox_->mutex);
    inbox_->wake = std::move(wake);
}

void ChunkFeed::release()
{
    arrivals_.clear();
    l1_->remove_owner(owner_);
    owner_ = l1_->add_owner();
}

bool ChunkFeed::has_failed(NodeId node)
{
    const auto found = failed_.find(node);
    if (found == failed_.end()) return false;
    if (Clock::now() - found->second < retry_after) return true;
    failed_.erase(found);
    if (failed_.empty()) error_.clear();
    return false;
}

void ChunkFeed::fail(NodeId node, std::string error)
{
    failed_[node] = Clock::now();
    error_ = std::move(error);
}

std::vector<NodeId> ChunkFeed::window_of(const DetailSelection& selection, const std::vector<bool>& current)
{
    std::vector<NodeId> window;
    std::vector<bool> blocked(selection.wanted.size(), false);
    for (std::size_t i = 0; i < selection.wanted.size() && window.size() < window_size; ++i) {
        const DetailNode& node = selection.wanted[i];
        blocked[i] = (node.ancestor != no_ancestor && blocked[node.ancestor]) || (!current[i] && has_failed(node.node));
        if (!current[i] && !blocked[i]) window.push_back(node.node);
    }
    return window;
}

std::vector<NodeId> ChunkFeed::ahead_of(const DetailSelection& later, std::size_t missing_now) const
{
    std::vector<NodeId> nodes;
    if (missing_now >= window_size / 2) return nodes;
    for (const DetailNode& node : later.wanted) {
        if (nodes.size() + missing_now >= window_size) break;
        if (!l1_->find(owner_, node.node) && !failed_.count(node.node)) nodes.push_back(node.node);
    }
    return nodes;
}

void ChunkFeed::load(const std::vector<NodeId>& window, const std::vector<NodeId>& ahead, const VertexFormat& format)
{
    std::map<NodeId, Arrival> kept;
    if (arrivals_format_ == format)
        for (const NodeId node : window)
            if (const auto found = arrivals_.find(node); found != arrivals_.end())
                kept.insert(arrivals_.extract(found));
    arrivals_ = std::move(kept);
    arrivals_format_ = format;

    const ColumnSet columns = columns_of(format);
    // Taken before the search: a chunk that arrives from here on wakes the owner again.
    const std::set<NodeId> arrived = inbox_->take();
    std::vector<ChunkRequest> list;
    for (const NodeId node : window) {
        Arrival& arrival = arrivals_[node];
        if (!arrival.chunk) arrival.chunk = cloud_->cache().find(node, columns);
        if (arrival.chunk) continue;
        if (arrived.count(node)) {
            if (const auto error = cloud_->cache().error_of(node)) {
                fail(node, *error);
                continue;
            }
            if (++arrival.lost >= 3) {
                fail(node, "chunk " + std::to_string(node) + " of " + cloud_->tree()->folder().string() +
                               " does not stay in the point cache; give the cache more memory");
                continue;
            }
        }
        list.push_back({node, columns});
    }
    const std::set<NodeId> wanted(window.begin(), window.end());
    std::set<NodeId> silent;  // loaded ahead: their arrival wakes no one
    for (const NodeId node : ahead)
        if (!wanted.count(node) && !cloud_->cache().find(node, columns)) {
            list.push_back({node, columns});
            silent.insert(node);
        }
    // Also when nothing is missing: this cancels requests of an older view.
    if (!list.empty() || asked_last_) {
        asked_last_ = !list.empty();
        cloud_->cache().request(std::move(list), [box = inbox_, silent = std::move(silent)](NodeId node) {
            if (!silent.count(node)) box->put(node);
        });
    }
}

ColumnSet ChunkFeed::columns_of(const VertexFormat& format) const
{
    std::vector<std::string> names;
    if (format.colour != ColourSource::none) names.emplace_back(attribute_of(format.colour));
    if (format.radius) names.emplace_back(attribute_name::radius);
    if (format.normal) names.emplace_back(attribute_name::normal);
    ColumnSet columns = ColumnSet::named(cloud_->info().schema, names);
    columns.sizes = format.radius;
    return columns;
}

// A point's own radius; where it has none, its size.
void ChunkFeed::find_radii(NodeId node, const Chunk& chunk)
{
    const Schema& schema = cloud_->info().schema;
    if (const auto place = schema.find(attribute_name::radius); place && schema[*place].components > 0)
        make_radii(*chunk.attributes[*place], schema[*place], radii_);
    else
        radii_.assign(chunk.points, 0);
    if (!sizes_) sizes_.emplace(*cloud_->tree());
    sizes_->fill_in(node, *chunk.sizes, radii_);
}

VertexAttributes ChunkFeed::attributes_of(NodeId node, const Chunk& chunk, const VertexFormat& format)
{
    const Schema& schema = cloud_->info().schema;
    VertexAttributes attributes;
    if (format.colour != ColourSource::none) {
        const std::size_t place = *schema.find(attribute_of(format.colour));
        const Column& column = *chunk.attributes[place];
        if (is_scaled(format.colour)) {
            if (!scales_.count(format.colour)) scales_[format.colour] = ColourScale::of(column, format.colour);
            make_colours(column, scales_[format.colour], rgba_);
        } else {
            make_class_colours(column, schema[place], rgba_);
        }
        attributes.rgba = rgba_.data();
    }
    if (format.radius) {
        find_radii(node, chunk);
        attributes.radii = radii_.data();
    }
    if (format.normal) {
        const std::size_t place = *schema.find(attribute_name::normal);
        make_normals(*chunk.attributes[place], schema[place], normals_);
        attributes.normals = normals_.data();
    }
    return attributes;
}

Served ChunkFeed::upload(const std::vector<NodeId>& window, const VertexFormat& format, double budget_ms)
{
    const auto supply = [&](NodeId node) {
        const auto found = arrivals_.find(node);
        if (found != arrivals_.end() && found->second.chunk) return Supply::ready;
        // The coarsest chunk sets the colour scale for all, so it must come first.
        return is_scaled(format.colour) && !scales_.count(format.colour) && !has_failed(node) ? Supply::stop
                                                                                              : Supply::absent;
    };
    return l1_->request(window, budget_ms, supply, [&](NodeId node) {
        const auto found = arrivals_.find(node);
        const L2Cache::Handle chunk = found->second.chunk;
        const VertexAttributes attributes = attributes_of(node, *chunk, format);
        if (!l1_->upload(owner_, node, *chunk->positions, cloud_->info().grid.scale, format, attributes)) return false;
        arrivals_.erase(found);
        return true;
    });
}

bool ChunkFeed::waits()
{
    for (const auto& [node, arrival] : arrivals_)
        if (!arrival.chunk && !has_failed(node)) return true;
    return false;
}

}  // namespace pcm

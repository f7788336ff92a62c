#include "pcm/gl/draw/chunk_feed.h"

#include "pcm/gl/draw/view_clips.h"
#include "pcm/view/vertex_discs.h"

#include <algorithm>
#include <utility>

namespace pcm {
namespace {

// A chunk that could not be loaded is requested again after this time: the network may be back.
constexpr std::chrono::seconds retry_after{5};

}  // namespace

ChunkFeed::ChunkFeed(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1)
    : cloud_(std::move(cloud)), l1_(std::move(l1)), owner_(l1_->add_owner()), facts_(cloud_)
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
    facts_.forget();
    classes_.reset();
}

const CloudFact* ChunkFeed::fact_of(const CloudStyle& usable)
{
    return facts_.find(usable, [this](NodeId node) { return has_failed(node); });
}

VertexFormat ChunkFeed::format_of(const CloudStyle& usable, const std::vector<Clip>& clips, std::string& notice)
{
    VertexFormat format = pcm::format_of(usable);
    const Schema& schema = cloud_->info().schema;
    if (format.colour == ColourSource::attribute) {
        const AttributePlace place = *colour_place(usable, schema);
        const auto found = std::find(attributes_.begin(), attributes_.end(), place);
        format.attribute = static_cast<std::uint32_t>(found - attributes_.begin()) + 1;
        if (found == attributes_.end()) attributes_.push_back(place);
    }
    if (usable.where.empty() && clips.empty()) return format;
    std::string text = text_of(clips);
    for (const Condition& condition : usable.where) text += condition.text + "\n";
    const auto [place, is_new] = filter_numbers_.try_emplace(text, static_cast<std::uint32_t>(filters_.size()) + 1);
    if (is_new) filters_.emplace_back(usable.where, clips, schema);
    format.filter = place->second;
    const std::string& more = filters_[format.filter - 1].notice();
    if (!more.empty()) notice += (notice.empty() ? "" : "; ") + more;
    return format;
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

    const ColumnSet columns = load_columns_of(format);
    // Taken before the search: a chunk that arrives from here on wakes the owner again.
    const std::set<NodeId> arrived = inbox_->take();
    std::vector<ChunkRequest> list;
    request_facts(arrived, list);
    const std::size_t first = list.size();
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
        // One request per chunk.
        const auto asked = std::find_if(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(first),
                                        [&](const ChunkRequest& request) { return request.node == node; });
        if (asked != list.begin() + static_cast<std::ptrdiff_t>(first))
            asked->columns |= columns;
        else
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

void ChunkFeed::request_facts(const std::set<NodeId>& arrived, std::vector<ChunkRequest>& list)
{
    const auto failed = [this](NodeId node) { return has_failed(node); };
    for (const auto& [node, columns] : facts_.missing(failed)) {
        const auto error = arrived.count(node) ? cloud_->cache().error_of(node) : std::nullopt;
        if (error)
            fail(node, *error);
        else
            list.push_back({node, columns});
    }
}

AttributePlace ChunkFeed::colour_place_of(const VertexFormat& format) const
{
    if (format.colour == ColourSource::attribute) return attributes_[format.attribute - 1];
    return {*cloud_->info().schema.find(attribute_of(format.colour)), 0};
}

ColumnSet ChunkFeed::load_columns_of(const VertexFormat& format) const
{
    ColumnSet columns = columns_of(format);
    if (format.filter) columns |= filters_[format.filter - 1].tested();
    return columns;
}

ColumnSet ChunkFeed::columns_of(const VertexFormat& format) const
{
    std::vector<std::string> names;
    if (format.radius) names.emplace_back(attribute_name::radius);
    if (format.normal || format.shape) names.emplace_back(attribute_name::normal);
    ColumnSet columns = ColumnSet::named(cloud_->info().schema, names);
    columns.sizes = format.radius;
    if (format.colour != ColourSource::none) columns.attributes.set(colour_place_of(format).attribute);
    return columns;
}

VertexAttributes ChunkFeed::colours_of(const Chunk& chunk, const VertexFormat& format)
{
    const AttributePlace place = colour_place_of(format);
    const Column& column = *chunk.attributes[place.attribute];
    const Attribute& attribute = cloud_->info().schema[place.attribute];
    const CloudFact* const known = facts_.known(format.colour, place);
    const CloudFact fact = known ? *known : CloudFact{};
    VertexAttributes attributes;
    if (is_value(format.colour)) {
        make_values(column, attribute, place.component, fact.range.low, fact.range.high, values_);
        attributes.colours = reinterpret_cast<const std::uint8_t*>(values_.data());
        return attributes;
    }
    if (format.colour == ColourSource::rgb) {
        make_colours(column, fact.scale, rgba_);
    } else {
        make_class_colours(column, attribute, rgba_);
        if (std::exchange(classes_filter_, format.filter) != format.filter) classes_.reset();
        add_classes(column, attribute, classes_);
    }
    attributes.colours = rgba_.data();
    return attributes;
}

VertexAttributes ChunkFeed::attributes_of(NodeId node, const Chunk& chunk, const VertexFormat& format)
{
    const Schema& schema = cloud_->info().schema;
    VertexAttributes attributes;
    if (format.colour != ColourSource::none) attributes = colours_of(chunk, format);
    if (format.radius) {
        if (!sizes_) sizes_.emplace(*cloud_->tree());
        if (format.shape) use_own_normals(chunk);
        sizes_->find_radii(node, chunk, radii_, format.shape ? &shapes_ : nullptr);
        attributes.radii = radii_.data();
        if (format.shape) attributes.shapes = shapes_.data();
    }
    if (format.normal) {
        const std::size_t place = *schema.find(attribute_name::normal);
        make_normals(*chunk.attributes[place], schema[place], normals_);
        attributes.normals = normals_.data();
    }
    return attributes;
}

void ChunkFeed::find_shapes_of(NodeId node, const Chunk& whole, const std::vector<std::uint32_t>* points)
{
    find_shapes(*whole.positions, cloud_->info().grid.scale, points_of_segments(cloud_->tree()->node(node)), shapes_);
    if (!points) return;
    for (std::size_t i = 0; i < points->size(); ++i) shapes_[i] = shapes_[(*points)[i]];
    shapes_.resize(points->size());
}

void ChunkFeed::use_own_normals(const Chunk& chunk)
{
    const Schema& schema = cloud_->info().schema;
    const auto normal = schema.find(attribute_name::normal), radius = schema.find(attribute_name::radius);
    if (!normal || schema[*normal].components < 3) return;
    make_normals(*chunk.attributes[*normal], schema[*normal], normals_);
    radii_.assign(chunk.points, 0);
    if (radius) make_radii(*chunk.attributes[*radius], schema[*radius], radii_);
    for (std::size_t i = 0; i < chunk.points; ++i) {
        const Vec3d n{static_cast<double>(normals_[3 * i]), static_cast<double>(normals_[3 * i + 1]),
                      static_cast<double>(normals_[3 * i + 2])};
        // Among leaves a normal says something of a leaf, if there is a radius with it.
        if (dot(n, n) > 0 && (radii_[i] > 0 || surroundings_of(shapes_[i]) != Surroundings::volume))
            shapes_[i] = shape_of(Surroundings::surface, n);
    }
}

void ChunkFeed::select(std::shared_ptr<const PointSet> points)
{
    if (points == selected_) return;
    selected_ = std::move(points);
    selections_.clear();
}

// 0: no point is selected, else a number made from those that are: vertices of a node whose selected points are the
// same as before are not uploaded again.
std::uint64_t ChunkFeed::selection_of(NodeId node)
{
    if (!selected_ || selected_->count(node) == 0) return 0;
    if (selections_.empty()) selections_.resize(cloud_->tree()->nodes().size());
    std::optional<std::uint64_t>& known = selections_[node];
    if (known) return *known;
    std::uint64_t number = selected_->count(node);
    for (const std::uint32_t point :
         selected_->has_all(node) ? std::vector<std::uint32_t>{} : selected_->points(node)) {
        number = (number ^ point) * 0x9e3779b97f4a7c15u;
        number ^= number >> 29;
    }
    known = number == 0 ? 1 : number;
    return *known;
}

void ChunkFeed::find_flags(NodeId node, const std::vector<std::uint32_t>* points)
{
    flags_ = selected_->flags(node);
    for (std::size_t i = 0; points && i < points->size(); ++i) flags_[i] = flags_[(*points)[i]];
}

Served ChunkFeed::upload(const std::vector<NodeId>& window, const VertexFormat& format, double budget_ms)
{
    // The range of the colours is that of the whole cloud, and must be known first.
    if (facts_.lacks()) return {};
    const auto supply = [&](NodeId node) {
        const auto found = arrivals_.find(node);
        return found != arrivals_.end() && found->second.chunk ? Supply::ready : Supply::absent;
    };
    return l1_->request(window, budget_ms, supply, [&](NodeId node) {
        const auto found = arrivals_.find(node);
        const Chunk& whole = *found->second.chunk;
        const Grid& grid = cloud_->info().grid;
        const auto points = format.filter ? filters_[format.filter - 1].shown(whole, grid) : std::nullopt;
        const Chunk shown = points ? ChunkFilter::take(whole, *points, columns_of(format)) : whole;
        if (format.shape) find_shapes_of(node, whole, points ? &*points : nullptr);
        VertexAttributes attributes = attributes_of(node, shown, format);
        attributes.selection = selection_of(node);
        if (attributes.selection) {
            find_flags(node, points ? &*points : nullptr);
            attributes.selected = flags_.data();
        }
        if (!l1_->upload(owner_, node, *shown.positions, grid.scale, format, attributes, whole.points - shown.points))
            return false;
        arrivals_.erase(found);
        return true;
    });
}

bool ChunkFeed::awaits_facts()
{
    return facts_.lacks() && !facts_.missing([this](NodeId node) { return has_failed(node); }).empty();
}

bool ChunkFeed::waits()
{
    for (const auto& [node, arrival] : arrivals_)
        if (!arrival.chunk && !has_failed(node)) return true;
    return awaits_facts();
}

}  // namespace pcm

#include "pcm/gl/draw/chunk_feed.h"

#include "pcm/gl/draw/view_clips.h"
#include "pcm/gl/tuning.h"
#include "pcm/system/seconds.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace pcm {
namespace {

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

bool ChunkFeed::Inbox::begin(NodeId node, const VertexMaker* maker, bool silent)
{
    const std::lock_guard lock(mutex);
    const auto found = arrived.find(node);
    if (found != arrived.end() && found->second.made && found->second.maker.get() == maker) {
        if (!silent) call_wake();
        return false;
    }
    if (!silent) awaited.insert(node);
    return making.insert(node).second;
}

// Under the lock: when set_wake has returned, the former function is not running.
void ChunkFeed::Inbox::call_wake()
{
    if (!std::exchange(woken, true) && wake) wake();
}

void ChunkFeed::Inbox::make(NodeId node, const std::shared_ptr<const VertexMaker>& maker, L2Cache& cache, bool silent)
{
    if (!begin(node, maker.get(), silent)) return;
    Delivery delivery;
    delivery.maker = maker;
    try {
        if (const L2Cache::Handle chunk = cache.find(node, maker->columns())) delivery.made = maker->make(node, *chunk);
    } catch (const std::exception& error) {
        delivery.error = error.what();
    }
    put(node, std::move(delivery), silent);
}

void ChunkFeed::Inbox::put(NodeId node, Delivery delivery, bool silent)
{
    const std::lock_guard lock(mutex);
    making.erase(node);
    arrived[node] = std::move(delivery);
    if (awaited.erase(node) || !silent) call_wake();
}

std::map<NodeId, ChunkFeed::Delivery> ChunkFeed::Inbox::take()
{
    const std::lock_guard lock(mutex);
    woken = false;
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
    ahead_.clear();
    maker_.reset();  // what is being made by it now is of former points
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
    if (is_new) filters_.push_back(std::make_shared<const ChunkFilter>(usable.where, clips, schema));
    format.filter = place->second;
    const std::string& more = filters_[format.filter - 1]->notice();
    if (!more.empty()) notice += (notice.empty() ? "" : "; ") + more;
    return format;
}

void ChunkFeed::begin_frame()
{
    facts_.begin_frame();
    for (auto at = failed_.begin(); at != failed_.end();) {
        const bool is_old = seconds_since(at->second) >= gl_tuning().loading.retry_after;
        at = is_old ? failed_.erase(at) : std::next(at);
    }
}

double ChunkFeed::seconds_to_retry() const
{
    constexpr double least = 0.01;
    double seconds = 0;
    for (const auto& [node, when] : failed_) {
        const double left = std::max(least, gl_tuning().loading.retry_after - seconds_since(when));
        seconds = sooner(seconds, left);
    }
    return seconds;
}

void ChunkFeed::fail(NodeId node, std::string error)
{
    failed_[node] = Clock::now();
    error_ = std::move(error);
}

std::vector<NodeId> ChunkFeed::window_of(const DetailSelection& selection, const std::vector<bool>& current)
{
    const std::size_t most = gl_tuning().loading.window;
    std::vector<NodeId> window;
    std::vector<bool> blocked(selection.wanted.size(), false);
    for (std::size_t i = 0; i < selection.wanted.size() && window.size() < most; ++i) {
        const DetailNode& node = selection.wanted[i];
        blocked[i] = (node.ancestor != no_ancestor && blocked[node.ancestor]) || (!current[i] && has_failed(node.node));
        if (!current[i] && !blocked[i]) window.push_back(node.node);
    }
    return window;
}

std::vector<NodeId> ChunkFeed::ahead_of(const DetailSelection& later, std::size_t missing_now) const
{
    const std::size_t most = gl_tuning().loading.window;
    std::vector<NodeId> nodes;
    if (missing_now >= most / 2) return nodes;
    for (const DetailNode& node : later.wanted) {
        if (nodes.size() + missing_now >= most) break;
        if (!l1_->find(owner_, node.node) && !failed_.count(node.node)) nodes.push_back(node.node);
    }
    return nodes;
}

void ChunkFeed::load(const std::vector<NodeId>& window, const std::vector<NodeId>& ahead, const VertexFormat& format)
{
    renew_maker(format);
    std::map<NodeId, Arrival> kept;
    for (const NodeId node : window)
        if (const auto found = arrivals_.find(node); found != arrivals_.end()) kept.insert(arrivals_.extract(found));
    arrivals_ = std::move(kept);
    for (const NodeId node : window) {
        Arrival& arrival = arrivals_[node];
        if (const auto found = ahead_.find(node); found != ahead_.end() && found->second)
            arrival.made = std::move(found->second);
    }
    std::map<NodeId, std::optional<MadeVertices>> still_ahead;
    for (const NodeId node : ahead)
        if (!arrivals_.count(node)) still_ahead.insert({node, std::move(ahead_[node])});
    ahead_ = std::move(still_ahead);

    // A chunk that arrives from here on wakes the owner again.
    std::map<NodeId, Delivery> arrived = inbox_->take();
    std::vector<ChunkRequest> list;
    request_facts(arrived, list);
    const auto first = static_cast<std::ptrdiff_t>(list.size());
    for (auto& [node, delivery] : arrived) receive(node, std::move(delivery));

    const bool makes = !facts_.lacks();
    const ColumnSet columns = maker_->columns();
    std::set<NodeId> to_make;
    for (const NodeId node : window) {
        Arrival& arrival = arrivals_[node];
        arrival.loaded = arrival.loaded && !makes;
        if (arrival.made || arrival.loaded || failed_.count(node)) continue;
        if (makes) to_make.insert(node);
        // One request per chunk.
        const auto asked = std::find_if(list.begin(), list.begin() + first,
                                        [&](const ChunkRequest& request) { return request.node == node; });
        if (asked != list.begin() + first)
            asked->columns |= columns;
        else
            list.push_back({node, columns});
    }
    std::set<NodeId> silent;  // loaded ahead: their arrival wakes no one
    for (const NodeId node : ahead)
        if (const auto found = ahead_.find(node); makes && found != ahead_.end() && !found->second)
            if (silent.insert(node).second) list.push_back({node, columns});
    request(std::move(list), std::move(to_make), std::move(silent));
}

ChunkFeed::Delivery ChunkFeed::loaded_only(NodeId node, L2Cache& cache)
{
    Delivery delivery;
    ColumnSet any;
    any.positions = false;
    delivery.chunk = cache.find(node, any);
    return delivery;
}

// Also when nothing is missing: this cancels requests of an older view.
void ChunkFeed::request(std::vector<ChunkRequest> list, std::set<NodeId> to_make, std::set<NodeId> silent)
{
    if (list.empty() && !asked_last_) return;
    asked_last_ = !list.empty();
    L2Cache& cache = cloud_->cache();  // its threads call this, and end before it does
    cache.request(std::move(list), [box = inbox_, maker = maker_, to_make = std::move(to_make),
                                    silent = std::move(silent), &cache](NodeId node) {
        const bool is_silent = silent.count(node) != 0;
        if (is_silent || to_make.count(node))
            box->make(node, maker, cache, is_silent);
        else
            box->put(node, loaded_only(node, cache), false);
    });
}

void ChunkFeed::receive(NodeId node, Delivery delivery)
{
    const bool is_of_now = delivery.maker == maker_;
    const auto later = ahead_.find(node);
    if (later != ahead_.end() && is_of_now) later->second = std::move(delivery.made);
    const auto found = arrivals_.find(node);
    if (found == arrivals_.end()) return;
    Arrival& arrival = found->second;
    if (delivery.made && is_of_now) {
        arrival.made = std::move(delivery.made);
    } else if (const auto error = cloud_->cache().error_of(node)) {
        fail(node, *error);
    } else if (!delivery.error.empty()) {
        fail(node, delivery.error);
    } else if (!delivery.maker) {
        arrival.loaded = true;
    } else if (is_of_now && ++arrival.lost >= gl_tuning().loading.max_lost) {
        fail(node, "chunk " + std::to_string(node) + " of " + cloud_->tree()->folder().string() +
                       " does not stay in the point cache; give the cache more memory");
    }
}

void ChunkFeed::request_facts(const std::map<NodeId, Delivery>& arrived, std::vector<ChunkRequest>& list)
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

VertexRecipe ChunkFeed::recipe_of(const VertexFormat& format)
{
    VertexRecipe recipe;
    recipe.tree = cloud_->tree();
    recipe.format = format;
    if (format.colour != ColourSource::none) {
        recipe.colour = colour_place_of(format);
        const CloudFact* const known = facts_.known(format.colour, *recipe.colour);
        const CloudFact fact = known ? *known : CloudFact{};
        recipe.scale = fact.scale;
        recipe.range = fact.range;
    }
    if (format.filter) recipe.filter = filters_[format.filter - 1];
    recipe.selected = selected_;
    if (format.radius && !sizes_) sizes_ = std::make_shared<const PointSizes>(*recipe.tree);
    recipe.sizes = sizes_;
    return recipe;
}

void ChunkFeed::renew_maker(const VertexFormat& format)
{
    VertexRecipe recipe = recipe_of(format);
    if (maker_ && maker_->recipe() == recipe) return;
    maker_ = std::make_shared<const VertexMaker>(std::move(recipe));
    arrivals_.clear();
    ahead_.clear();
}

AttributePlace ChunkFeed::colour_place_of(const VertexFormat& format) const
{
    if (format.colour == ColourSource::attribute) return attributes_[format.attribute - 1];
    return {*cloud_->info().schema.find(attribute_of(format.colour)), 0};
}

void ChunkFeed::select(std::shared_ptr<const PointSet> points)
{
    if (points == selected_) return;
    selected_ = std::move(points);
    selections_.clear();
}

std::uint64_t ChunkFeed::selection_of(NodeId node)
{
    if (!selected_ || selected_->count(node) == 0) return 0;
    if (selections_.empty()) selections_.resize(cloud_->tree()->nodes().size());
    std::optional<std::uint64_t>& known = selections_[node];
    if (!known) known = selection_number(*selected_, node);
    return *known;
}

Served ChunkFeed::upload(const std::vector<NodeId>& window, const VertexFormat& format, double budget_ms)
{
    // The range of the colours is that of the whole cloud, and must be known first.
    if (facts_.lacks()) return {};
    const auto supply = [&](NodeId node) {
        const auto found = arrivals_.find(node);
        return found != arrivals_.end() && found->second.made ? Supply::ready : Supply::absent;
    };
    return l1_->request(window, budget_ms, supply, [&](NodeId node) {
        const auto found = arrivals_.find(node);
        if (!l1_->upload(owner_, node, found->second.made->vertices)) return false;
        if (format.colour == ColourSource::classification) {
            if (std::exchange(classes_filter_, format.filter) != format.filter) classes_.reset();
            classes_ |= found->second.made->classes;
        }
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
        if (!arrival.made && !arrival.loaded && !has_failed(node)) return true;
    return awaits_facts();
}

}  // namespace pcm

#include "point_cloud.h"

#include "cloud/error.h"

#include <algorithm>
#include <numeric>

namespace pcm {

struct PointCursor::State {
    std::shared_ptr<PointCloud> cloud;  // keeps tree and cache alive while somebody iterates
    Query query;
    ColumnSet columns;
    std::vector<std::size_t> slots;
    std::vector<NodeId> nodes;
    std::size_t next = 0;
    L2Cache::Handle handle;
    Selector selector, without_box;  // the second for chunks inside of the box
    std::vector<const Column*> tested;
    std::vector<std::uint32_t> selected;

    State(Selector all, Selector inside) : selector(std::move(all)), without_box(std::move(inside)) {}
};

PointCursor::PointCursor(std::unique_ptr<State> state) : state_(std::move(state)) {}
PointCursor::PointCursor(PointCursor&&) noexcept = default;
PointCursor& PointCursor::operator=(PointCursor&&) noexcept = default;
PointCursor::~PointCursor() = default;

bool PointCursor::getNextData(PointView& view)
{
    State& s = *state_;
    const Tree& tree = *s.cloud->tree();
    view = PointView();
    while (s.next < s.nodes.size()) {
        const NodeId node = s.nodes[s.next++];
        s.handle = s.cloud->cache().get(node, s.columns);
        // The next chunk is read while the caller works on this one.
        if (s.next < s.nodes.size()) s.cloud->cache().prefetch({s.nodes[s.next], s.columns});
        view.node_ = node;
        view.grid_ = &tree.info().grid;
        view.chunk_ = &*s.handle;
        view.slots_ = &s.slots;
        // Coarse levels come first in a chunk.
        view.count_ = s.query.level ? tree.node(node).points_to_level(*s.query.level) : s.handle->points;
        const bool inside = s.query.box && s.query.box->contains(tree.box(node));
        const Selector& selector = inside ? s.without_box : s.selector;
        if (selector.tests_points()) {
            s.selected.resize(view.count_);
            std::iota(s.selected.begin(), s.selected.end(), 0u);
            s.tested.assign(s.handle->attributes.size(), nullptr);
            for (const std::size_t k : selector.tested()) s.tested[k] = s.handle->attributes[k].get();
            selector.narrow(s.tested, [&](std::size_t i) { return tree.info().grid.to_source(s.handle->positions->grid(i)); },
                            s.selected);
            if (s.selected.empty()) continue;
            view.selected_ = &s.selected;
        }
        return true;
    }
    s.handle = L2Cache::Handle();
    view = PointView();
    return false;
}

std::shared_ptr<PointCloud> PointCloud::open(const std::filesystem::path& path, const L2Options& cache)
{
    std::shared_ptr<PointCloud> cloud(new PointCloud);
    cloud->tree_ = Tree::open(path);
    cloud->cache_ = std::make_unique<L2Cache>(cloud->tree_, cache);
    return cloud;
}

PointCursor PointCloud::points(const Query& query)
{
    Selection selection;
    selection.where = query.where;
    Selector without_box(selection, info().schema);
    selection.box = query.box;
    auto state = std::make_unique<PointCursor::State>(Selector(selection, info().schema), std::move(without_box));
    state->cloud = shared_from_this();
    state->query = query;
    for (const std::string& name : query.attributes) {
        const auto slot = info().schema.find(name);
        if (!slot)
            throw Error(ErrorCode::invalid_argument, tree_->folder(), "this cloud has no attribute '" + name + "'");
        state->slots.push_back(*slot);
        state->columns.attributes.set(*slot);
    }
    for (const std::size_t slot : state->selector.tested()) state->columns.attributes.set(slot);
    state->nodes = tree_->nodes_in(state->selector.bounds(), query.level);
    state->nodes.erase(std::remove_if(state->nodes.begin(), state->nodes.end(),
                                      [&](NodeId id) { return tree_->node(id).points == 0; }),
                       state->nodes.end());
    return PointCursor(std::move(state));
}

std::vector<NodeId> PointCloud::nodes_of(const Query& query) const
{
    return tree_->nodes_in(query.box, query.level);
}

}  // namespace pcm

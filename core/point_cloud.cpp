#include "point_cloud.h"

#include "cloud/error.h"

#include <algorithm>

namespace pcm {

struct PointCursor::State {
    std::shared_ptr<PointCloud> cloud;  // keeps tree and cache alive while somebody iterates
    Query query;
    ColumnSet columns;
    std::vector<std::size_t> slots;
    std::vector<NodeId> nodes;
    std::size_t next = 0;
    L2Cache::Handle handle;
    std::vector<std::uint32_t> selected;
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
        if (s.query.box && !s.query.box->contains(tree.box(node))) {
            s.selected.clear();
            for (std::uint32_t i = 0; i < s.handle->points; ++i)
                if (s.query.box->contains(tree.info().grid.to_source(s.handle->positions->grid(i)))) s.selected.push_back(i);
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
    auto state = std::make_unique<PointCursor::State>();
    state->cloud = shared_from_this();
    state->query = query;
    for (const std::string& name : query.attributes) {
        const auto slot = info().schema.find(name);
        if (!slot)
            throw Error(ErrorCode::invalid_argument, tree_->folder(), "this cloud has no attribute '" + name + "'");
        state->slots.push_back(*slot);
        state->columns.attributes.set(*slot);
    }
    state->nodes = nodes_of(query);
    state->nodes.erase(std::remove_if(state->nodes.begin(), state->nodes.end(),
                                      [&](NodeId id) { return tree_->node(id).points == 0; }),
                       state->nodes.end());
    return PointCursor(std::move(state));
}

std::vector<NodeId> PointCloud::nodes_of(const Query& query) const
{
    // Parents come first in the node vector: what lies below an untouched parent is skipped without a look at its box.
    const std::vector<Node>& nodes = tree_->nodes();
    std::vector<bool> touched(nodes.size(), false);
    std::vector<NodeId> result;
    for (NodeId id = 0; id < nodes.size(); ++id) {
        const Node& node = nodes[id];
        if (node.parent != no_node && !touched[node.parent]) continue;
        if (query.level && node.level > *query.level) continue;
        if (query.box && !query.box->intersects(tree_->box(id))) continue;
        touched[id] = true;
        result.push_back(id);
    }
    return result;
}

}  // namespace pcm

#include "pcm/tree/node_table.h"

#include "pcm/system/error.h"
#include "pcm/tree/damage.h"
#include "pcm/tree/index_head.h"
#include "pcm/tree/node_checks.h"
#include "pcm/tree/node_page.h"

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

namespace pcm {
struct NodeTable::State {
    // A node that names a child, and the child.
    using Claim = std::pair<NodeId, NodeId>;

    std::shared_ptr<const IndexHead> head;
    std::optional<NodeChecks> checks;
    std::shared_ptr<const ByteSource> file;  // closed when all pages are there
    std::filesystem::path path;              // its name
    std::deque<std::vector<Node>> owned;
    std::vector<std::atomic<const Node*>> pages;
    std::vector<NodeId> first;
    std::vector<std::uint32_t> page_of_block;
    std::atomic<std::size_t> loaded{0};
    std::map<std::uint32_t, std::vector<Claim>> claims;  // claims on nodes of pages that are not loaded yet, by page
    std::mutex mutex;

    // `nodes_of_pages`: the number of nodes of each page.
    explicit State(const std::vector<std::uint32_t>& nodes_of_pages);

    std::uint32_t page_of(NodeId id) const;
    const Node* load(std::uint32_t page, const std::vector<std::byte>* beginning);
    std::vector<Node> read(std::uint32_t page, const std::vector<std::byte>* beginning) const;
    // The node, when its page is loaded or is `now` with these nodes.
    const Node* find(NodeId id, std::uint32_t now, const std::vector<Node>& nodes) const;
    void check(std::uint32_t page, const std::vector<Node>& nodes);
    void publish(std::uint32_t page, std::vector<Node> nodes);
};

NodeTable::State::State(const std::vector<std::uint32_t>& nodes_of_pages) : pages(nodes_of_pages.size()), first{0}
{
    for (const std::uint32_t nodes : nodes_of_pages) first.push_back(first.back() + nodes);
    std::uint32_t page = 0;
    for (NodeId id = 0; id < first.back(); id += NodeId(1) << block_shift) {
        while (first[page + 1] <= id) ++page;
        page_of_block.push_back(page);
    }
}

std::uint32_t NodeTable::State::page_of(NodeId id) const
{
    return NodeTable::page_of(id, first.data(), page_of_block.data());
}

// The nodes above those of a page are loaded before it, so that each node is checked under its parent.
const Node* NodeTable::State::load(std::uint32_t page, const std::vector<std::byte>* beginning)
{
    const std::lock_guard lock(mutex);
    std::vector<std::uint32_t> wanted{page};
    std::map<std::uint32_t, std::vector<Node>> waiting;
    while (!wanted.empty()) {
        const std::uint32_t now = wanted.back();
        if (pages[now].load(std::memory_order_relaxed)) {
            wanted.pop_back();
            continue;
        }
        if (const auto found = waiting.find(now); found != waiting.end()) {
            check(now, found->second);
            publish(now, std::move(found->second));
            waiting.erase(found);
            continue;
        }
        const std::vector<Node>& nodes = waiting[now] = read(now, beginning);
        std::uint32_t last = now;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const NodeId id = first[now] + static_cast<NodeId>(i);
            if (id == 0) continue;
            if (nodes[i].parent >= id) checks->refuse(id, "comes before its parent");
            const std::uint32_t above = page_of(nodes[i].parent);
            if (above != now && above != std::exchange(last, above)) wanted.push_back(above);
        }
    }
    return pages[page].load(std::memory_order_relaxed);
}

std::vector<Node> NodeTable::State::read(std::uint32_t page, const std::vector<std::byte>* beginning) const
{
    const NodePage& at = head->pages[page];
    std::vector<std::byte> bytes(static_cast<std::size_t>(at.bytes));
    if (beginning && at.offset + at.bytes <= beginning->size())
        std::copy_n(beginning->begin() + static_cast<std::ptrdiff_t>(at.offset), bytes.size(), bytes.begin());
    else
        file->read_at(bytes.data(), bytes.size(), at.offset);
    return decode_page(at, bytes.data(), head->info.levels, path);
}

const Node* NodeTable::State::find(NodeId id, std::uint32_t now, const std::vector<Node>& nodes) const
{
    const std::uint32_t page = page_of(id);
    const Node* const found = page == now ? nodes.data() : pages[page].load(std::memory_order_relaxed);
    return found ? found + (id - first[page]) : nullptr;
}

void NodeTable::State::check(std::uint32_t page, const std::vector<Node>& nodes)
{
    const NodeChecks::NodeAt at = [&](NodeId id) -> const Node& { return *find(id, page, nodes); };
    std::vector<Claim> later;
    const auto check_below = [&](NodeId id) {
        const Node& node = at(id);
        bool whole = true;
        for (const NodeId child : node.children) {
            if (child == no_node) continue;
            if (const Node* const found = find(child, page, nodes))
                checks->check_child(id, *found);
            else
                whole = false;
        }
        if (whole) checks->check_points(id, node, at);
        return whole;
    };
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const NodeId id = first[page] + static_cast<NodeId>(i);
        checks->check(id, nodes[i], at);
        if (check_below(id)) continue;
        for (const NodeId child : nodes[i].children)
            if (child != no_node && !find(child, page, nodes)) later.emplace_back(id, child);
    }
    if (const auto found = claims.find(page); found != claims.end())
        for (const Claim& claim : found->second) check_below(claim.first);
    claims.erase(page);
    for (const Claim& claim : later) claims[page_of(claim.second)].push_back(claim);
}

void NodeTable::State::publish(std::uint32_t page, std::vector<Node> nodes)
{
    owned.push_back(std::move(nodes));
    pages[page].store(owned.back().data(), std::memory_order_release);
    if (++loaded == pages.size()) file.reset();
}

NodeTable::NodeTable() : NodeTable(std::vector<Node>()) {}

NodeTable::NodeTable(std::shared_ptr<State> state)
    : state_(std::move(state)),
      pages_(state_->pages.data()),
      first_(state_->first.data()),
      page_of_block_(state_->page_of_block.data()),
      size_(state_->first.back())
{
}

NodeTable::NodeTable(std::vector<Node> nodes)
    : NodeTable(std::make_shared<State>(std::vector<std::uint32_t>{static_cast<std::uint32_t>(nodes.size())}))
{
    state_->publish(0, std::move(nodes));
}

NodeTable::NodeTable(std::shared_ptr<const IndexHead> head, std::shared_ptr<const ByteSource> file,
                     const std::vector<std::byte>& beginning)
    : NodeTable([&] {
          std::vector<std::uint32_t> nodes;
          for (const NodePage& page : head->pages) nodes.push_back(page.nodes);
          return std::make_shared<State>(nodes);
      }())
{
    state_->path = file->path();
    state_->checks.emplace(head->info, head->data_files, head->part_roots, head->nodes, state_->path);
    state_->head = std::move(head);
    if (size_ == 0) return;
    state_->file = std::move(file);
    state_->load(0, &beginning);
}

const Node* NodeTable::load(std::uint32_t page) const
{
    try {
        return state_->load(page, nullptr);
    } catch (const Error& error) {
        if (!is_damage(error)) throw;
        throw DamagedTree(error, state_->path.parent_path(), "rebuild the index from the chunks");
    }
}

const Node& NodeTable::at(NodeId id) const
{
    if (id >= size_) throw std::out_of_range("the tree has no node " + std::to_string(id));
    return (*this)[id];
}

std::size_t NodeTable::pages() const { return state_->pages.size(); }
std::size_t NodeTable::pages_loaded() const { return state_->loaded; }

}  // namespace pcm

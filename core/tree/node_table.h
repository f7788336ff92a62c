// The nodes of a tree by their numbers. Those of a tree on disk are read page by page, each page when the first of its
// nodes is asked for, so that a tree of any size is opened in a few reads and costs memory for the nodes that are used.
//
// Nodes are checked when their page is read: each fits its parent, and is the child of one node. Copies share their
// pages. Any number of threads may call every member; a reference stays valid as long as the table or a copy exists.
#pragma once

#include "pcm/tree/node.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <vector>

namespace pcm {

class ByteSource;
struct IndexHead;

class NodeTable {
public:
    NodeTable();
    explicit NodeTable(std::vector<Node> nodes);
    // The pages of the file that `head` was read from. `beginning` are bytes of the file from its first one on that
    // have been read already. Errors name `file`'s path and its folder as the tree's. Throws what at() throws, since
    // it reads the page of the root.
    NodeTable(std::shared_ptr<const IndexHead> head, std::shared_ptr<const ByteSource> file,
              const std::vector<std::byte>& beginning);

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }

    // The node with a number below size(). Throws DamagedTree (Error(corrupt | truncated)), and Error(io) where
    // reading fails.
    const Node& operator[](NodeId id) const
    {
        const std::uint32_t page = page_of(id, first_, page_of_block_);
        const Node* const nodes = pages_[page].load(std::memory_order_acquire);
        return (nodes ? nodes : load(page))[id - first_[page]];
    }
    const Node& at(NodeId id) const;  // throws std::out_of_range beyond size()
    // The node with a number below size(), where its page has been read; else null. Reads nothing and waits for
    // nothing.
    const Node* find(NodeId id) const
    {
        const std::uint32_t page = page_of(id, first_, page_of_block_);
        const Node* const nodes = pages_[page].load(std::memory_order_acquire);
        return nodes ? nodes + (id - first_[page]) : nullptr;
    }
    const Node& front() const { return (*this)[0]; }
    const Node& back() const { return (*this)[static_cast<NodeId>(size_ - 1)]; }

    // From the first node to the last; reads all pages.
    class Iterator {
    public:
        using iterator_category = std::forward_iterator_tag;
        using value_type = Node;
        using difference_type = std::ptrdiff_t;
        using pointer = const Node*;
        using reference = const Node&;
        Iterator(const NodeTable* table, NodeId id) : table_(table), id_(id) {}
        const Node& operator*() const { return (*table_)[id_]; }
        const Node* operator->() const { return &(*table_)[id_]; }
        Iterator& operator++()
        {
            ++id_;
            return *this;
        }
        Iterator operator++(int)
        {
            const Iterator before = *this;
            ++id_;
            return before;
        }
        bool operator==(const Iterator& o) const { return id_ == o.id_; }
        bool operator!=(const Iterator& o) const { return id_ != o.id_; }

    private:
        const NodeTable* table_;
        NodeId id_;
    };
    Iterator begin() const { return {this, 0}; }
    Iterator end() const { return {this, static_cast<NodeId>(size_)}; }

    std::vector<Node> all() const { return {begin(), end()}; }

    std::size_t pages() const;         // number of pages of the index
    std::size_t pages_loaded() const;  // so far

private:
    struct State;
    static constexpr unsigned block_shift = 8;

    explicit NodeTable(std::shared_ptr<State> state);
    static std::uint32_t page_of(NodeId id, const NodeId* first, const std::uint32_t* page_of_block)
    {
        std::uint32_t page = page_of_block[id >> block_shift];
        while (first[page + 1] <= id) ++page;
        return page;
    }
    const Node* load(std::uint32_t page) const;

    std::shared_ptr<State> state_;
    // Parts of the state, at hand for operator[].
    const std::atomic<const Node*>* pages_;  // the nodes of each page; null until they are loaded
    const NodeId* first_;                    // the first node of each page, and the number of nodes
    const std::uint32_t* page_of_block_;     // the page of every 2^block_shift-th node
    std::size_t size_;
};

}  // namespace pcm

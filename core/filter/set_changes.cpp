#include "pcm/filter/set_changes.h"

#include "pcm/cache/l2_cache.h"
#include "pcm/cloud/with_type.h"
#include "pcm/filter/result_attributes.h"
#include "pcm/system/error.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/update/tree_changes.h"

#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

namespace pcm {
namespace {

// A copy has another name; everything else is as when the points were selected.
void require_unchanged(const PointSet& set, const Tree& now)
{
    const TreeInfo &then = set.tree().info(), &info = now.info();
    if (then.generation == info.generation && then.content_hash == info.content_hash && then.points == info.points &&
        set.tree().nodes().size() == now.nodes().size())
        return;
    throw Error(ErrorCode::invalid_argument, set.tree().folder(), "the tree was changed since its points were selected",
                "select the points again");
}

void require_points(const PointSet& set)
{
    if (set.empty())
        throw Error(ErrorCode::invalid_argument, set.tree().folder(), "no point is selected", "select points first");
}

// Finds the attribute that is written, or adds it; returns its place.
using FindPlace = std::function<std::size_t(TreeChanges& changes)>;
// Changes the column of one node; returns how many values changed.
using ChangeColumn =
    std::function<std::uint64_t(NodeId node, const Column& before, const std::function<Column&()>& edit)>;

Outcome change_tree(const std::filesystem::path& folder, const PointSet& set, bool all_nodes,
                    const SetChangeOptions& options, const FindPlace& find_place, const ChangeColumn& change,
                    Watch& watch)
{
    Outcome outcome;
    const auto changes = std::make_shared<TreeChanges>(folder);
    require_unchanged(set, *changes->tree());
    const std::size_t attributes = changes->tree()->info().schema.size(), place = find_place(*changes);
    const bool known = place < attributes;
    L2Options capacity;
    capacity.capacity_bytes = options.memory_bytes;
    L2Cache cache(changes, capacity);
    try {
        std::vector<NodeId> nodes;
        for (NodeId id = 0; id < cache.tree().nodes().size(); ++id)
            if (set.count(id) > 0 || (all_nodes && known && cache.tree().node(id).points > 0)) nodes.push_back(id);
        std::atomic<std::uint64_t> changed{0};
        for_each_index(
            nodes.size(), thread_count(options.threads),
            [&](std::size_t i) {
                ColumnSet columns;
                columns.positions = false;
                columns.attributes.set(place);
                L2Cache::Edit edit = cache.edit(nodes[i], columns);
                const std::uint64_t values =
                    change(nodes[i], *edit.chunk().attributes[place], [&]() -> Column& { return edit.column(place); });
                if (values > 0) edit.mark_written();
                changed += values;
            },
            [&](std::size_t begun) {
                watch.report("Writing the attribute",
                             0.97 * static_cast<double>(begun) / static_cast<double>(nodes.size() + 1));
            });
        outcome.points_in = cache.tree().info().points;
        outcome.points_out = changed;
        watch.report("Writing the attribute", 0.98, true);  // the last chance to cancel
        run_last_step(outcome, [&] { cache.close(); });
    } catch (...) {
        cache.abandon();
        throw;
    }
    return outcome;
}

SetChangeReport change_column(const PointSet& set, bool all_nodes, const SetChangeOptions& options,
                              const FindPlace& find_place, const ChangeColumn& change)
{
    Watch watch(options.progress);
    watch.report("Writing the attribute", 0);
    UpdateTarget target(set.tree().folder(), options.target);
    SetChangeReport report = target.update([&](const std::filesystem::path& folder) {
        SetChangeReport changed;
        changed.outcome = change_tree(folder, set, all_nodes, options, find_place, change, watch);
        return changed;
    });
    report.tree = target.path();
    report.outcome.seconds = watch.seconds();
    watch.finish("Done");
    return report;
}

// The place of an integer attribute that can hold the value.
std::size_t integer_place(TreeChanges& changes, const std::string& name, std::int64_t value)
{
    Attribute attribute;
    attribute.name = name;
    const Schema& schema = changes.tree()->info().schema;
    const auto place = schema.find(name);
    if (place) attribute = schema[*place];
    const auto refuse = [&](const std::string& what, const std::string& advice) {
        throw Error(ErrorCode::invalid_argument, changes.tree()->folder(), "'" + name + "' " + what, advice);
    };
    if (attribute.components != 1) refuse("has several components", "choose an attribute of one integer");
    with_type(attribute.type, [&](auto scalar) {
        using T = decltype(scalar);
        const auto text = std::string(name_of(attribute.type));
        if constexpr (std::is_floating_point_v<T>)
            refuse("is of type " + text + ", which is no integer", "choose an attribute of one integer");
        else if (value < 0
                     ? !std::is_signed_v<T> || value < static_cast<std::int64_t>(std::numeric_limits<T>::min())
                     : static_cast<std::uint64_t>(value) > static_cast<std::uint64_t>(std::numeric_limits<T>::max()))
            refuse("is of type " + text + ", which cannot be " + std::to_string(value), "choose a value in its range");
    });
    return place ? *place : changes.add_attribute(attribute);
}

// The points of a set, for erase_points().
class SetTest final : public ChunkTest {
public:
    explicit SetTest(const PointSet& set) : set_(set), subtree_(set.tree().nodes().size(), false)
    {
        for (NodeId id = static_cast<NodeId>(subtree_.size()); id-- > 0;) {
            if (set.count(id) > 0) subtree_[id] = true;
            const NodeId parent = set.tree().node(id).parent;
            if (subtree_[id] && parent != no_node) subtree_[parent] = true;
        }
    }
    bool touches(NodeId id, const Node&) const override { return subtree_[id]; }
    std::vector<std::uint32_t> chosen(NodeId id, const Chunk&) const override { return set_.points(id); }

private:
    const PointSet& set_;
    std::vector<bool> subtree_;  // nodes with such points in or below them
};

}  // namespace

SetChangeReport save_as_attribute(const PointSet& set, const std::string& name, const SetChangeOptions& options)
{
    const Attribute attribute = selection_attribute(name);
    check_may_write(set.tree(), attribute, options.overwrite);
    const auto place = [&](TreeChanges& changes) { return place_for(changes, attribute); };
    return change_column(set, true, options, place,
                         [&](NodeId node, const Column& before, const std::function<Column&()>& edit) {
                             const std::vector<std::uint8_t> flags = set.flags(node);
                             const auto* old = before.as<std::uint8_t>();
                             std::uint64_t changed = 0;
                             for (std::size_t i = 0; i < flags.size(); ++i) changed += flags[i] != old[i];
                             if (changed > 0) std::copy(flags.begin(), flags.end(), edit().as<std::uint8_t>());
                             return changed;
                         });
}

SetChangeReport classify_points(const PointSet& set, std::int64_t value, const std::string& attribute,
                                const SetChangeOptions& options)
{
    require_points(set);
    const auto place = [&](TreeChanges& changes) { return integer_place(changes, attribute, value); };
    return change_column(set, false, options, place,
                         [&](NodeId node, const Column& before, const std::function<Column&()>& edit) {
                             std::uint64_t changed = 0;
                             with_type(before.type(), [&](auto scalar) {
                                 using T = decltype(scalar);
                                 const T wanted = static_cast<T>(value);
                                 const std::vector<std::uint32_t> points = set.points(node);
                                 for (const std::uint32_t i : points) changed += before.as<T>()[i] != wanted;
                                 if (changed == 0) return;
                                 T* const values = edit().template as<T>();
                                 for (const std::uint32_t i : points) values[i] = wanted;
                             });
                             return changed;
                         });
}

SetErasure delete_points(const PointSet& set, const SetChangeOptions& options)
{
    require_points(set);
    UpdateTarget target(set.tree().folder(), options.target);
    EraseOptions erase;
    erase.threads = options.threads;
    erase.progress = options.progress;
    SetErasure erased;
    erased.tree = target.path();
    erased.report = target.update([&](const std::filesystem::path& folder) {
        return erase_points(
            folder,
            [&](const std::shared_ptr<const Tree>& now) {
                require_unchanged(set, *now);
                return std::make_unique<SetTest>(set);
            },
            erase);
    });
    return erased;
}

}  // namespace pcm

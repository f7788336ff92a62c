#include "pcm/point_cloud.h"

#include "pcm/system/error.h"
#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/query/chunk_stream.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/update/clone.h"
#include "pcm/update/tree_changes.h"

namespace pcm {

struct PointCursor::State {
    std::shared_ptr<PointCloud> cloud;  // keeps tree and cache alive while somebody iterates
    ProgressFunction progress;
    std::vector<std::size_t> slots;
    ChunkStream stream;
};

std::uint32_t PointView::number(std::size_t i) const { return part_->number(index(i)); }

PointCursor::PointCursor(std::unique_ptr<State> state) : state_(std::move(state)) {}
PointCursor::PointCursor(PointCursor&&) noexcept = default;
PointCursor& PointCursor::operator=(PointCursor&&) noexcept = default;
PointCursor::~PointCursor() = default;

bool PointCursor::getNextData(PointView& view)
{
    State& s = *state_;
    view = PointView();
    if (s.progress) {
        ProgressUpdate update;
        update.stage = "Reading points";
        update.fraction = s.stream.fraction();
        if (!s.progress(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }
    const SelectedChunk* const part = s.stream.next();
    if (!part) return false;
    view.node_ = part->node;
    view.grid_ = &s.cloud->info().grid;
    view.chunk_ = &part->chunk;
    view.part_ = part;
    view.slots_ = &s.slots;
    view.count_ = part->points;
    if (!part->all) view.selected_ = &part->selected;
    return true;
}

CursorStatistics PointCursor::statistics() const
{
    const ChunkStream& stream = state_->stream;
    return {stream.chunks(), stream.cached(), stream.points_read(), stream.bytes_read()};
}

std::shared_ptr<PointCloud> PointCloud::open(const std::filesystem::path& path, const L2Options& cache, Access access)
{
    std::shared_ptr<PointCloud> cloud(new PointCloud);
    if (access == Access::write)
        cloud->store_ = cloud->changes_ = std::make_shared<TreeChanges>(path);
    else
        cloud->store_ = std::make_shared<TreeStore>(Tree::open(path));
    cloud->folder_ = cloud->store_->tree()->folder();
    cloud->cache_ = std::make_unique<L2Cache>(cloud->store_, cache);
    return cloud;
}

std::shared_ptr<PointCloud> PointCloud::create(const std::filesystem::path& path, PointReader& points,
                                               const BuildOptions& build, const L2Options& cache, Access access)
{
    build_tree(points, {}, path, build);
    return open(path, cache, access);
}

PointCloud::~PointCloud()
{
    try {
        if (changes_) close();
    } catch (const std::exception&) {  // close() is there for those who want to know
    }
}

TreeChanges& PointCloud::changes() const
{
    if (!changes_)
        throw Error(ErrorCode::invalid_argument, folder_, "this point cloud was opened for reading only, or was closed",
                    "open it for writing");
    return *changes_;
}

std::size_t PointCloud::add_attribute(const Attribute& attribute)
{
    const std::lock_guard lock(changes_mutex_);
    const std::size_t slot = changes().add_attribute(attribute);
    cache_->take_schema();
    return slot;
}

void PointCloud::flush() { cache_->flush(); }

void PointCloud::close()
{
    if (changes_) cache_->flush();
    abandon();
}

// The store goes on for readers that are under way, on the tree as it is on disk.
void PointCloud::abandon()
{
    cache_->abandon();
    const std::lock_guard lock(changes_mutex_);
    if (changes_) changes_->end();
    changes_.reset();
}

void PointCloud::save(const std::filesystem::path& path)
{
    flush();
    clone_tree(folder_, path);
}

std::shared_ptr<PointCloud> PointCloud::transform(const Affine& map, const std::filesystem::path& path,
                                                  const BuildOptions& build, const L2Options& cache)
{
    flush();
    const std::shared_ptr<const Tree> from = tree();
    TransformedReader points(std::make_unique<TreeReader>(from, std::nullopt, Selection()), map);
    build_tree(points, from->info().sources, path, build);
    return open(path, cache);
}

EditCursor PointCloud::edit(const Query& query)
{
    {
        const std::lock_guard lock(changes_mutex_);
        changes();
    }
    return EditCursor(shared_from_this(), query);
}

ColumnSet PointCloud::columns_of(const Query& query, const Selector& selector, std::vector<std::size_t>& slots) const
{
    ColumnSet columns;
    for (const std::string& name : query.attributes) {
        const auto slot = info().schema.find(name);
        if (!slot) throw Error(ErrorCode::invalid_argument, folder_, "this cloud has no attribute '" + name + "'");
        slots.push_back(*slot);
        columns.attributes.set(*slot);
    }
    for (const std::size_t slot : selector.tested()) columns.attributes.set(slot);
    return columns;
}

PointCursor PointCloud::points(const Query& query)
{
    Selector selector(query.selection(), info().schema);
    std::vector<std::size_t> slots;
    const ColumnSet columns = columns_of(query, selector, slots);
    return PointCursor(std::unique_ptr<PointCursor::State>(new PointCursor::State{
        shared_from_this(),
        query.progress,
        std::move(slots),
        {*cache_, pool_, rates_, std::move(selector), query.level, columns, query.reads_in_flight}}));
}

Estimate PointCloud::estimate(const Query& query, EstimatePrecision precision)
{
    std::vector<std::size_t> slots;
    const ColumnSet columns = columns_of(query, Selector(query.selection(), info().schema), slots);
    return make_estimate(*cache_, rates_, query, columns, precision);
}

NearestResult PointCloud::nearest(const Vec3d& point, std::size_t k, const NearestOptions& options)
{
    return find_nearest(*cache_, blocks_, point, k, options);
}

NearestBatch PointCloud::nearest(const std::vector<Vec3d>& points, std::size_t k, const NearestOptions& options)
{
    return find_nearest(*cache_, blocks_, points, k, options);
}

HitResult PointCloud::first_hit(const Region& beam, const std::optional<std::uint16_t>& level)
{
    return find_first_hit(*cache_, blocks_, beam, level);
}

std::vector<NodeId> PointCloud::nodes_of(const Query& query) const
{
    std::vector<NodeId> ids;
    for (const SelectedNode& node :
         selected_nodes(cache_->tree(), Selector(query.selection(), info().schema), query.level))
        ids.push_back(node.node);
    return ids;
}

}  // namespace pcm

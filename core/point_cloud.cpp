#include "pcm/point_cloud.h"

#include "pcm/query/query_source.h"
#include "pcm/system/error.h"
#include "pcm/update/tree_changes.h"

#include <exception>
#include <mutex>

namespace pcm {

struct PointCloud::State : QuerySource {
    State(std::shared_ptr<ChunkStore> chunks, std::shared_ptr<TreeChanges> of_writer, const L2Options& options)
        : QuerySource(std::move(chunks), options), changes(std::move(of_writer))
    {
    }
    ~State()
    {
        try {
            if (changes) close();
        } catch (const std::exception&) {  // a caller that wants to know calls close()
        }
    }

    TreeChanges& writable()
    {
        if (!changes)
            throw Error(ErrorCode::invalid_argument, folder,
                        "this point cloud was opened for reading only, or was closed", "open it for writing");
        return *changes;
    }
    void close()
    {
        try {
            if (changes) cache.flush();
        } catch (const Error& error) {
            if (error.is_done()) abandon();
            throw;
        }
        abandon();
    }
    // Readers under way keep the store, with the tree as it is on disk.
    void abandon()
    {
        cache.abandon();
        const std::lock_guard lock(mutex);
        if (changes) changes->end();
        changes.reset();
    }

    std::shared_ptr<TreeChanges> changes;  // the store of a cloud that is open for writing
    std::mutex mutex;                      // held while attributes are added and the cloud is closed
};

PointCloud::PointCloud(std::shared_ptr<State> state) : state_(std::move(state)) {}
PointCloud::~PointCloud() = default;

std::shared_ptr<PointCloud> PointCloud::open(const std::filesystem::path& path, const L2Options& cache, Access access)
{
    std::shared_ptr<State> state;
    if (access == Access::write) {
        const auto changes = std::make_shared<TreeChanges>(path);
        state = std::make_shared<State>(changes, changes, cache);
    } else {
        state = std::make_shared<State>(std::make_shared<TreeStore>(Tree::open(path)), nullptr, cache);
    }
    return std::shared_ptr<PointCloud>(new PointCloud(std::move(state)));
}

const TreeInfo& PointCloud::info() const { return state_->info(); }

std::shared_ptr<const Tree> PointCloud::tree() const { return state_->store->tree(); }

L2Cache& PointCloud::cache() { return state_->cache; }

PointCursor PointCloud::points(const Query& query) { return PointCursor(state_, query); }

Estimate PointCloud::estimate(const Query& query, EstimatePrecision precision)
{
    const ColumnSet columns = columns_of(slots_of(*state_, query), Selector(query.selection(), info().schema));
    return make_estimate(state_->cache, state_->rates, query, columns, precision);
}

NearestResult PointCloud::nearest(const Vec3d& point, std::size_t k, const NearestOptions& options)
{
    return find_nearest(state_->cache, state_->blocks, point, k, options);
}

NearestBatch PointCloud::nearest(const std::vector<Vec3d>& points, std::size_t k, const NearestOptions& options)
{
    return find_nearest(state_->cache, state_->blocks, points, k, options);
}

HitResult PointCloud::first_hit(const Region& beam, const std::optional<std::uint16_t>& level)
{
    return find_first_hit(state_->cache, state_->blocks, beam, level);
}

EditCursor PointCloud::edit(const Query& query)
{
    {
        const std::lock_guard lock(state_->mutex);
        state_->writable();
    }
    return EditCursor(state_, query);
}

std::size_t PointCloud::add_attribute(const Attribute& attribute)
{
    const std::lock_guard lock(state_->mutex);
    const std::size_t slot = state_->writable().add_attribute(attribute);
    state_->cache.take_schema();
    return slot;
}

void PointCloud::flush() { state_->cache.flush(); }

void PointCloud::close() { state_->close(); }

void PointCloud::abandon() { state_->abandon(); }

}  // namespace pcm

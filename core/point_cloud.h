// PointCloud: the interface for programs that use a tree. make_cloud.h makes new ones.
//
//     auto cloud = pcm::PointCloud::open("city.pct");
//     auto cursor = cloud->points();                       // or points(query)
//     pcm::PointView view;
//     while (cursor.getNextData(view))
//         for (std::size_t i = 0; i < view.size(); ++i) use(view.position(i));
//     cloud->nearest({500123.4, 4800567.8, 120}, 8);       // points
//
// And to change attributes of points, however large the cloud is:
//
//     auto cloud = pcm::PointCloud::open("city.pct", {}, pcm::Access::write);
//     cloud->add_attribute({"height", pcm::ScalarType::f32});
//     pcm::Query query;
//     query.attributes = {"height"};                       // what is read or set
//     auto cursor = cloud->edit(query);
//     pcm::EditView view;
//     while (cursor.getNextData(view)) {
//         for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, float(view.position(i)[2] - 92));
//         view.mark_written();
//     }
//     cloud->close();                                      // now the tree has all of it; before this, nothing
//
// A PointCloud may be shared between threads; a cursor belongs to one thread.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/query/edit_cursor.h"
#include "pcm/query/estimate.h"
#include "pcm/query/nearest.h"
#include "pcm/query/point_cursor.h"
#include "pcm/query/query.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace pcm {

enum class Access : std::uint8_t {
    read,
    write,  // the tree is locked against other writers, not against readers
};

class PointCloud {
public:
    // Errors: those of Tree::open; with Access::write also Error(exists) when another program changes the tree.
    static std::shared_ptr<PointCloud> open(const std::filesystem::path& path, const L2Options& cache = {},
                                            Access access = Access::read);
    // Once the last cursor is destroyed too, the cloud is closed as by close(), but errors are lost.
    ~PointCloud();
    PointCloud(const PointCloud&) = delete;
    PointCloud& operator=(const PointCloud&) = delete;

    // With the attributes that were added; `info` and references to it live as long as the cloud.
    const TreeInfo& info() const;
    // The tree on disk as of the last flush(), and with the attributes that were added.
    std::shared_ptr<const Tree> tree() const;
    L2Cache& cache();

    // Points in node order, streaming, in bounded memory. Throws Error(invalid_argument) for an unknown attribute and
    // what Selector throws.
    PointCursor points(const Query& query = {});

    // What points(query) will find and cost. Throws what points() throws.
    Estimate estimate(const Query& query, EstimatePrecision precision = EstimatePrecision::index);

    // The k points nearest to a point, or to each of many, at a precision; see query/nearest.h.
    NearestResult nearest(const Vec3d& point, std::size_t k, const NearestOptions& options = {});
    NearestBatch nearest(const std::vector<Vec3d>& points, std::size_t k, const NearestOptions& options = {});
    // The point inside of a Region::ray() or Region::cone() that is nearest along it: what a click on the screen picks.
    HitResult first_hit(const Region& beam, const std::optional<std::uint16_t>& level = {});

    // The selected points chunk by chunk, to be changed. Throws what points() throws, and Error(invalid_argument) when
    // the cloud was opened for reading.
    EditCursor edit(const Query& query);
    // A new attribute at the end of the schema; all its values are zero. Returns its place there. It is part of the
    // tree on disk from the next flush() on. Throws Error(invalid_argument) for a name that exists or is not possible,
    // and when the cloud was opened for reading.
    std::size_t add_attribute(const Attribute& attribute);
    // All changes become part of the tree on disk, atomically. Throws Error(no_space | io | ...); the changes are kept
    // then and can be flushed again. An Error that is_done() says that they are part of the tree, but may not survive a
    // loss of power. Throws Error(invalid_argument) when points were changed and not marked as written.
    void flush();
    // flush(), and the lock is released unless that fails (it is released after an Error that is_done()). Any later
    // call of the cloud or its cursors throws Error(invalid_argument).
    void close();
    // close() without flush(): changes since the last one are dropped.
    void abandon();

private:
    struct State;
    explicit PointCloud(std::shared_ptr<State> state);
    std::shared_ptr<State> state_;  // shared with the cursors
};

}  // namespace pcm

// A point cloud tree, opened for reading: nodes come into memory when they are used, chunks stay on disk.
//
// A tree folder (by convention NAME.pct) holds `index.pct` and a few data files; see bpc/FORMAT.md. The tree is a k-d
// tree with one chunk per node. Every point belongs to one level, and levels are additive: the points of levels 0..L
// are the cloud at level L, and all levels together hold every point exactly once. A node's chunk holds the points of
// some consecutive levels in the node's region, coarse levels first; its descendants hold the finer levels. Nodes are
// stored parents first (node 0 is the root, and a node's number is larger than its parent's), so one forward pass over
// nodes() visits parents before children.
//
// A tree consists of parts: the build makes part 0, and every append adds a subtree of its own. The nodes that join the
// roots of the parts have no points. Parts may overlap in space; levels 0..L of all parts together are the sample at
// level L.
//
// A Tree is an immutable snapshot of one generation; any number of threads may call every member. Open readers keep
// reading their snapshot while the tree on disk is changed.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/bpc/chunk_identity.h"
#include "pcm/bpc/commit_record.h"
#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/io/reader.h"
#include "pcm/system/byte_source.h"
#include "pcm/system/tree_folder.h"
#include "pcm/tree/node_table.h"
#include "pcm/tree/tree_reads.h"

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct BpcHeader;
struct DecodedChunk;
class DataFilePool;
class ColumnShares;
struct IndexHead;
struct OpenIndex;
struct TreeIndex;

// Each update writes new data files. A data file without bytes in use may be missing.
using DataFile = CommitRecord::DataFile;

// How the points of a level were chosen.
enum class Sampling : std::uint8_t {
    // The points of levels 0..L are a maximal Poisson-disk sample: no two are nearer than the level's spacing, and
    // every point of the cloud has a sample point nearer than the spacing.
    poisson = 0,
    // One point per cell of a lattice whose cell diagonal is the spacing: faster, and uneven. Every point of the cloud
    // has a sample point nearer than the spacing; no minimum distance is guaranteed.
    grid = 1,
};

struct TreeInfo {
    std::uint32_t generation = 1;  // 1 from the build, one more with each update
    std::uint64_t points = 0;
    Grid grid;
    ScalarType position_type = ScalarType::f64;  // type in the source: i32 for LAS, f32 or f64
    Schema schema;
    bool wide = false;              // grid positions need more than 32 bits
    Box3i box;                      // tight, all points
    std::array<Vec3i, 6> extremes;  // points of the cloud with the smallest x, largest x, smallest y, ...
    // Maximum change of an input coordinate, source units; 0 for LAS. The sign of zero is not kept.
    double position_error = 0;
    std::uint64_t points_skipped = 0;  // input points left out: without a finite position, or beyond a given limit
    std::uint64_t content_hash = 0;    // all points with all attributes, independent of their order (point_hash.h)
    Sampling sampling = Sampling::poisson;
    // False after a deletion, until the tree is compacted: a point may have lost its neighbour of a coarser level.
    bool coverage_kept = true;
    std::uint16_t levels = 0;
    std::vector<double> spacings;  // one per level, descending; source units; 0 for a last level with all other points
    std::uint64_t bytes = 0;       // size of the index and the data files, bytes that updates have left unused included
    std::vector<Metadata> metadata;
    std::vector<std::string> sources;  // file names the tree was built from
    Box3d bounds() const { return grid.to_source(box); }
};

// One level of a tree in numbers.
struct LevelSummary {
    std::uint64_t nodes = 0;  // with points of this level
    std::uint64_t points = 0;
    std::uint64_t points_to_here = 0;  // points of the cloud at this level: this level and all coarser ones
    double spacing = 0;                // 0: no point is missing
};

inline constexpr const char* tree_extension = "pct";

// Some segments of a chunk. A segment is a run of consecutive points of one level; the chunk's header has its box, and
// it can be read alone. `chunk` holds the points of the kept segments, one segment after another.
struct ChunkPart {
    Chunk chunk;
    std::vector<std::uint32_t> first;  // number, in the whole chunk, of the first point of each kept segment
    std::vector<std::uint32_t> count;  // number of points of each kept segment
    std::uint64_t bytes_read = 0;
};

struct ChunkRequest {
    NodeId node = no_node;
    ColumnSet columns;
};

// Takes the chunk of a request, or the reason why it cannot be read; the number is that of the request.
using TakeChunk = std::function<void(std::size_t number, Chunk chunk, std::exception_ptr failure)>;

class Tree {
public:
    static constexpr std::size_t usual_open_files = 128;

    // `path` is the tree folder, any file of the tree in it (tree_folder_of()), or the URL of either on a server that
    // sends ranges of files (remote/remote_file.h). A tree with more than
    // `most_open_files` data files opens them when they are used, and keeps at most that many open, in addition to
    // those being read; others are opened and checked now. Throws Error(not_found | not_a_tree | interrupted_build |
    // corrupt | unsupported | permission | io).
    static std::shared_ptr<const Tree> open(const std::filesystem::path& path,
                                            std::size_t most_open_files = usual_open_files);

    // The tree of a checked index that is about to be put into `folder`, where its data files are already. Throws what
    // open() throws for them.
    static std::shared_ptr<const Tree> of_index(const std::filesystem::path& folder, TreeIndex index,
                                                std::size_t most_open_files = usual_open_files);

    const std::filesystem::path& folder() const { return folder_; }
    const TreeInfo& info() const { return info_; }
    // A page of nodes is read when the first of them is asked for: so these and all that walk the tree throw
    // DamagedTree (Error(corrupt | truncated)) and Error(io).
    const NodeTable& nodes() const { return nodes_; }
    const Node& node(NodeId id) const { return nodes_[id]; }
    Box3d box(NodeId id) const { return info_.grid.to_source(nodes_[id].box); }

    // The root of each part; no_node for a part without points.
    const std::vector<NodeId>& part_roots() const;
    // The identity that the header of the node's chunk must have. For a node without a chunk the generation is the
    // tree's.
    ChunkIdentity identity(NodeId id) const;
    const std::vector<DataFile>& data_files() const;
    // The commit record at the end of the newest data file in use; none where it does not end with one. Throws what
    // read_chunk() throws.
    std::optional<CommitRecord> last_commit() const;
    // Throws Error(corrupt) unless that record is of this tree: the data files are those of the index.
    void refuse_other_data() const;
    // The same tree with attributes added at the end of its schema; their values are zero. Nothing changes on disk;
    // both trees share their open files.
    std::shared_ptr<const Tree> with_schema(const Schema& longer) const;
    // Throws Error(corrupt) when a header does not belong to the node's chunk.
    void check(NodeId id, const BpcHeader& header) const;

    // The header of a node's chunk, which must have one. Throws what read_chunk() throws.
    BpcHeader read_header(NodeId id) const;

    // Reads and decodes the given columns of a node's chunk and verifies their checksums. A node without points gives
    // an empty chunk. Throws Error(corrupt | io | truncated), naming the data file and the byte.
    Chunk read_chunk(NodeId id, const ColumnSet& columns) const;

    // The same for several chunks: those that lie near each other on disk are read at once. `take` is called once for
    // each request, on this thread, in the order of the files; what it throws is passed on.
    void read_chunks(const std::vector<ChunkRequest>& requests, const TakeChunk& take) const;

    // The same for the segments of the chunk for which `wanted` returns true, given the segment's tight box on the grid
    // and the level of its points. Bytes that lie near each other are read together.
    ChunkPart read_chunk_part(NodeId id, const ColumnSet& columns,
                              const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const;

    // What read_chunk() and read_chunk_part() have read so far, of trees that with_schema() made too.
    TreeReads reads() const { return reads_->reads(); }

    // The finest level whose cloud has at most `points` points; 0 if level 0 has more.
    std::uint16_t level_with_at_most(std::uint64_t points) const;
    const std::vector<LevelSummary>& level_summaries() const;
    // Number of points at level 0..level.
    std::uint64_t points_to_level(std::uint16_t level) const;

private:
    Tree() = default;
    static std::shared_ptr<Tree> without_files(const std::filesystem::path& folder, OpenIndex index);
    Chunk empty_chunk(const ColumnSet& columns) const;
    Chunk checked(NodeId id, DecodedChunk decoded, const ColumnSet& columns) const;
    Chunk decode(const ChunkRequest& request, const std::byte* bytes) const;
    Extent place_among_others(const ChunkRequest& request) const;
    std::vector<std::byte> read_bytes(const Extent& first, const Extent& last) const;
    std::shared_ptr<const ByteSource> data_file(std::uint32_t number) const;
    std::filesystem::path folder_;
    TreeInfo info_;
    NodeTable nodes_;
    std::shared_ptr<const IndexHead> head_;
    std::shared_ptr<DataFilePool> files_;
    std::shared_ptr<TreeReadCounter> reads_ = std::make_shared<TreeReadCounter>();
    std::shared_ptr<ColumnShares> shares_;
};

// Whether `path` is a folder with an index file, a file of such a tree, or a URL (a cheap test of names, not a
// validation).
bool is_tree(const std::filesystem::path& path);

}  // namespace pcm

#include "pcm/python/cloud.h"

#include "pcm/python/calls.h"
#include "pcm/python/edited_chunk.h"
#include "pcm/python/selected_points.h"
#include "pcm/python/values.h"
#include "pcm/system/error.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

namespace py = pybind11;

namespace pcm::python {

namespace {

using Cloud = std::shared_ptr<PointCloud>;
using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::array_t<double> array_of(const Box3d& box)
{
    py::array_t<double> ends({2, 3});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        ends.mutable_at(0, axis) = box.min[axis];
        ends.mutable_at(1, axis) = box.max[axis];
    }
    return ends;
}

// The points of one query, all at once.
py::dict query_points(const Cloud& cloud, const Wanted& wanted, bool ids, bool own_units, const py::object& progress)
{
    Call call(progress);
    const Schema& schema = cloud->info().schema;
    Query query = query_of(wanted, schema);
    query.progress = call.progress();
    PointCursor cursor = cloud->points(query);
    Gathered points(read_attributes(query, schema), ids, own_units);
    call.run([&] {
        for (PointView view; cursor.getNextData(view);) points.add(view);
    });
    return points.take();
}

// The points of one query, a dict for each chunk.
class Chunks {
public:
    Chunks(const Cloud& cloud, const Wanted& wanted, bool ids, bool own_units, py::object progress)
        : call_(std::move(progress)),
          query_(query_of(wanted, cloud->info().schema)),
          points_(read_attributes(query_, cloud->info().schema), ids, own_units)
    {
        query_.progress = call_.progress();
        cursor_.emplace(cloud->points(query_));
    }
    Chunks(const Chunks&) = delete;

    py::dict next()
    {
        bool more = false;
        call_.run([&] {
            PointView view;
            more = cursor_->getNextData(view);
            if (more) points_.add(view);
        });
        if (!more) throw py::stop_iteration();
        return points_.take();
    }

private:
    Call call_;
    Query query_;
    Gathered points_;
    std::optional<PointCursor> cursor_;
};

// Edits: the chunks of a query, one after another, to be changed.
class Edits {
public:
    Edits(const Cloud& cloud, const Wanted& wanted, py::object progress)
        : call_(std::move(progress)), query_(query_of(wanted, cloud->info().schema))
    {
        const Schema& schema = cloud->info().schema;
        for (const std::string& name : query_.attributes)
            if (const auto slot = schema.find(name)) columns_.push_back({schema[*slot], *slot});
        query_.progress = call_.progress();
        cursor_.emplace(cloud->edit(query_));
    }
    Edits(const Edits&) = delete;
    ~Edits() { leave(); }

    std::shared_ptr<EditedChunk> next()
    {
        leave();
        bool more = false;
        call_.run([&] {
            EditView view;
            more = cursor_->getNextData(view);
            if (more) chunk_ = std::make_shared<EditedChunk>(std::move(view), columns_);
        });
        if (!more) throw py::stop_iteration();
        return chunk_;
    }

private:
    void leave()
    {
        if (chunk_) chunk_->end();
        chunk_.reset();
    }

    Call call_;
    Query query_;
    std::vector<EditedColumn> columns_;
    std::optional<EditCursor> cursor_;
    std::shared_ptr<EditedChunk> chunk_;
};

py::dict estimate(const Cloud& cloud, const Wanted& wanted)
{
    const Query query = query_of(wanted, cloud->info().schema);
    Estimate found;
    Call(py::none()).run([&] { found = cloud->estimate(query, EstimatePrecision::headers); });
    py::dict answer;
    answer["points_least"] = found.points_least;
    answer["points_expected"] = found.points_expected;
    answer["points_most"] = found.points_most;
    answer["conditions"] = found.conditions;
    answer["chunks"] = found.chunks;
    answer["bytes"] = found.bytes;
    return answer;
}

py::dict nearest(const Cloud& cloud, const Points& places, std::size_t k, std::optional<std::uint16_t> level,
                 double max_distance, unsigned threads, const py::object& progress)
{
    if (places.ndim() != 2 || places.shape(1) != 3)
        throw py::value_error("places are an array of the shape (places, 3), not of " +
                              py::str(places.attr("shape")).cast<std::string>());
    std::vector<Vec3d> wanted;
    for (py::ssize_t i = 0; i < places.shape(0); ++i)
        wanted.push_back({places.at(i, 0), places.at(i, 1), places.at(i, 2)});
    Call call(progress);
    NearestOptions options;
    options.level = level;
    options.max_distance = max_distance;
    options.threads = threads;
    options.progress = call.progress();
    NearestBatch found;
    call.run([&] { found = cloud->nearest(wanted, k, options); });

    const std::size_t rows = wanted.size();
    Rows xyz(ScalarType::f64, 3 * k), distance(ScalarType::f64, k), node(ScalarType::u32, k),
        number(ScalarType::u32, k);
    auto* const xyz_out = reinterpret_cast<double*>(xyz.add(rows));
    auto* const distance_out = reinterpret_cast<double*>(distance.add(rows));
    auto* const node_out = reinterpret_cast<std::uint32_t*>(node.add(rows));
    auto* const number_out = reinterpret_cast<std::uint32_t*>(number.add(rows));
    for (std::size_t i = 0; i < rows; ++i)
        for (std::size_t j = 0; j < k; ++j) {
            const std::size_t at = i * k + j;
            const bool exists = found.first[i] + j < found.first[i + 1];
            const Neighbour none{no_node, no_node, 0, {nan(""), nan(""), nan("")}};
            const Neighbour& neighbour = exists ? found.points[found.first[i] + j] : none;
            for (std::size_t axis = 0; axis < 3; ++axis) xyz_out[3 * at + axis] = neighbour.position[axis];
            distance_out[at] = exists ? neighbour.distance() : HUGE_VAL;
            node_out[at] = neighbour.node;
            number_out[at] = neighbour.index;
        }
    py::dict answer;
    answer["xyz"] = xyz.take(false).attr("reshape")(rows, k, 3);
    answer["distance"] = distance.take(false);
    answer["node"] = node.take(false);
    answer["number"] = number.take(false);
    answer["error"] = found.outcome.error;
    return answer;
}

// Values of points that are named by node and number, in their order.
py::dict values_of(const Cloud& cloud, const py::array_t<std::uint32_t>& node, const py::array_t<std::uint32_t>& number,
                   const std::vector<std::string>& names)
{
    if (node.ndim() != 1 || number.ndim() != 1 || node.shape(0) != number.shape(0))
        throw py::value_error("node and number are arrays of one dimension and the same length");
    const auto tree = cloud->tree();
    const Schema& schema = cloud->info().schema;
    ColumnSet columns;
    std::vector<std::size_t> slots;
    std::vector<Rows> rows;
    for (const std::string& name : names) {
        const auto slot = schema.find(name);
        if (!slot) throw py::key_error(name + " is not an attribute of the cloud");
        slots.push_back(*slot);
        columns.attributes.set(*slot);
        rows.emplace_back(schema[*slot].type, schema[*slot].components);
    }
    const auto count = static_cast<std::size_t>(node.shape(0));
    const std::vector<std::uint32_t> nodes(node.data(), node.data() + count);
    const std::vector<std::uint32_t> numbers(number.data(), number.data() + count);
    std::vector<std::size_t> order(count);
    for (std::size_t i = 0; i < count; ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return nodes[a] < nodes[b]; });
    Rows xyz(ScalarType::f64, 3);
    Call(py::none()).run([&] {
        const SourceRounding rounding(cloud->info());
        auto* const xyz_out = reinterpret_cast<double*>(xyz.add(count));
        std::vector<std::byte*> out;
        for (Rows& r : rows) out.push_back(r.add(count));
        L2Cache::Handle chunk;
        NodeId held = no_node;
        for (const std::size_t i : order) {
            if (nodes[i] >= tree->nodes().size() || numbers[i] >= tree->node(nodes[i]).points)
                throw Error(ErrorCode::invalid_argument, tree->folder(),
                            "there is no point " + std::to_string(numbers[i]) + " of node " + std::to_string(nodes[i]),
                            "take node and number from a query of this cloud as it is now");
            if (nodes[i] != held) chunk = cloud->cache().get(held = nodes[i], columns);
            const Vec3d p = rounding(cloud->info().grid.to_source(chunk->positions->grid(numbers[i])));
            std::copy(p.begin(), p.end(), xyz_out + 3 * i);
            for (std::size_t a = 0; a < slots.size(); ++a) {
                const std::size_t bytes = rows[a].row_bytes();
                std::memcpy(out[a] + i * bytes, chunk->attributes[slots[a]]->data() + numbers[i] * bytes, bytes);
            }
        }
    });
    py::dict answer;
    answer["xyz"] = xyz.take();
    for (std::size_t a = 0; a < names.size(); ++a) answer[py::str(names[a])] = rows[a].take();
    return answer;
}

py::list attributes_of(const Cloud& cloud)
{
    py::list list;
    for (const Attribute& a : cloud->info().schema)
        list.append(py::make_tuple(a.name, dtype_of(a.type), a.components, a.scale, a.offset, a.description));
    return list;
}

py::list levels_of(const Cloud& cloud)
{
    py::list list;
    for (const LevelSummary& level : cloud->tree()->level_summaries())
        list.append(py::make_tuple(level.points_to_here, level.spacing));
    return list;
}

Wanted make_wanted(std::optional<std::vector<double>> box, std::optional<std::string> region,
                   std::optional<std::uint16_t> level, std::vector<std::string> where,
                   std::optional<std::vector<std::string>> attributes)
{
    return {std::move(box), std::move(region), level, std::move(where), std::move(attributes)};
}

Cloud open_cloud(const std::string& path, bool write, std::uint64_t cache_bytes)
{
    L2Options cache;
    if (cache_bytes) cache.capacity_bytes = cache_bytes;
    Cloud cloud;
    Call(py::none()).run([&] { cloud = PointCloud::open(path, cache, write ? Access::write : Access::read); });
    return cloud;
}

}  // namespace

void add_cloud(py::module_& module)
{
    py::class_<Wanted>(module, "Wanted").def(py::init(&make_wanted));
    py::class_<Chunks>(module, "Chunks")
        .def("__iter__", [](py::object self) { return self; })
        .def("__next__", &Chunks::next);
    py::class_<EditedChunk, std::shared_ptr<EditedChunk>>(module, "EditedChunk")
        .def("__len__", &EditedChunk::size)
        .def("__getitem__", &EditedChunk::get)
        .def("__setitem__", &EditedChunk::set)
        .def("keys", &EditedChunk::names);
    py::class_<Edits>(module, "Edits")
        .def("__iter__", [](py::object self) { return self; })
        .def("__next__", &Edits::next);
    py::class_<PointCloud, Cloud>(module, "PointCloud")
        .def_property_readonly("points", [](const Cloud& cloud) { return cloud->info().points; })
        .def_property_readonly("bounds", [](const Cloud& cloud) { return array_of(cloud->info().bounds()); })
        .def_property_readonly("folder", [](const Cloud& cloud) { return cloud->tree()->folder().string(); })
        .def_property_readonly("attributes", &attributes_of)
        .def_property_readonly("levels", &levels_of)
        .def("query", &query_points)
        .def("chunks",
             [](const Cloud& cloud, const Wanted& wanted, bool ids, bool own_units, py::object progress) {
                 return std::make_unique<Chunks>(cloud, wanted, ids, own_units, std::move(progress));
             })
        .def("edits", [](const Cloud& cloud, const Wanted& wanted,
                         py::object progress) { return std::make_unique<Edits>(cloud, wanted, std::move(progress)); })
        .def("estimate", &estimate)
        .def("nearest", &nearest)
        .def("values", &values_of)
        .def("add_attribute",
             [](const Cloud& cloud, const std::string& name, const py::dtype& type, std::uint32_t components,
                const std::string& description) {
                 cloud->add_attribute({name, type_of(type, name), components, 1, 0, description});
             })
        .def("flush", [](const Cloud& cloud) { Call(py::none()).run([&] { cloud->flush(); }); })
        .def("close", [](const Cloud& cloud) { Call(py::none()).run([&] { cloud->close(); }); })
        .def("abandon", [](const Cloud& cloud) { Call(py::none()).run([&] { cloud->abandon(); }); });
    module.def("open", &open_cloud);
}

}  // namespace pcm::python
